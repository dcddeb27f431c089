"""Calibration on the independent rig: the truth is found, and what cannot be told is said."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from tests.identification.recorded import TRUE, manifest, prepared
from tests.identification.recorded import VALUES as OF_RIG
from tests.physics.references import GROUP_A
from tsas_cli.identification import calibration as c
from tsas_cli.identification.calibration import calibrate_runs, with_preload_correction
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import CORRECTION, Model
from tsas_cli.identification.transfer import Slope
from tsas_cli.recordings.manifest import Manifest, Run
from tsas_cli.stages.calibrate import CalibrationResult, _stiffness, _theory
from tsas_cli.support.limits import THREADS
from tsas_studies.challenge.rig.motions import sine, two_sines
from tsas_studies.challenge.rig.recordings import DATA_SHEET
from tsas_studies.challenge.rig.sensors import Sensors
from tsas_studies.challenge.rig.tendon import Rig

OTHER = replace(TRUE, total_bend_rad=math.pi / 2.0, sheath_length_mm=100.0 * math.pi)
VALUES = OF_RIG | {"x_in_zero_mm": 0.0}


def recorded(rig, motion=None, **more):
    """Return a run at a tenth of the usual rate."""
    moved = motion or sine(rate_Hz=200.0)
    return prepared(rig, moved, sensors=Sensors(rate_Hz=100.0), **more)


def found(result):
    return {(e.name, e.run): e for e in result.model.estimates if e.stderr is not None}


def test_what_cannot_be_told_is_said():
    run = recorded(TRUE, channels=("f_in_N",))
    result = calibrate_runs(manifest(run), [run])
    said = " ".join(result.cannot_tell)
    assert "x_in_zero_mm is not identifiable together with preload_N" in said
    assert "x_out_zero_mm is not identifiable from" in said
    assert ("x_in_zero_mm", "a") not in found(result)


def test_a_right_model_is_not_accused_and_a_wrong_one_is():
    right = recorded(TRUE)
    said = calibrate_runs(manifest(right), [right]).cannot_tell
    assert not any("lacks an effect" in s for s in said)
    hidden = Rig(proximal_length_mm=200.0)
    both = [recorded(hidden), recorded(replace(hidden, sheath_length_mm=300.0), run_id="b")]
    said = calibrate_runs(manifest(*both), both).cannot_tell
    assert any("lacks an effect" in s for s in said)
    (widened,) = [s for s in said if s.startswith("The intervals are widened")]
    assert "free_tendon" in widened


def test_a_told_free_length_is_used():
    """With the free lengths on the data sheet the tendon's own stiffness is found."""
    long = Rig(proximal_length_mm=150.0, distal_length_mm=60.0)
    short = replace(long, sheath_length_mm=300.0)
    runs = [recorded(long, seed=0), recorded(short, run_id="b", seed=1)]
    told = manifest(*runs, proximal_length_mm=150.0, distal_length_mm=60.0)
    swapped = manifest(*runs, proximal_length_mm=60.0, distal_length_mm=150.0)
    right = found(calibrate_runs(told, runs))["tendon_stiffness_N", None]
    wrong = found(calibrate_runs(swapped, runs))["tendon_stiffness_N", None]
    assert right.value == pytest.approx(Rig().axial_stiffness, rel=3e-3)
    assert abs(wrong.value / Rig().axial_stiffness - 1.0) > 0.02


def test_the_dead_band_s_bias_is_expected():
    """The line fit misses the theory, and the distributed model says by how much."""
    run = prepared(Rig())
    result = calibrate_runs(manifest(run), [run])
    measured = {s.phase: s for s in result.slopes[0]}
    expected = {s.phase: s.value for s in result.expected[0]}
    for phase in ("dead_band_up", "dead_band_down"):
        assert abs(measured[phase].value - expected[phase]) < measured[phase].half_width
        assert expected[phase] < 0.97 * 175.1
    assert measured["contraction"].value == pytest.approx(2.287, abs=2e-3)
    assert measured["loosening"].value == pytest.approx(1.050, abs=2e-3)


@pytest.mark.parametrize("seeds", [5, pytest.param(12, marks=pytest.mark.large)])
def test_intervals_hold_the_truth_over_seeds(seeds):
    """A small part of the coverage benchmark: at least 80 % of all intervals."""
    inside = []
    for seed in range(100, 100 + seeds):
        run = recorded(TRUE, seed=seed)
        inside += [
            e.interval_low <= VALUES[e.name] <= e.interval_high
            for e in found(calibrate_runs(manifest(run), [run])).values()
            if e.name in VALUES
        ]
    assert np.mean(inside) > 0.8


