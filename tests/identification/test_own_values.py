"""What belongs to one run alone is fitted to it: its preload, and the zeros of its sensors."""

from types import SimpleNamespace

import numpy as np
import pytest

from tests.identification.recorded import TRUE, VALUES, clean, ran
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit_problem import prepare_fit
from tsas_cli.identification.model import Model
from tsas_cli.identification.own_values import _median, _zeros_by_laws, with_own_values
from tsas_cli.identification.quantities import QUANTITIES
from tsas_studies.challenge.rig.motions import sine
from tsas_studies.challenge.rig.recordings import conditions
from tsas_studies.challenge.rig.sensors import Sensors, measure

SHARED = {name: value for name, value in VALUES.items() if name != "preload_N"}
HEIGHTS = {f"drive_law.curve_{k}_N": h for k, h in enumerate((0.0, 4.0, 1.0, 6.0, 3.0), 1)}


def model(**further):
    return Model(
        tuple(
            Estimate(name, value, QUANTITIES[name].unit, "fitted")
            for name, value in (SHARED | further).items()
        )
    )


@pytest.fixture(scope="module")
def columns():
    return measure(clean(TRUE, sine(rate_Hz=400.0)), Sensors(rate_Hz=200.0), seed=1)


def own_values(of, columns, **changes):
    moved = {name: values + changes.get(name, 0.0) for name, values in columns.items()}
    own = with_own_values(of, ran(moved, **conditions(TRUE) | {"preload_N": None}))
    return {e.name: e.value for e in own.estimates}


def test_the_zero_of_a_force_sensor_is_a_runs_own_where_the_model_has_an_offset(columns):
    offset = "force_sensor_offset.f_in_offset_N"
    own = own_values(model(**{offset: 1.0}), columns, f_in_N=-3.0)
    assert own[offset] == pytest.approx(-3.0, abs=0.1)
    assert own["preload_N"] == pytest.approx(27.0, abs=0.1)
    assert {name: own[name] for name in SHARED} == SHARED
    without = own_values(model(), columns, f_in_N=-3.0)
    assert offset not in without


def test_a_run_far_from_where_a_law_holds_is_brought_back_to_it(columns):
    """All displacements read 100 mm less: the force along the stroke goes with the drive."""
    x = columns["x_in_mm"]
    low, high = float(x.min()), float(x.max())
    curve = np.interp(x, np.linspace(low, high, 5), list(HEIGHTS.values()))
    law = model(**HEIGHTS | {"drive_law.low_mm": low, "drive_law.high_mm": high})
    own = own_values(law, columns, f_in_N=curve, x_in_mm=-100.0, x_out_mm=-100.0)
    assert own["x_in_zero_mm"] == pytest.approx(-100.0, abs=0.1)
    assert own["preload_N"] == pytest.approx(27.0, abs=0.3)


def test_a_run_that_ends_before_its_first_full_slip_keeps_the_models_values(columns):
    """Nothing of it enters a fit, from wherever that starts."""
    short = {name: values[:25] for name, values in columns.items()}
    law = model(**HEIGHTS | {"drive_law.low_mm": 0.0, "drive_law.high_mm": 20.0})
    own = own_values(law, short)
    assert {name: own[name] for name in SHARED} == SHARED


@pytest.mark.parametrize("far", [False, True])
def test_a_run_is_laid_in_the_middle_of_the_displacements_that_a_law_holds_for(far):
    """From 2 to 10 mm beside a law from 1 to 4 mm: by 6 less 2.5 mm."""
    law = Model(
        (
            Estimate("drive_law.low_mm", 1.0, "mm", "given"),
            Estimate("drive_law.high_mm", 4.0, "mm", "given"),
        )
    )
    x = np.array([np.nan, 2.0, 10.0, 3.0]) if not far else np.full(4, np.nan)
    run = SimpleNamespace(run=SimpleNamespace(id="a"), channel={"x_in_mm": x}.get)
    found = _zeros_by_laws(law, run)
    assert [(e.name, e.value, e.run) for e in found.estimates] == [("x_in_zero_mm", 3.5, "a")] * (
        not far
    )
    assert _zeros_by_laws(Model(law.estimates[:1]), run).estimates == ()


def test_another_run_of_a_mounting_starts_from_the_median_of_the_values_that_the_others_have():
    of = [("x_in_zero_mm", run, mm) for run, mm in zip("bcd", (1.0, 3.0, 7.0), strict=True)]
    of += [
        ("x_in_zero_mm", "a", 50.0),
        ("preload_N", "b", 20.0),
        ("friction_coefficient", None, 0.1),
    ]
    known = Model(tuple(Estimate(name, v, "", "fitted", run) for name, run, v in of))
    found = _median(known, SimpleNamespace(run=SimpleNamespace(id="a")))
    values = {e.name: (e.value, e.run) for e in found.estimates}
    assert values == {"x_in_zero_mm": (3.0, "a"), "preload_N": (20.0, "a")}


def test_a_fit_that_ends_far_off_gives_way_to_one_from_the_values_of_the_other_runs(
    columns, monkeypatch
):
    """What the run shows is misread by 300 mm: the tendon is slack, and nothing pulls it taut."""
    wrong = Model((Estimate("x_in_zero_mm", 300.0, "mm", "default", "a"),))
    monkeypatch.setattr("tsas_cli.identification.own_values.read_off", lambda *_: wrong)
    own = own_values(model(), columns)
    assert abs(own["x_in_zero_mm"]) > 50.0
    others = (Estimate("x_in_zero_mm", 0.5, "mm", "fitted", "b"),)
    known = Model((*model().estimates, *others))
    of_run = with_own_values(known, ran(columns, **conditions(TRUE) | {"preload_N": None}))
    assert of_run.value("x_in_zero_mm", "a") == pytest.approx(0.0, abs=0.1)


def test_a_preload_that_other_runs_have_and_this_one_is_not_fitted_moves_no_zero(
    columns, monkeypatch
):
    """With a load by displacement a preload is as good as a zero: that of the manifest is fixed."""
    starts = []

    def prepared(start, *given, **options):
        starts.append({e.name: e.value for e in start.estimates if e.run == "a"})
        return prepare_fit(start, *given, **options)

    monkeypatch.setattr("tsas_cli.identification.own_values.prepare_fit", prepared)
    of_others = (
        Estimate("preload_N", 9.0, "N", "data sheet", "b"),
        Estimate("x_in_zero_mm", 0.2, "mm", "fitted", "b"),
    )
    run = ran(columns, **conditions(TRUE) | {"load": "displacement"})
    own = with_own_values(Model((*model().estimates, *of_others)), run)
    assert own.value("x_in_zero_mm", "a") == pytest.approx(0.0, abs=0.01)
    assert starts[1]["x_in_zero_mm"] == 0.2
    assert not any("preload_N" in start for start in starts)
