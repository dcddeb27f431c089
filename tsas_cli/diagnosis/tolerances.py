"""What every rig has by a small amount, and is no cause.

Friction that differs from run to run, load cells whose scale is off or bent or that feel the other
force, a sheath that is bent unevenly.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tsas_cli.identification.extension import FAR, UNEVEN, Bench, HypothesisFit
from tsas_cli.identification.fit import with_errors
from tsas_cli.identification.fit_problem import rig_at, unknown_of
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.identification.screening import projector
from tsas_cli.numerics.covariance import inverse_gram
from tsas_cli.physics.rig import Rig, with_values
from tsas_cli.support.arrays import Floats, Indices

FRICTION = "friction_coefficient"
PLAUSIBLE = 2.0  # standard deviations of it
SCATTER = 0.02  # standard deviation of the friction from run to run, relative
OF_A_LINE = 2  # frictions, that a line goes through
COINCIDENCE = 1e-3  # probability below which frictions in line are no coincidence
BEND = "bend_slope", "bend_bow"  # the modes of an uneven bend
LOAD_CELL = 0.0025  # standard deviation of a load cell's error, of its largest reading

# What is wrong of a load cell; with a channel, by newton of its largest reading.
LOAD_CELLS = {
    "force_sensor_gain.f_out_gain": None,
    "force_crosstalk.f_in_of_f_out": None,
    "force_crosstalk.f_out_of_f_in": None,
    "force_sensor_curvature.f_in_per_N": "f_in_N",
    "force_sensor_curvature.f_out_per_N": "f_out_N",
}


def friction_of_runs(trial: HypothesisFit, run: Indices) -> Floats:
    """Return the residuals' change by one standard deviation of each run's friction, (n, runs)."""
    column = next((j for j, u in enumerate(trial.unknowns) if u.name == FRICTION), None)
    runs = np.arange(int(run.max()) + 1)
    if column is None or runs.size < 2:
        return np.zeros((run.size, 0))
    slope = SCATTER * trial.solution.jacobian[:, column]
    return np.asarray(slope[:, None] * (run[:, None] == runs))


def tolerances(bench: Bench, trial: HypothesisFit) -> Floats:
    """Return the residuals' change by one standard deviation of load cells and bend, (n, m)."""
    fitted, without = trial.values(), bench.errors_at(trial, {})
    changes = [
        bench.errors_at(trial, {name: fitted.get(name, QUANTITIES[name].default) + size}) - without
        for name, size in _sizes(bench).items()
    ]
    return np.column_stack([*changes, bench.unevenness(trial)])


def _sizes(bench: Bench) -> dict[str, float]:
    """Return one standard deviation of each error of a load cell."""
    largest = largest_forces(bench)
    return {
        name: LOAD_CELL / (1.0 if channel is None else largest.get(channel, 1.0))
        for name, channel in LOAD_CELLS.items()
    }


def of_others(trial: HypothesisFit, tolerated: Floats) -> Floats:
    """Return what tolerances change, without those that an effect of the trial is about."""
    own = [name.partition(".")[0] in trial.effects for name in LOAD_CELLS]
    others = tolerated.copy()
    others[:, : len(own)][:, own] = 0.0
    return others


def largest_forces(bench: Bench) -> dict[str, float]:
    """Return the largest reading of each force sensor that is compared [N]."""
    return {
        name: max(
            float(np.abs(run.run.measured[name][run.samples[name]]).max())
            for run in bench.closed
            if name in run.samples
        )
        for name in bench.channels
        if name.endswith("_N")
    }


def without_tolerances(
    trial: HypothesisFit, tolerated: Floats, run: Indices | None = None
) -> Floats:
    """Return the residual without what plausible tolerances explain, shape (n,).

    `tolerated` are the residuals' changes by one standard deviation of each, shape (n, m). With
    `run`, the run of each residual, each run has a friction of its own beside them.
    """
    columns, amounts = _explained_by(trial, tolerated, run)
    if not amounts.size:
        return trial.solution.residual
    return np.asarray(trial.solution.residual - _beside(projector(trial), columns) @ amounts)


