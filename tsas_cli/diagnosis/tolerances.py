"""What every rig has by a small amount, and is no cause.

Load cells whose scale is off or bent or that feel the other force, friction that reverses over a
few micrometres and not at once, a sheath that is bent unevenly; beside them the friction of each
run (`friction_scatter`). The scale of a position sensor and the zeros of load cells in each run
count in what is left, and are not free beside a search: they would take a free length of tendon.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from tsas_cli.diagnosis.friction_scatter import FRICTION, PLAUSIBLE, SCATTER, friction_of_runs
from tsas_cli.effects.force_sensor_drift import reading_in_session
from tsas_cli.identification.extension import Bench
from tsas_cli.identification.fit import with_errors
from tsas_cli.identification.fit_problem import rig_at, unknown_of
from tsas_cli.identification.hypothesis_fit import FAR, HypothesisFit
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.identification.screening import orthogonal_to, projector
from tsas_cli.numerics.covariance import inverse_gram
from tsas_cli.physics.rig import Rig, with_values
from tsas_cli.support.arrays import Floats, Indices

BEND = "bend_slope", "bend_bow"  # the modes of an uneven bend
UNEVEN = 0.05  # standard deviation of a sheath's relative variation of curvature
PRESLIDING = "presliding"
GROWTH = f"{PRESLIDING}.growth"
TRAVEL, TRAVEL_MM = f"{PRESLIDING}.length_mm", 0.003  # asperities of metal give way by so much
LONGEST_MM = PLAUSIBLE * TRAVEL_MM
LOAD_CELL = 0.0025  # standard deviation of a load cell's error, of its largest reading
POSITION = 0.001  # the same of a position sensor's scale
ZERO = 0.002  # the same of a load cell's zero, from run to run
FORCES, X_OUT = ("f_in_N", "f_out_N"), "x_out_mm"

# What is wrong of a load cell; with a channel, by newton of its largest reading.
LOAD_CELLS = {
    "force_sensor_gain.f_out_gain": None,
    "force_crosstalk.f_in_of_f_out": None,
    "force_crosstalk.f_out_of_f_in": None,
    "force_sensor_curvature.f_in_per_N": "f_in_N",
    "force_sensor_curvature.f_out_per_N": "f_out_N",
}


def tolerances(bench: Bench, trial: HypothesisFit) -> Floats:
    """Return the residuals' change by one standard deviation of each tolerance, (n, m)."""
    fitted, without = trial.values(), bench.errors_at(trial, {})
    moved = {
        name: fitted.get(name, QUANTITIES[name].default) + size
        for name, size in _sizes(bench).items()
    }
    on_chain = [{TRAVEL: moved.pop(TRAVEL)}, *({mode: UNEVEN} for mode in BEND)]
    changes = [bench.errors_at(trial, {name: value}) - without for name, value in moved.items()]
    return np.column_stack([*changes, bench.changes_on_chain(trial, on_chain)])


def _sizes(bench: Bench) -> dict[str, float]:
    """Return one standard deviation of each parameter of an effect that is a tolerance."""
    largest = largest_forces(bench)
    cells = {
        name: LOAD_CELL / (1.0 if channel is None else largest.get(channel, 1.0))
        for name, channel in LOAD_CELLS.items()
    }
    return cells | {TRAVEL: TRAVEL_MM}


def of_others(trial: HypothesisFit, tolerated: Floats) -> Floats:
    """Return what tolerances change, without those that an effect of the trial is about."""
    own = [name.partition(".")[0] in trial.effects for name in (*LOAD_CELLS, TRAVEL)]
    others = tolerated.copy()
    others[:, : len(own)][:, own] = 0.0
    return others


def without_travel(tolerated: Floats) -> Floats:
    """Return what tolerances change but for the elastic travel."""
    return np.delete(tolerated, len(LOAD_CELLS), axis=1)


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


def with_scale_and_zeros(bench: Bench, trial: HypothesisFit, tolerated: Floats) -> Floats:
    """Return what tolerances change, (n, m), with the scale of x_out and the zeros of each run.

    The zeros of the force sensors come last, run by run, where there are several runs.
    """
    from scipy.linalg import block_diag

    runs, zeros = bench.errors_for(trial), _zeros(bench) if len(bench.rigs) > 1 else {}
    scale, own = [], []
    for k, run in enumerate(runs):
        x_out = run.predict(bench.rig(trial, k))[X_OUT]
        scale.append(run.changed({X_OUT: POSITION * x_out}))
        columns = [run.changed({n: np.full(x_out.size, size)}) for n, size in zeros.items()]
        own.append(np.reshape(columns, (len(zeros), run.count)).T)
    return np.column_stack((tolerated, np.concatenate(scale), block_diag(*own)))


def _zeros(bench: Bench) -> dict[str, float]:
    """Return one standard deviation of the zero of each force sensor that is compared [N]."""
    return {name: ZERO * size for name, size in largest_forces(bench).items()}


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
    return np.asarray(trial.solution.residual - orthogonal_to(projector(trial), columns) @ amounts)


