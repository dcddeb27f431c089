"""What belongs to one run alone is fitted to it: its preload, and the zeros of its sensors."""

import numpy as np
import pytest

from tests.identification.recorded import TRUE, VALUES, clean, ran
from tsas_cli.identification.base_fit import with_own_values
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model
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
    assert {name: own[name] for name in VALUES} == VALUES
