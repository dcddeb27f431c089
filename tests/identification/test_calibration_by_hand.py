"""The order of a calibration's steps, and what it says, on steps that are made up."""

from types import SimpleNamespace

import pytest

from tests.counted import Counted
from tsas_cli.identification import calibration as c
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.missing_effects import Widened
from tsas_cli.identification.model import Model
from tsas_cli.recordings.manifest import Manifest, Run

RUNS = [
    SimpleNamespace(run=Run(id=name, file=f"{name}.parquet", sha256="0" * 64, **told), measured={})
    for name, told in (
        ("a", {"total_bend_rad": 3.0, "sheath_length_mm": 700.0}),
        ("b", {"total_bend_rad": 3.0, "sheath_length_mm": 700.0}),
    )
]
MANIFEST = Manifest(format=1, name="t", kind="measured", rig={}, run=tuple(r.run for r in RUNS))


def model_of(value):
    return Model((Estimate("friction_coefficient", value, "1", "fitted"),))


@pytest.fixture
def calibrated(monkeypatch):
    """Calibrate with made-up steps; tell what came out, and what each was asked."""

    def run(*, fitted="fitted", missed=(), effects=("backlash",), notes=(), dynamics="slip",
            dynamic_misfit=(), stated=None):  # fmt: skip
        log = {}
        fit = SimpleNamespace(
            model=model_of(1.0),
            fitted=fitted,
            cannot_tell=["untold"],
            problem=SimpleNamespace(runs="fitted runs"),
        )

        def base_fit(stated, runs, segments, measured):
            log["base"] = stated, runs, segments, measured
            return "problem"

        def dynamic_fit(model, runs, step):
            log["dynamic"] = model.value("friction_coefficient"), runs
            told = ["dynamic untold"], list(dynamic_misfit)
            return SimpleNamespace(
                model=model_of(2.0), fitted="dynamic", cannot_tell=told[0], misfit=told[1]
            )

        def widened(fit, step):
            log["widened"] = [e.value for e in fit.model.estimates]
            return Widened(model_of(3.0).estimates, tuple(effects))

        def compare(run, model, dynamics):
            used = model.value("friction_coefficient")
            return SimpleNamespace(run=run.run.id, used=used, dynamics=dynamics, notes=notes)

        monkeypatch.setattr(c, "segment", lambda run: f"segments {run.run.id}")
        monkeypatch.setattr(c, "slopes_of", lambda run, segments: f"slopes of {segments}")
        monkeypatch.setattr(c, "base_fit", base_fit)
        monkeypatch.setattr(c, "solve_fit", {"problem": fit}.__getitem__)
        monkeypatch.setattr(c, "misfit", lambda fit: list(missed))
        monkeypatch.setattr(c, "dynamic_fit", dynamic_fit)
        monkeypatch.setattr(c, "widened", widened)
        monkeypatch.setattr(c, "compare", compare)
        monkeypatch.setattr(
            c, "_predicted_slopes", lambda run, a, segments: (run.run.id, a.run, segments)
        )
        monkeypatch.setattr(c, "tension_transfer", lambda runs, segments: (runs, segments))
        monkeypatch.setattr(c, "with_preload_correction", lambda model, runs: model)
        monkeypatch.setattr(c, "thinned_notes", lambda runs: ["thinned"])
        step = Counted()
        found = c.calibrate_runs(MANIFEST, RUNS, step, dynamics=dynamics, stated=stated)
        return found, log, step

    return run


SEGMENTS = ["segments a", "segments b"]


def test_a_model_that_is_right_is_told_as_it_was_fitted(calibrated):
    found, log, step = calibrated()
    _, runs, segments, measured = log["base"]
    assert (runs, segments) == (RUNS, SEGMENTS)
    assert measured == found.slopes == ["slopes of segments a", "slopes of segments b"]
    assert found.segments == SEGMENTS
    assert found.expected == [("a", "a", "segments a"), ("b", "b", "segments b")]
    assert found.transfer == (RUNS, SEGMENTS)
    assert [(a.used, a.dynamics) for a in found.predictions] == [(1.0, "slip")] * 2
    assert (found.model, found.fitted) == (model_of(1.0), "fitted")
    assert list(found.cannot_tell) == ["thinned", "untold"]
    assert set(log) == {"base"}
    assert (step.total, step.done) == (3, 3)


def test_it_starts_from_the_model_that_is_stated_or_else_the_data_sheet(calibrated):
    assert calibrated(stated=model_of(7.0))[1]["base"][0] == model_of(7.0)
    assert calibrated()[1]["base"][0] == Model(())


def test_a_model_that_is_wrong_is_widened(calibrated):
    found, log, _ = calibrated(missed=["missed"], effects=["backlash", "creep"])
    assert log["widened"] == [1.0]
    assert found.model == model_of(3.0)
    assert [a.used for a in found.predictions] == [1.0, 1.0]  # the answers are those of the fit
    assert found.cannot_tell[:2] == ["thinned", "missed"]
    assert found.cannot_tell[2].startswith(
        "The intervals are widened by the influence of backlash or creep"
    )
    assert found.cannot_tell[3:] == ["untold"]
    found, _, _ = calibrated(missed=["missed"], effects=[])
    assert found.cannot_tell[2].startswith("No catalogued effect explains the residual")


def test_where_nothing_is_fitted_nothing_is_widened(calibrated):
    found, log, _ = calibrated(fitted=None, missed=["missed"])
    assert set(log) == {"base"}
    assert found.cannot_tell == ["thinned", "missed", "untold"]
    assert calibrated(fitted=None, dynamics="lugre")[1].keys() == {"base"}


def test_the_dynamic_model_is_fitted_after_the_nominal_one(calibrated):
    found, log, _ = calibrated(dynamics="lugre", missed=["missed"], notes=("once", "other"))
    assert log["dynamic"] == (1.0, "fitted runs")
    assert (found.model, found.fitted) == (model_of(2.0), "dynamic")
    assert [(a.used, a.dynamics) for a in found.predictions] == [(2.0, "lugre")] * 2
    assert found.cannot_tell == ["thinned", "dynamic untold", "once", "other"]
    assert "widened" not in log
    found, _, _ = calibrated(dynamics="lugre", dynamic_misfit=["misses"])
    assert found.cannot_tell == ["thinned", "misses", c.LACKING, "dynamic untold"]


def test_what_the_manifest_does_not_say_is_said():
    def said(**told):
        run = SimpleNamespace(run=Run(id="c", file="c.parquet", sha256="0" * 64, **told))
        return [s.split()[0] for s in c._unknown_conditions([RUNS[0], run])]

    assert said(total_bend_rad=1.0, sheath_length_mm=1.0) == []
    assert said(total_bend_rad=1.0) == ["sheath_length_mm"]
    assert said(sheath_length_mm=1.0) == ["total_bend_rad"]
    assert said() == ["total_bend_rad", "sheath_length_mm"]


def test_expected_slopes_are_fitted_to_the_answer(monkeypatch):
    monkeypatch.setattr(c, "slopes", lambda x, f, segments: (x, f, segments))
    answer = SimpleNamespace(response=SimpleNamespace(f_in_N="simulated"))

    def answered(measured, conditioned):
        ends = {name: SimpleNamespace(values="x") for name in conditioned}
        run = SimpleNamespace(measured=measured, conditioned=ends)
        return c._predicted_slopes(run, answer, "segments")

    assert answered(["f_in_N"], ["x_in_mm"]) == ("x", "simulated", "segments")
    assert answered(["f_out_N"], ["x_in_mm"]) == []
    assert answered(["f_in_N"], ["f_out_N"]) == []