def rigs_with_tolerances(
    bench: Bench, trial: HypothesisFit, tolerated: Floats, run: Indices
) -> list[Rig]:
    """Return the rig of each run with the plausible tolerances that its residuals show.

    Linear: by the columns of `without_tolerances`, the other parameters moved by them.
    """
    columns, amounts = _explained_by(trial, tolerated, run)
    values = trial.solution.values - trial.moved_by(columns) @ amounts
    frictions, cells, bends = np.split(
        -amounts, np.cumsum((columns.shape[1] - tolerated.shape[1], len(LOAD_CELLS)))
    )
    fitted = trial.values()
    set_to = {
        name: QUANTITIES[name].scaled(QUANTITIES[name].default + size * float(part))
        for (name, size), part in zip(_sizes(bench).items(), cells, strict=True)
        if name not in fitted
    }
    unknowns = [*trial.unknowns, *map(unknown_of, set_to)]
    uneven = dict(zip(BEND, UNEVEN * bends, strict=True))
    friction = np.array([u.name == FRICTION for u in trial.unknowns])
    rigs = []
    for k, rig in enumerate(bench.rigs):
        moved = values + friction * (SCATTER * frictions[k] if frictions.size else 0.0)
        at = rig_at(rig, k, unknowns, np.append(moved, list(set_to.values())))
        rigs.append(with_values(at, uneven))
    return rigs


def _explained_by(
    trial: HypothesisFit, tolerated: Floats, run: Indices | None
) -> tuple[Floats, Floats]:
    """Return the columns of all tolerances, and how much of each explains the residual, bounded."""
    from scipy.optimize import lsq_linear

    residual = trial.solution.residual
    own = np.zeros((residual.size, 0)) if run is None else friction_of_runs(trial, run)
    columns = np.column_stack((own, tolerated))
    most = np.repeat((np.inf, PLAUSIBLE), (own.shape[1], tolerated.shape[1]))
    if not most.size:
        return columns, most
    beside = _beside(projector(trial), columns)
    root = np.linalg.cholesky(beside.T @ beside + np.eye(most.size))
    amounts = lsq_linear(root.T, np.linalg.solve(root, beside.T @ residual), (-most, most)).x
    return columns, np.asarray(amounts)


def within_tolerances(trial: HypothesisFit, effect: str, columns: Floats, reduction: float) -> bool:
    """Return whether most of what an effect changes is what plausible tolerances change too.

    `reduction` is that of the squares by the effect: where the other parameters nearly do what it
    does, its change is small beside them, and is not what it takes away.
    """
    own = np.array([u.name.partition(".")[0] == effect for u in trial.unknowns])
    J, values = trial.solution.jacobian, trial.solution.values
    held = replace(trial.solution, at_bound=trial.solution.at_bound | own)
    others = projector(replace(trial, solution=held))
    change = _beside(others, J[:, own] @ (values - _neutral(trial))[own])
    columns = _beside(others, columns)
    amounts = np.linalg.solve(columns.T @ columns + np.eye(columns.shape[1]), columns.T @ change)
    left = change - columns @ amounts
    plausible = bool(np.all(np.abs(amounts) <= PLAUSIBLE))
    squares = float(change @ change)
    return plausible and squares - float(left @ left) > 0.5 * max(squares, reduction)


def _neutral(trial: HypothesisFit) -> Floats:
    """Return the scaled values of the unknowns that change nothing, shape (p,)."""
    return np.array([QUANTITIES[u.name].scaled(QUANTITIES[u.name].default) for u in trial.unknowns])


def _beside(basis: Floats, columns: Floats) -> Floats:
    """Return columns, shape (n,) or (n, m), without what an orthonormal basis spans."""
    return np.asarray(columns - basis @ (basis.T @ columns))


def with_tolerances(trial: HypothesisFit, tolerated: Floats) -> HypothesisFit:
    """Return a fit with plausible tolerances free beside its unknowns.

    `tolerated` are the residuals' changes by one standard deviation of each, shape (n, m).
    """
    names = [(f"tolerance {k}", None, 1.0) for k in range(tolerated.shape[1])]
    return trial.with_columns(names, tolerated, PLAUSIBLE)