@pytest.mark.parametrize("duration_s", [15.0, pytest.param(50.0, marks=pytest.mark.large)])
def test_many_strokes_hold_the_truth_too(duration_s):
    """Where answers were straight between some samples, they missed by four intervals."""
    run = recorded(TRUE, two_sines(duration_s=duration_s), seed=1)
    estimates = found(calibrate_runs(manifest(run), [run])).values()
    wide = [(e.interval_high - e.interval_low, abs(e.value - VALUES[e.name])) for e in estimates]
    assert all(off < width for width, off in wide)
    assert len(wide) == len(VALUES)


def test_threads_change_no_bit(monkeypatch):
    runs = [recorded(TRUE, seed=1), recorded(OTHER, seed=2, run_id="b")]
    models = []
    for threads in ("1", "3"):
        monkeypatch.setenv(THREADS, threads)
        models.append(calibrate_runs(manifest(*runs), runs).model)
    assert models[0] == models[1]


BENT = {"total_bend_rad": 3.0, "sheath_length_mm": 700.0}


@pytest.mark.parametrize(
    "missing",
    [(), ("total_bend_rad",), ("sheath_length_mm",), ("total_bend_rad", "sheath_length_mm")],
)
def test_what_the_manifest_does_not_say_is_said(missing):
    told = (BENT, {name: value for name, value in BENT.items() if name not in missing})
    runs = [SimpleNamespace(run=Run(id="a", file="a", sha256="0" * 64, **of)) for of in told]
    assert tuple(s.split()[0] for s in c.unknown_conditions(runs)) == missing
    for name, alike in (
        ("total_bend_rad", "the same bend"),
        ("sheath_length_mm", "the same length"),
    ):
        assert any(alike in s for s in c.unknown_conditions(runs)) == (name in missing)
        assert not any(alike in s for s in c.unknown_conditions(runs[-1:]))


STUDENT = {1: 12.7062, 2: 4.30265}  # 97.5 %, as tables have it


def corrected(*pairs, stderr=0.1):
    """Return what runs with these fitted and stated preloads say of others."""
    runs = [
        SimpleNamespace(run=SimpleNamespace(id=f"r{k}", preload_N=stated))
        for k, (_, stated) in enumerate(pairs)
    ]
    told = tuple(
        Estimate("preload_N", fitted, "N", "fitted", f"r{k}", stderr)
        for k, (fitted, _) in enumerate(pairs)
        if fitted is not None
    )
    model = Model((Estimate("friction_coefficient", 0.1, "1", "fitted", None, 0.01), *told))
    return model, with_preload_correction(model, runs)


def test_two_runs_give_a_mean_and_how_far_a_third_may_lie_from_it():
    """Off by 1 and 3: a mean of 2, a scatter of √2, for one more run √2·√(1 + 1/2) = √3."""
    model, found = corrected((21.0, 20.0), (33.0, 30.0))
    e = found.estimate(CORRECTION)
    assert (e.value, e.unit, e.origin, e.run) == (2.0, "N", "fitted", None)
    assert e.stderr == pytest.approx(math.sqrt(3.0))
    assert e.interval_low == pytest.approx(2.0 - STUDENT[1] * math.sqrt(3.0), rel=1e-5)
    assert e.interval_high == pytest.approx(2.0 + STUDENT[1] * math.sqrt(3.0), rel=1e-5)
    assert set(model.estimates) == set(found.estimates) - {e}


def test_three_runs_have_two_degrees_of_freedom():
    """Off by −1, 1 and 6: a mean of 2, squares of 9 + 1 + 16, so √13 · √(4/3)."""
    _, found = corrected((19.0, 20.0), (31.0, 30.0), (46.0, 40.0))
    e = found.estimate(CORRECTION)
    assert e.value == pytest.approx(2.0)
    assert e.stderr == pytest.approx(math.sqrt(52.0 / 3.0))
    half = STUDENT[2] * math.sqrt(52.0 / 3.0)
    assert e.interval_high - e.value == pytest.approx(half, rel=1e-5)


def test_fewer_than_two_runs_give_none():
    for pairs in ([], [(21.0, 20.0)], [(21.0, 20.0), (33.0, None)], [(21.0, 20.0), (None, 30.0)]):
        model, found = corrected(*pairs)
        assert found is model
    model, found = corrected((21.0, 20.0), (33.0, 30.0), stderr=None)  # stated, not fitted
    assert found is model


