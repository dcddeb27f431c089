"""Splits of an effect's parameter, on linear fits to data that are made up."""

from dataclasses import replace

import numpy as np
import pytest

from tsas_cli.diagnosis.constancy import absorbed_by, worst_split
from tsas_cli.diagnosis.held_out import folds_of
from tsas_cli.identification.fit import Solution, Unknown
from tsas_cli.identification.hypothesis_fit import HypothesisFit

RUNS, ROWS = 4, 600
EFFECT, NAME = "drive_friction", "drive_friction.friction_N"
SIZE = 1.5  # of the friction, in N: a scaled value of 1
RUN = np.repeat(np.arange(RUNS), ROWS)
TIME_S = np.tile(np.linspace(0.0, 30.0, ROWS), RUNS)
SIGNALS = {
    "direction": np.sign(np.sin(2.0 * np.pi * TIME_S / 5.0)),
    "speed_mm_per_s": np.cos(2.0 * np.pi * TIME_S / 5.0),
    "x_in_mm": 10.0 - 10.0 * np.cos(2.0 * np.pi * TIME_S / 7.0),
    "time_s": TIME_S,
}
FOLDS = folds_of([np.arange(ROWS) * 12 // ROWS for _ in range(RUNS)])


def trial(sizes, at_bound=False):
    """Return a fit of one value to a column whose true value is `sizes`, shape (n,), and a mean."""
    rng = np.random.default_rng(3)
    column = 5.0 * (1.0 + rng.random(RUN.size))
    J = np.column_stack((rng.standard_normal(RUN.size), column))
    data = column * sizes + rng.standard_normal(RUN.size)
    values = np.linalg.lstsq(J, data, rcond=None)[0]
    unknowns = (
        Unknown("friction_coefficient", None, 0.0, -1e6, 1e6, 1e3),
        Unknown(NAME, None, 0.0, -1e6, 1e6, 1.0),
    )
    bounds = np.array([False, at_bound])
    solution = Solution(values, bounds, J @ values - data, J, True, "", 1)
    return HypothesisFit((EFFECT,), unknowns, solution, (ROWS,) * RUNS, on_mesh=False)


def worst(sizes, tolerated=None, **more):
    ids = tuple("abcd")
    tolerated = np.zeros((RUN.size, 0)) if tolerated is None else tolerated
    return worst_split(trial(sizes, **more), EFFECT, FOLDS, SIGNALS, ids, tolerated)


def test_an_effect_with_one_value_has_no_split():
    assert worst(np.ones(RUN.size)) is None


def test_one_value_for_pulls_and_another_for_releases():
    pulls = SIGNALS["direction"] > 0.0
    found = worst(np.where(pulls, 1.4, 1.0))
    assert (found.parameter, found.by) == (NAME, "direction")
    values = dict(found.values)
    unit = values["releasing"]
    assert values["pulling"] / unit == pytest.approx(1.4, abs=0.02)


@pytest.mark.parametrize("signal", ["speed_mm_per_s", "x_in_mm", "time_s"])
def test_a_value_that_changes_with_a_signal_is_split_by_it(signal):
    size = np.abs(SIGNALS[signal]) / np.abs(SIGNALS[signal]).max()
    found = worst(1.0 + 0.5 * size)
    assert found.by == signal
    low, middle, high = (value for _, value in found.values)
    assert low < middle < high


@pytest.mark.parametrize("times", [1.25, 1.5])
def test_a_value_of_one_run_is_split_by_run(times):
    found = worst(np.where(RUN == 2, times, 1.0))
    assert found.by == "run"
    values = dict(found.values)
    assert values["run c"] / values["run a"] == pytest.approx(times, abs=0.05)
    assert values["run b"] / values["run a"] == pytest.approx(1.0, abs=0.05)


def test_a_value_that_differs_from_run_to_run_by_less_than_a_fifth_is_that_of_the_mounting():
    of_run = np.where(RUN == 2, 1.15, 1.0)
    assert worst(of_run) is None
    pulls = SIGNALS["direction"] > 0.0
    assert worst(np.where(pulls, 1.4 * of_run, of_run)).by == "direction"


def test_a_value_at_its_bound_is_not_split():
    assert worst(np.where(RUN == 2, 1.5, 1.0), at_bound=True) is None


@pytest.mark.parametrize(("amount", "constant"), [(1.0, True), (60.0, False)])
def test_a_difference_that_a_plausible_tolerance_makes_is_no_split(amount, constant):
    """A load cell that is off by one standard deviation, or by sixty, changes pulls alone."""
    column = trial(np.ones(RUN.size)).solution.jacobian[:, 1]
    off = 0.1 * column * (SIGNALS["direction"] > 0.0)
    found = worst(1.0 + 0.1 * amount * (SIGNALS["direction"] > 0.0), off[:, None])
    assert worst(1.0 + 0.1 * amount * (SIGNALS["direction"] > 0.0)).by == "direction"
    assert (found is None) == constant


def test_the_friction_of_each_run_is_no_other_law_of_a_drift():
    """Friction drifts within runs, and scatters from run to run as a rate of the session does."""
    friction = 20.0 + 10.0 * np.sin(TIME_S)
    within, session = friction * TIME_S / 30.0, friction * RUN
    of_run = np.array([0.01, -0.01, 0.015, -0.02])[RUN]
    J = np.column_stack((friction, within, session))
    noise = 0.1 * np.random.default_rng(4).standard_normal(RUN.size)
    data = friction * of_run + 0.05 * within + noise
    names = "friction_coefficient", "friction_drift.rate_per_s", "friction_drift.session_rate_per_s"
    unknowns = tuple(Unknown(name, None, 0.0, -1e6, 1e6, 1.0) for name in names)
    values = np.linalg.lstsq(J, data, rcond=None)[0]
    solution = Solution(values, np.zeros(3, bool), J @ values - data, J, True, "", 1)
    fit = HypothesisFit(("friction_drift",), unknowns, solution, (ROWS,) * RUNS, on_mesh=False)
    none = np.zeros((RUN.size, 0))
    assert worst_split(fit, "friction_drift", FOLDS, SIGNALS, tuple("abcd"), none) is None
    late = replace(solution, residual=solution.residual - 0.05 * within * (TIME_S > 20.0))
    fit = replace(fit, solution=late)
    assert worst_split(fit, "friction_drift", FOLDS, SIGNALS, tuple("abcd"), none).by == "time_s"


@pytest.mark.parametrize("other", [False, True])
def test_a_gain_that_another_law_of_an_effect_has_too_is_absorbed_by_it(other):
    """What is left follows the place of the drive, as its friction may, or nothing of it."""
    rng = np.random.default_rng(5)
    friction = 5.0 * (1.0 + rng.random(RUN.size))
    place = SIGNALS["x_in_mm"]
    more = np.sin(9.0 * TIME_S) if other else friction * (place > np.quantile(place, 2.0 / 3.0))
    data = friction + 0.8 * more + 0.3 * rng.standard_normal(RUN.size)
    fits = []
    for columns in ((friction,), (friction, more)):
        J = np.column_stack(columns)
        values = np.linalg.lstsq(J, data, rcond=None)[0]
        names = (NAME, "force_sensor_offset.f_in_offset_N")[: len(columns)]
        unknowns = tuple(Unknown(name, None, 0.0, -1e6, 1e6, 1.0) for name in names)
        at_bound = np.zeros(len(columns), bool)
        solution = Solution(values, at_bound, J @ values - data, J, True, "", 1)
        fits.append(HypothesisFit((EFFECT,), unknowns, solution, (ROWS,) * RUNS, on_mesh=False))
    by = absorbed_by(*fits, EFFECT, FOLDS, SIGNALS)
    assert by == (None if other else "x_in_mm")
    left = replace(fits[0].solution, residual=fits[1].solution.residual)  # tolerances do it too
    assert absorbed_by(replace(fits[0], solution=left), fits[1], EFFECT, FOLDS, SIGNALS) is None