def rigs_with_tolerances(
    bench: Bench, trial: HypothesisFit, tolerated: Floats, run: Indices
) -> list[Rig]:
    """Return the rig of each run with the plausible tolerances that its residuals show.

    Linear: by the columns of `without_tolerances`, those `with_scale_and_zeros` or without, the
    other parameters moved by them within their bounds.
    """
    columns, amounts = _explained_by(trial, tolerated, run)
    lower, upper = np.array([(u.lower, u.upper) for u in trial.unknowns]).T
    values = np.clip(trial.solution.values - trial.moved_by(columns) @ amounts, lower, upper)
    fitted, sizes = trial.values(), _sizes(bench)
    parts = columns.shape[1] - tolerated.shape[1], len(sizes), len(BEND), 1
    frictions, of_effects, bends, scale, zeros = np.split(-amounts, np.cumsum(parts))
    of_effects[len(LOAD_CELLS)] = max(of_effects[len(LOAD_CELLS)], 0.0)  # no length is negative
    set_to = {
        name: QUANTITIES[name].scaled(QUANTITIES[name].default + size * float(part))
        for (name, size), part in zip(sizes.items(), of_effects, strict=True)
        if name not in fitted
    }
    unknowns = [*trial.unknowns, *map(unknown_of, set_to)]
    uneven = dict(zip(BEND, UNEVEN * bends, strict=True))
    friction = np.array([u.name == FRICTION for u in trial.unknowns])
    sizes_N = _zeros(bench) if zeros.size else {}
    own_zeros = zeros.reshape(len(bench.rigs), len(sizes_N))
    rigs = []
    for k, rig in enumerate(bench.rigs):
        moved = values + friction * (SCATTER * frictions[k] if frictions.size else 0.0)
        at = rig_at(rig, k, unknowns, np.append(moved, list(set_to.values())))
        of_sensors = _of_sensors(at, float(scale.sum()), sizes_N, own_zeros[k])
        rigs.append(with_values(at, uneven | of_sensors))
    return rigs


def _of_sensors(
    rig: Rig, scale: float, zeros: Mapping[str, float], amounts: Floats
) -> dict[str, float]:
    """Return the scale of x_out and the offsets of a rig, moved by so many standard deviations."""
    gain, offsets = rig.effects.position_sensor_gain.x_out_gain, rig.effects.force_sensor_offset
    moved = {"position_sensor_gain.x_out_gain": gain * (1.0 + POSITION * scale)}
    for (channel, size), amount in zip(zeros.items(), amounts.tolist(), strict=True):
        name = f"{channel.removesuffix('_N')}_offset_N"
        moved[f"force_sensor_offset.{name}"] = getattr(offsets, name) + size * amount
    return moved


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
    beside = orthogonal_to(projector(trial), columns)
    root = np.linalg.cholesky(beside.T @ beside + np.eye(most.size))
    amounts = lsq_linear(root.T, np.linalg.solve(root, beside.T @ residual), (-most, most)).x
    return columns, np.asarray(amounts)


def frictions_of(trial: HypothesisFit, tolerated: Floats, run: Indices) -> Floats:
    """Return by which share the friction of each run exceeds the mean, beside tolerances, (runs,).

    Empty where no friction is fitted, or one run alone is.
    """
    columns, amounts = _explained_by(trial, tolerated, run)
    frictions = -SCATTER * amounts[: columns.shape[1] - tolerated.shape[1]]
    return frictions - frictions.mean() if frictions.size else frictions


def within_tolerances(trial: HypothesisFit, effect: str, columns: Floats, reduction: float) -> bool:
    """Return whether most of what an effect changes is what plausible tolerances change too.

    `reduction` is that of the squares by the effect: where the other parameters nearly do what it
    does, its change is small beside them, and is not what it takes away.
    """
    held = replace(trial.solution, at_bound=trial.solution.at_bound | trial.of_effect(effect))
    others = projector(replace(trial, solution=held))
    change = orthogonal_to(others, trial.change_by(effect))
    columns = orthogonal_to(others, columns)
    amounts = np.linalg.solve(columns.T @ columns + np.eye(columns.shape[1]), columns.T @ change)
    left = change - columns @ amounts
    plausible = bool(np.all(np.abs(amounts) <= PLAUSIBLE))
    squares = float(change @ change)
    return plausible and squares - float(left @ left) > 0.5 * max(squares, reduction)


def scale_is_tolerated(trial: HypothesisFit) -> bool:
    """Return whether the scale of a position sensor is off by no more than a good one's is."""
    return abs(trial.values()["position_sensor_gain.x_out_gain"] - 1.0) <= PLAUSIBLE * POSITION


def zeros_are_tolerated(bench: Bench, trial: HypothesisFit) -> bool:
    """Return whether force sensors drift by no more than a zero that nobody sets again does."""
    largest = largest_forces(bench)
    for k, run in enumerate(bench.closed):
        drift, time_s = bench.rig(trial, k).effects.force_sensor_drift, run.run.time_s
        ends_s = np.array([0.0, time_s[-1] - time_s[0]])
        for sensor, name in enumerate(FORCES):
            off = np.abs(reading_in_session(0.0, drift, sensor, ends_s, run.run.session_s))
            if np.any(off > PLAUSIBLE * ZERO * largest.get(name, math.inf)):
                return False
    return True


def with_tolerances(trial: HypothesisFit, tolerated: Floats) -> HypothesisFit:
    """Return a fit with plausible tolerances free beside its unknowns.

    `tolerated` are the residuals' changes by one standard deviation of each, shape (n, m).
    """
    names = [(f"tolerance {k}", None, 1.0) for k in range(tolerated.shape[1])]
    return trial.with_columns(names, tolerated, PLAUSIBLE)


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
