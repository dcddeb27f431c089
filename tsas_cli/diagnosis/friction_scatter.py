"""The scatter of friction from run to run: what every rig has, and is no cause."""

from dataclasses import replace

import numpy as np

from tsas_cli.identification.extension import Bench
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.identification.screening import orthogonal_to, projector
from tsas_cli.support.arrays import Floats, Indices

FRICTION = "friction_coefficient"
PLAUSIBLE = 2.0  # standard deviations of a tolerance
SCATTER = 0.02  # standard deviation of the friction from run to run, relative
OF_A_LINE = 2  # frictions, that a line goes through
EQUAL = 1e-3  # relative difference, within which a quantity is the same in two runs
LEFT = 0.3  # of the excess over the noise, by frictions of the runs' own that are the reason of it
COINCIDENCE = 1e-3  # probability below which frictions in line are no coincidence


def friction_of_runs(trial: HypothesisFit, run: Indices) -> Floats:
    """Return the residuals' change by one standard deviation of each run's friction, (n, runs)."""
    column = next((j for j, u in enumerate(trial.unknowns) if u.name == FRICTION), None)
    runs = np.arange(int(run.max()) + 1)
    if column is None or runs.size < 2:
        return np.zeros((run.size, 0))
    slope = SCATTER * trial.solution.jacobian[:, column]
    return np.asarray(slope[:, None] * (run[:, None] == runs))


def with_friction_of_runs(trial: HypothesisFit, run: Indices) -> HypothesisFit:
    """Return a fit with a plausible friction of its own for each run."""
    columns = friction_of_runs(trial, run)
    names = [(f"{FRICTION} {k}", k, 1.0) for k in range(columns.shape[1])]
    return trial.with_columns(names, columns, PLAUSIBLE)


def frictions_that_explain(bench: Bench, trial: HypothesisFit) -> Floats:
    """Return by which share each run's own friction exceeds the mean, shape (runs,).

    They are fitted, however much they differ. Empty where they do not explain most of what a trial
    without effects leaves over the noise, or no friction is fitted.
    """
    shared = next((u for u in bench.free if u.name == FRICTION), None)
    if shared is None or trial.mean_square <= 1.0:
        return np.zeros(0)
    own = [replace(shared, run=k) for k in range(len(bench.rigs))]
    others = [u for u in bench.free if u is not shared]
    fitted = replace(bench, free=(*own, *others)).fit(near=trial, on_mesh=trial.on_mesh)
    if fitted.mean_square - 1.0 > LEFT * (trial.mean_square - 1.0):
        return np.zeros(0)
    scaled = fitted.solution.values[: len(own)]
    values = np.array([QUANTITIES[FRICTION].unscaled(v) for v in scaled])
    return np.asarray(values / values.mean() - 1.0)


def is_in_line(trial: HypothesisFit, run: Indices, over: Floats) -> bool:
    """Return whether the frictions of the runs follow a quantity, and are no scatter.

    `over` is the quantity, of each run, shape (runs,): its start in the session, or the inverse of
    its bend, which a friction follows that does not grow with it. They do where their scatter
    about a line is too small for a coincidence (F test), and the line does not stand on one run,
    whose bend may be stated wrong.
    """
    columns = friction_of_runs(trial, run)
    if columns.shape[1] <= OF_A_LINE:
        return False
    if any(np.ptp(np.delete(over, k)) <= EQUAL * np.abs(over).max() for k in range(over.size)):
        return False
    frictions = _left_of_frictions(trial, columns)
    fitted = on_a_line(over, frictions)
    return _by_chance(fitted, frictions - fitted) < COINCIDENCE


def on_a_line(over: Floats, frictions: Floats) -> Floats:
    """Return the frictions on the line over a quantity that fits them best, shape (runs,)."""
    line = np.column_stack((np.ones(over.size), over / np.ptp(over)))
    return np.asarray(line @ np.linalg.lstsq(line, frictions, rcond=None)[0])


def _left_of_frictions(trial: HypothesisFit, columns: Floats) -> Floats:
    """Return the friction of each run that the residual of a fit has left, in deviations."""
    beside = orthogonal_to(projector(trial), columns)
    return np.asarray(np.linalg.lstsq(beside, trial.solution.residual, rcond=1e-6)[0])


def _by_chance(line: Floats, scatter: Floats) -> float:
    """Return the probability of frictions on a line, with a scatter about it (F test)."""
    from scipy.special import fdtrc

    free, squares = line.size - OF_A_LINE, float(scatter @ scatter)
    size = float(np.sum((line - line.mean()) ** 2))
    return float(fdtrc(1, free, size * free / squares)) if squares > 0.0 else 0.0


def within_scatter(trial: HypothesisFit, effect: str, run: Indices) -> bool:
    """Return whether an effect is no more than a plausible friction of its own for each run.

    It is more where the scatter of the frictions about it is too small for a coincidence (F test).
    """
    columns = friction_of_runs(trial, run)
    slopes = trial.solution.jacobian[:, trial.of_effect(effect)]
    if not any(is_scatter(trial, column, run) for column in slopes.T):
        return False
    change = trial.change_by(effect)
    common = columns.sum(axis=1)  # what the friction coefficient does
    change = change - common * float(common @ change) / float(common @ common)
    frictions = np.linalg.lstsq(columns, change, rcond=None)[0]
    left = change - columns @ frictions
    if float(left @ left) > 0.5 * float(change @ change):
        return False
    size = float(np.sum((frictions - frictions.mean()) ** 2))
    few = frictions.size <= OF_A_LINE
    by_chance = 1.0 if few else _by_chance(frictions, _left_of_frictions(trial, columns))
    return size <= PLAUSIBLE**2 and by_chance > COINCIDENCE


def is_scatter(trial: HypothesisFit, column: Floats, run: Indices) -> bool:
    """Return whether a column of the Jacobian is nearly a friction of each run's own."""
    columns = friction_of_runs(trial, run)
    if not columns.shape[1]:
        return False
    left = orthogonal_to(np.linalg.qr(columns)[0], column)
    return float(left @ left) < 0.1 * float(column @ column)


def scatter_is_no_effect(trial: HypothesisFit, run: Indices) -> bool:
    """Return whether no effect of a fit does what a friction of its own for each run does."""
    columns = zip(trial.solution.jacobian.T, trial.unknowns, strict=True)
    of_effects = (column for column, u in columns if u.name.partition(".")[0] in trial.effects)
    return not any(is_scatter(trial, column, run) for column in of_effects)