def with_friction_of_runs(trial: HypothesisFit, run: Indices) -> HypothesisFit:
    """Return a fit with a plausible friction of its own for each run."""
    columns = friction_of_runs(trial, run)
    names = [(f"{FRICTION} {k}", k, 1.0) for k in range(columns.shape[1])]
    return trial.with_columns(names, columns, PLAUSIBLE)


def is_in_line(trial: HypothesisFit, run: Indices, session_s: Floats) -> bool:
    """Return whether the frictions of the runs change with the session, and are no scatter.

    `session_s` is the start of each run in the session [s], shape (runs,). They are where their
    scatter about a line is too small for a coincidence (F test).
    """
    columns = friction_of_runs(trial, run)
    if columns.shape[1] <= OF_A_LINE or np.ptp(session_s) == 0.0:
        return False
    frictions = _left_of_frictions(trial, columns)
    line = np.column_stack((np.ones(session_s.size), session_s / np.ptp(session_s)))
    fitted = line @ np.linalg.lstsq(line, frictions, rcond=None)[0]
    return _by_chance(fitted, frictions - fitted) < COINCIDENCE


def _left_of_frictions(trial: HypothesisFit, columns: Floats) -> Floats:
    """Return the friction of each run that the residual of a fit has left, in deviations."""
    beside = _beside(projector(trial), columns)
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
    own = np.array([u.name.partition(".")[0] == effect for u in trial.unknowns])
    J = trial.solution.jacobian
    if not any(is_scatter(trial, column, run) for column in J[:, own].T):
        return False
    change = J[:, own] @ (trial.solution.values - _neutral(trial))[own]
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
    left = _beside(np.linalg.qr(columns)[0], column)
    return float(left @ left) < 0.1 * float(column @ column)


def scatter_is_no_effect(trial: HypothesisFit, run: Indices) -> bool:
    """Return whether no effect of a fit does what a friction of its own for each run does."""
    columns = zip(trial.solution.jacobian.T, trial.unknowns, strict=True)
    of_effects = (column for column, u in columns if u.name.partition(".")[0] in trial.effects)
    return not any(is_scatter(trial, column, run) for column in of_effects)


def moved_by_tolerances(
    trial: HypothesisFit, tolerated: Floats, blocks: Sequence[Indices]
) -> tuple[Floats, Floats]:
    """Return how far a trial's scaled values move with the likely tolerances, (p,), and covariance.

    `tolerated` are the residuals' changes by one standard deviation of each tolerance, shape (n,
    m); `blocks` has for each run the block of each residual. The covariance, (p, p), is what the
    tolerances leave unsure where the values are moved.
    """
    estimate, stderr = _estimated(trial, tolerated, blocks)
    trusted = 1.0 / (1.0 + stderr**2)  # weight against the prior, of standard deviation 1
    likely = np.clip(trusted * estimate, -PLAUSIBLE, PLAUSIBLE)
    moves = trial.moved_by(tolerated)
    return moves @ likely, np.asarray((moves * (trusted * stderr**2)) @ moves.T)


def _estimated(
    trial: HypothesisFit, tolerated: Floats, blocks: Sequence[Indices]
) -> tuple[Floats, Floats]:
    """Return the estimated tolerances, by one Gauss-Newton step, and their standard errors."""
    solution, count = trial.solution, tolerated.shape[1]
    J = np.hstack((solution.jacobian * ~solution.at_bound, tolerated))
    step = -inverse_gram(J) @ (J.T @ solution.residual)
    free = replace(trial, solution=replace(solution, jacobian=J[:, :-count]))
    names = [(f"tolerance {k}", None, 1.0) for k in range(count)]
    extended = free.with_columns(names, tolerated)
    found = with_errors(extended.unknowns, extended.solution, blocks, by_run=True)
    return step[-count:], np.minimum(found.stderr[-count:], FAR)