def test_a_former_correction_is_replaced():
    _, once = corrected((21.0, 20.0), (33.0, 30.0))
    runs = [SimpleNamespace(run=SimpleNamespace(id=f"r{k}", preload_N=20.0)) for k in range(2)]
    again = with_preload_correction(once, runs)
    assert again.value(CORRECTION) == pytest.approx(7.0)  # 1 and 13
    assert sum(e.name == CORRECTION for e in again.estimates) == 1


CONDITIONS = {"total_bend_rad": math.pi, "sheath_length_mm": 785.0, "preload_N": 25.0}


def stiffness(phase="contraction", sheet=DATA_SHEET, conditions=CONDITIONS, expected=2.4):
    run = {"id": "a", "file": "runs/a.parquet", "sha256": "0" * 64} | conditions
    manifest = Manifest.model_validate(
        {"format": 1, "name": "n", "kind": "measured", "rig": sheet, "run": [run]}
    )
    slope = Slope(phase, 2.35, 0.01, 0.024, 3, 400)
    model = SimpleNamespace(rig=lambda _: GROUP_A._replace(friction_coefficient=0.2))
    beside = None if expected is None else Slope(phase, expected, 0.0, 0.0, 3, 400)
    prepared = SimpleNamespace(run=manifest.run[0])
    return _stiffness(prepared, slope, beside, manifest, model)


def test_measured_stiffness_is_told_per_millimetre_and_per_turn():
    found = stiffness().content()
    km, kr = found["km"], found["kr"]
    assert (km["value"], km["stderr"]) == (2.35, 0.01)
    assert (km["interval_low"], km["interval_high"]) == pytest.approx((2.326, 2.374))
    for name in ("value", "stderr", "interval_low", "interval_high"):
        assert kr[name] == pytest.approx(0.0236492 * km[name], rel=1e-5)  # 2π r1/(60 im)
    assert (km["unit"], kr["unit"]) == ("N/mm", "N/(s rpm)")
    assert (found["occurrences"], found["samples"], found["expected_N_per_mm"]) == (3, 400, 2.4)
    less = stiffness(
        sheet={k: v for k, v in DATA_SHEET.items() if k != "gear_ratio"}, expected=None
    )
    assert less.expected_N_per_mm is less.kr is None


@pytest.mark.parametrize(
    ("phase", "theory", "elastic"),
    [
        ("contraction", 2.338, 2.287),
        ("loosening", 1.066, 1.050),
        ("dead_band_up", 175.10, 175.10),
        ("dead_band_down", 175.10, 175.10),
    ],
)
def test_theory_is_that_of_the_paper(phase, theory, elastic):
    found = stiffness(phase)
    assert found.theory_N_per_mm == pytest.approx(theory, abs=1e-3 * theory)
    assert found.theory_elastic_N_per_mm == pytest.approx(elastic, abs=1e-3 * elastic)
    assert found.note == "theory from the data sheet"


@pytest.mark.parametrize("missing", list(DATA_SHEET)[:4])
def test_without_a_data_sheet_theory_is_that_of_the_calibrated_values(missing):
    found = stiffness(sheet={k: v for k, v in DATA_SHEET.items() if k != missing})
    assert found.note == "theory from the calibrated values"
    assert found.theory_N_per_mm == pytest.approx(1.579 * math.exp(0.2 * math.pi))


def test_no_theory_without_friction_or_spring():
    slope = Slope("contraction", 2.0, 0.1, 0.2, 1, 50)
    spring = SimpleNamespace(run=SimpleNamespace(load="spring"))
    weight = SimpleNamespace(run=SimpleNamespace(load="force"))
    assert _theory(GROUP_A._replace(friction_coefficient=0.0), slope, spring) == (None, None)
    assert _theory(GROUP_A, slope, weight) == (None, None)
    assert _theory(GROUP_A, Slope("dead_band_up", 2.0, 0.1, 0.2, 1, 50), weight)[0] > 100.0


def test_the_table_leaves_out_what_is_not_known():
    record = SimpleNamespace(
        stiffness=[stiffness(expected=None)], parameters=[], transfer=[], channels={}
    )
    result = CalibrationResult({}, None, record, None)
    (_, header, (line,)), *others = result.tables()
    assert header[:2] == ("run", "phase")
    assert line == ("a", "contraction", "2.35 [2.326, 2.374]", "2.338", "")
    titles = [title for title, _, _ in others]
    assert titles == ["parameters", "calibrated model against measurement"]
