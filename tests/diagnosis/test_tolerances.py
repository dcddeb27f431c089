"""Friction that differs from run to run, on linear fits to data that are made up."""

import numpy as np
import pytest

from tsas_cli.diagnosis.constancy import worst_split
from tsas_cli.diagnosis.held_out import folds_of
from tsas_cli.diagnosis.tolerances import is_scatter, within_scatter, without_scatter
from tsas_cli.identification.extension import HypothesisFit
from tsas_cli.identification.fit import Solution, Unknown

RUNS, ROWS = 4, 500
RUN = np.repeat(np.arange(RUNS), ROWS)
FOLDS = folds_of([np.arange(ROWS) * 12 // ROWS for _ in range(RUNS)])
RNG = np.random.default_rng(8)
FRICTION = 50.0 * RNG.standard_normal(RUN.size)  # residuals by a relative change of the friction
OTHER = RNG.standard_normal(RUN.size)
DRIFT = "friction_drift.session_rate_per_s"


def fit(errors, *columns):
    """Return the fit of the friction and of further columns, by name, to errors plus noise."""
    J = np.column_stack([FRICTION, *(column for _, column in columns)])
    data = errors + np.random.default_rng(9).standard_normal(RUN.size)
    values = np.linalg.lstsq(J, data, rcond=None)[0]
    names = ["friction_coefficient", *(name for name, _ in columns)]
    unknowns = tuple(Unknown(name, None, 0.0, -1e6, 1e6, 1.0) for name in names)
    solution = Solution(values, np.zeros(values.size, bool), J @ values - data, J, True, "", 1)
    return HypothesisFit((), unknowns, solution, (ROWS,) * RUNS, on_mesh=False)


@pytest.mark.parametrize(("scatter", "left"), [(0.02, 0.05), (0.2, 0.3)])
def test_a_plausible_scatter_is_left_out_of_the_residual_and_a_large_one_less(scatter, left):
    """Of four runs two have more friction and two less; the mean is fitted."""
    per_run = scatter * np.array([1.0, -1.0, 1.0, -1.0])[RUN]
    trial = fit(FRICTION * per_run)
    before = float(np.mean(trial.solution.residual**2)) - 1.0
    after = float(np.mean(without_scatter(trial, RUN) ** 2)) - 1.0
    assert before == pytest.approx((50.0 * scatter) ** 2, rel=0.2)
    assert abs(after) < left * max(before, 1.0)


def test_what_no_friction_explains_stays():
    trial = fit(3.0 * np.sign(OTHER))
    left = without_scatter(trial, RUN)
    assert float(left @ left) > 0.98 * float(trial.solution.residual @ trial.solution.residual)


def test_a_column_of_one_friction_for_each_run_is_scatter():
    trial = fit(np.zeros(RUN.size))
    assert is_scatter(trial, FRICTION * RUN, RUN)
    assert not is_scatter(trial, OTHER, RUN)
    assert not is_scatter(trial, FRICTION * np.linspace(-1.0, 1.0, RUN.size) ** 3, RUN * 0)


def test_a_drift_from_run_to_run_that_follows_no_trend_is_scatter():
    signals = {"x_in_mm": RNG.standard_normal(RUN.size)}

    def split(per_run):
        errors = FRICTION * np.array(per_run)[RUN]
        trial = fit(errors, (DRIFT, FRICTION * RUN))
        return worst_split(trial, "friction_drift", FOLDS, signals, tuple("abcd"))

    assert split([-0.03, -0.01, 0.01, 0.03]) is None
    found = split([-0.03, 0.04, -0.02, 0.05])
    assert (found.by, found.scatter) == ("run", True)
    large = split([-0.30, 0.10, -0.25, 0.45])
    assert (large.by, large.scatter) == ("run", False)


def test_most_of_what_is_within_scatter_is_one_friction_for_each_run():
    trial, per_run = fit(np.zeros(RUN.size)), np.array([-0.03, 0.01, 0.03, -0.01])[RUN]
    assert within_scatter(trial, FRICTION * per_run, RUN)
    assert not within_scatter(trial, FRICTION * 3.0 * per_run, RUN)
    within_runs = 0.1 * np.sin(np.arange(RUN.size))
    assert not within_scatter(trial, FRICTION * (per_run + within_runs), RUN)
    assert not within_scatter(trial, FRICTION * (0.3 + 0.1 * per_run + 0.1 * within_runs), RUN)
