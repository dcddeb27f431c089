"""One run as a model follows it: its drive, its mesh, and the predictions at any rig."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache, partial

import numpy as np
import numpy.typing as npt

from tsas_cli.identification.prepared import Prepared
from tsas_cli.identification.samples import points
from tsas_cli.physics.ends import Drive
from tsas_cli.physics.lugre.chain import OWN_STEPS
from tsas_cli.physics.response import Dynamics, Response, is_closed, simulate
from tsas_cli.physics.rig import Rig

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]
Predictions = dict[str, Floats]  # of each channel at all samples, shape (n,)

LAST = 2  # rigs whose predictions are cached: those of the last step, and of the one before


@dataclass(frozen=True, eq=False)
class RunSimulation:
    """How a model follows a run.

    A chain follows the samples `points`. `nodes` asks for a slip chain with as many of them;
    `step_ends_s` are the steps of the dynamic model at any rig: with steps of its own each would
    have its own small errors, in which finite differences drown.
    """

    drive: Drive
    points: Indices
    tolerance: float
    dynamics: Dynamics
    step_ends_s: Floats
    nodes: int | None = None


def run_simulation(run: Prepared, dynamics: Dynamics = "slip") -> RunSimulation:
    """Return the simulation of a run, begun at rest: a fit leaves out what the start shows in."""
    drive = replace(run.drive, start_f_in_N=None)
    return RunSimulation(drive, points(run), run.step_tolerance, dynamics, OWN_STEPS)


def with_steps_at(simulation: RunSimulation, rig: Rig) -> RunSimulation:
    """Return the simulation with the steps that the dynamic model chooses at a rig."""
    own = _response(simulation, rig, simulation.drive, OWN_STEPS)
    return replace(simulation, step_ends_s=own.step_ends_s)


def predictor(simulation: RunSimulation) -> Callable[[Rig], Predictions]:
    """Return the predictions of the run's own drive as a function of the rig, the last ones cached.

    The cache hangs on this function and not on the record, which would hold itself in a cycle:
    thousands of calibrations in one process would then grow by megabytes each.
    """
    return lru_cache(maxsize=LAST)(partial(_predictions, simulation))


def _predictions(simulation: RunSimulation, rig: Rig) -> Predictions:
    response = _response(simulation, rig, simulation.drive, simulation.step_ends_s)
    return _at_samples(simulation, response)


def predict_driven(
    simulation: RunSimulation,
    rig: Rig,
    *,
    values: Floats | None = None,
    load_values: Floats | None = None,
) -> Predictions:
    """Return the predictions where an end is driven otherwise, with steps of their own."""
    drive = simulation.drive
    if values is not None:
        drive = replace(drive, values=values)
    if load_values is not None:
        drive = replace(drive, load_values=load_values)
    return _at_samples(simulation, _response(simulation, rig, drive, OWN_STEPS))


def _response(simulation: RunSimulation, rig: Rig, drive: Drive, step_ends_s: Floats) -> Response:
    """Simulate all samples by the closed form, those in `points` by a chain."""
    slip = simulation.nodes is None and simulation.dynamics == "slip"
    at = slice(None) if slip and is_closed(rig, drive) else simulation.points
    load = None if drive.load_values is None else drive.load_values[at]
    time_s = None if drive.time_s is None else drive.time_s[at]
    return simulate(
        rig,
        replace(drive, values=drive.values[at], load_values=load, time_s=time_s),
        simulation.dynamics,
        on_mesh=simulation.nodes is not None,
        nodes=simulation.nodes,
        tolerance=simulation.tolerance,
        step_ends_s=step_ends_s,
    )


def _at_samples(simulation: RunSimulation, response: Response) -> Predictions:
    """Return the predictions at all samples, straight between those simulated."""
    there = {
        "f_in_N": response.f_in_N,
        "f_out_N": response.f_out_N,
        "x_out_mm": response.x_out_mm,
    }
    n = simulation.drive.values.size
    if response.f_in_N.size == n:
        return there
    at = np.arange(n)
    return {name: np.interp(at, simulation.points, each) for name, each in there.items()}
