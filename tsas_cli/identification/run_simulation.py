"""Simulation of one run: its drive, its mesh, and the predictions at any rig."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from tsas_cli.identification.prepared import Prepared
from tsas_cli.identification.samples import points
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.lugre.chain import OWN_STEPS
from tsas_cli.physics.response import (
    Dynamics,
    Prediction,
    SolvedRun,
    is_closed,
    mechanics_of,
    read,
    solve,
)
from tsas_cli.physics.rig import Rig
from tsas_cli.support.arrays import Floats, Indices

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
