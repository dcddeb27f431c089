"""Simulation of one run in a fit: samples compared and simulated, predictions at any rig."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from tsas_cli.identification.prepared import Prepared
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.lugre.chain import OWN_STEPS
from tsas_cli.physics.mechanics import mechanics_of
from tsas_cli.physics.response import (
    Dynamics,
    Prediction,
    SolvedRun,
    first_determined_sample,
    is_closed,
    read,
    solve,
)
from tsas_cli.physics.rig import Rig
from tsas_cli.support.arrays import Floats, Indices

MOST_MEANS = 1000  # means of neighbouring residuals that enter the fit, for a channel of a run
FEWEST_SAMPLES = 16  # of a channel, after the start of a run
PER_MEAN = 4.0  # simulated samples for each mean
MEANS_OF_STROKE = 75  # that a stroke counts for in that, at least
SHARP = 4  # strides after a reversal in which every sample is simulated


def mean_edges(size: int) -> Indices:
    """Return the first sample of each mean of neighbouring samples."""
    return np.arange(0, size, max(1, -(-size // MOST_MEANS)))


def points(run: Prepared, per_mean: float = PER_MEAN) -> Indices:
    """Return the samples simulated by a chain: some of each stroke, and all after a reversal.

    They are several times as many as means, or more for many strokes. The model depends on the
    path alone, and its prediction has a kink at a reversal.
    """
    n = run.time_s.size
    reversals = run.conditioned[run.drive_column].reversals
    wanted = per_mean * max(MOST_MEANS, MEANS_OF_STROKE * (reversals.size - 1))
    stride = max(1, int(n // wanted))
    followed = np.arange(n) % stride == 0
    for reversal in reversals:  # the last sample is one of them
        followed[reversal : reversal + SHARP * stride] = True
    return np.flatnonzero(followed)


def fitted_samples(run: Prepared, rig: Rig) -> dict[str, Indices]:
    """Return the samples of each channel that enter the fit, none where there are too few.

    They start where the prediction is independent of the history before the run and the drive has
    travelled as far again, as other parameters may need. Samples after the last motion beyond the
    noise are left out, and the sample of each reversal, which may lie before it or behind it. The
    channel's noise must be known.
    """
    first = first_determined_sample(rig, run.drive)
    if first is None:
        return {}
    travel = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(run.drive.values)))))
    usable = ~run.in_gap & (travel >= 2.0 * travel[first])
    drive = run.conditioned[run.drive_column]
    moving = np.flatnonzero(np.abs(drive.values - drive.values[-1]) > drive.smallest_reversal)
    if moving.size:
        usable[moving[-1] + 1 :] = False
    usable[drive.reversals[1:-1]] = False
    used = {
        name: np.flatnonzero(usable & np.isfinite(measured))
        for name, measured in run.measured.items()
        if run.noise[name] > 0.0
    }
    return {name: at for name, at in used.items() if at.size >= FEWEST_SAMPLES}


def left_out_notes(run: Prepared, samples: Mapping[str, Indices]) -> list[str]:
    """Return a sentence for each channel or run that does not enter the fit."""
    flat = [name for name, noise in run.noise.items() if noise == 0.0]
    short = [name for name in run.measured if name not in samples and name not in flat]
    notes = [f"{name} of run {run.run.id} does not enter the fit: it is constant." for name in flat]
    if not samples and short:
        notes.append(
            f"Run {run.run.id} does not enter the fit: too few samples after the first full slip, "
            "before which its prediction depends on the unknown history."
        )
        return notes
    return notes + [
        f"{name} of run {run.run.id} does not enter the fit: it has too few samples."
        for name in short
    ]


Predictions = dict[str, Floats]  # of each channel at all samples, shape (n,)

CACHED_RIGS = 32  # whose solutions are cached: all that a Jacobian returns to
CACHED_SAMPLES = 2**19  # of all of them together, at most; a solution takes some 50 bytes for each


@dataclass(frozen=True, eq=False)
class RunSimulation:
    """Settings of the simulation of a run.

    A chain simulates the samples `points`. With `nodes` it is a slip chain of that many;
    `step_ends_s` are the steps of the dynamic model at any rig: with its own steps each rig would
    have its own small errors, which would dominate finite differences.
    """

    drive: DriveInput
    points: Indices
    tolerance: float
    dynamics: Dynamics
    step_ends_s: Floats
    nodes: int | None = None


def run_simulation(run: Prepared, dynamics: Dynamics = "slip") -> RunSimulation:
    """Return the simulation of a run from rest: a fit excludes samples that depend on the start."""
    drive = replace(run.drive, start_f_in_N=None)
    return RunSimulation(drive, points(run), run.step_tolerance, dynamics, OWN_STEPS)


def with_steps_at(simulation: RunSimulation, rig: Rig) -> RunSimulation:
    """Return the simulation with the steps that the dynamic model chooses at a rig."""
    _, own = _solved(simulation, rig, simulation.drive, OWN_STEPS)
    return replace(simulation, step_ends_s=own.step_ends_s)


def predictor(simulation: RunSimulation) -> Callable[[Rig], Predictions]:
    """Return the predictions of the run's own drive as a function of the rig.

    The last solutions are cached: a rig that differs in its sensors alone is not solved again. The
    cache belongs to the function and not to the record, which would form a reference cycle:
    each of thousands of calibrations in one process would then retain megabytes.
    """
    drive, steps = simulation.drive, simulation.step_ends_s
    rigs = max(2, min(CACHED_RIGS, CACHED_SAMPLES // drive.values.size))
    solved = lru_cache(maxsize=rigs)(lambda rig: _solved(simulation, rig, drive, steps))

    def predictions(rig: Rig) -> Predictions:
        return _at_samples(simulation, read(rig, *solved(mechanics_of(rig, drive))))

    return predictions


def predict_driven(
    simulation: RunSimulation,
    rig: Rig,
    *,
    values: Floats | None = None,
    load_values: Floats | None = None,
) -> Predictions:
    """Return the predictions with another drive of an end, with their own steps."""
    drive = simulation.drive
    if values is not None:
        drive = replace(drive, values=values)
    if load_values is not None:
        drive = replace(drive, load_values=load_values)
    return _at_samples(simulation, read(rig, *_solved(simulation, rig, drive, OWN_STEPS)))


def _solved(
    simulation: RunSimulation, rig: Rig, drive: DriveInput, step_ends_s: Floats
) -> tuple[DriveInput, SolvedRun]:
    """Return drive and solution at all samples by the closed form, or at `points` by a chain."""
    slip = simulation.nodes is None and simulation.dynamics == "slip"
    at = slice(None) if slip and is_closed(rig, drive) else simulation.points
    followed = drive.part(at)
    return followed, solve(
        rig,
        followed,
        simulation.dynamics,
        nodes=simulation.nodes,
        tolerance=simulation.tolerance,
        step_ends_s=step_ends_s,
    )


def _at_samples(simulation: RunSimulation, response: Prediction) -> Predictions:
    """Return the predictions at all samples, interpolated linearly between simulated ones."""
    channels = {
        "f_in_N": response.f_in_N,
        "f_out_N": response.f_out_N,
        "x_out_mm": response.x_out_mm,
    }
    n = simulation.drive.values.size
    if response.f_in_N.size == n:
        return channels
    at = np.arange(n)
    return {name: np.interp(at, simulation.points, each) for name, each in channels.items()}
