"""Simulate one run: choice of the solver, initial state, sensor readings."""

import math
from dataclasses import dataclass, field, replace
from operator import attrgetter
from typing import Literal, TypedDict, Unpack

import numpy as np

from tsas_cli.effects import EFFECTS, LAWS, Effects
from tsas_cli.physics.boundary import FORCE
from tsas_cli.physics.closed_form.branches import (
    BranchState,
    branches_at_rest,
    follow_branches,
    with_room,
)
from tsas_cli.physics.closed_form.static import StaticState, follow_static
from tsas_cli.physics.course import DIRECTION, MOTION, Output, samples_of
from tsas_cli.physics.ends import DriveInput, EndInputs, boundary_of, ends_of, force_at_drive
from tsas_cli.physics.frames import Frames, empty_frames
from tsas_cli.physics.lugre.chain import OWN_STEPS, StepControl, lugre_chain
from tsas_cli.physics.mesh import MOST_NODES
from tsas_cli.physics.phases import SLACK, Phases
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.sensors import new_memory, reading, sensed
from tsas_cli.physics.slip.chain import ChainState, follow, initial_state, rest_after
from tsas_cli.support.arrays import Floats, Indices

Dynamics = Literal["static", "slip", "lugre"]
State = BranchState | ChainState | StaticState

NODES = 60  # of the slip chain, where the closed form is not valid
LUMPS = 50  # of the dynamic chain
TOLERANCE = 2.5e-6  # error that a step of the dynamic chain may add, over a tension
CLOSED, STATIC = 0, -1  # nodes of the closed form, and of the lumped dead bands
MOST_DOUBLINGS = 30  # of the drive's travel before a run
ON_CHAIN = tuple(e.name for e in (*EFFECTS, *LAWS) if not e.closed_form)
_effects_on_chain = attrgetter(*ON_CHAIN)
_NEUTRAL_ON_CHAIN = _effects_on_chain(Effects())


@dataclass(frozen=True)
class Prediction:
    """A prediction: simulated sensor readings, shape (n,) [mm, N].

    `phase` is +1 in contraction and −1 in loosening with the whole tendon slipping, 0 in a dead
    band, 2 slack, 3 not converged. `solver` names the solver; `step_ends_s` are the ends of the
    steps of the dynamic chain, empty with any other solver. `frames` are the profiles along the
    tendon at the requested samples, without the sensors' errors; None without a request.
    """

    x_in_mm: Floats
    x_out_mm: Floats
    f_in_N: Floats
    f_out_N: Floats
    phase: Phases
    solver: str
    step_ends_s: Floats = field(default_factory=OWN_STEPS.copy)
    frames: Frames | None = None


@dataclass(frozen=True)
class SolvedRun:
    """A run before its sensors read it: output of the solver, and what `Prediction` says of it."""

    output: Output
    solver: str
    step_ends_s: Floats = field(default_factory=OWN_STEPS.copy)
    frames: Frames | None = None


class Solver(TypedDict, total=False):
    """How a run is solved.

    With `nodes` a chain of that many is used even where the closed form is valid: models that are
    compared must share a mesh. `tolerance` is the error of a tension that a step of the dynamic
    chain may add, over the larger tension of the ends; `step_ends_s` are given steps, of another
    run. `looked_at` are samples, increasing, shape (k,), for profiles along the tendon: those of
    the slip chain, which solves the run then.
    """

    nodes: int | None
    tolerance: float
    step_ends_s: Floats
    looked_at: Indices | None


def simulate(
    rig: Rig, drive: DriveInput, dynamics: Dynamics = "slip", **how: Unpack[Solver]
) -> Prediction:
    """Return the readings of the sensors in the run that `solve` returns for these parameters."""
    return read(rig, drive, solve(rig, drive, dynamics, **how))


def read(rig: Rig, drive: DriveInput, solved: SolvedRun) -> Prediction:
    """Return the sensor readings of a solved run."""
    boundary, motor_mm = boundary_of(drive), drive.motor_mm
    signals = sensed(solved.output, drive.time_s, rig, boundary, new_memory(), motor_mm)
    response = readings_of(rig, drive, signals, solved.solver)
    return replace(response, step_ends_s=solved.step_ends_s, frames=solved.frames)


def solve(
    rig: Rig, drive: DriveInput, dynamics: Dynamics = "slip", **how: Unpack[Solver]
) -> SolvedRun:
    """Return the solution of the distributed model (`slip`), the static or the dynamic one.

    The distributed model uses the closed form where that is valid (`is_closed`), and the slip chain
    elsewhere, or with `nodes` or `looked_at`. The static one (`static`) has the limits of the
    closed form; the dynamic one (`lugre`) needs the times of the samples.

    ValueError: a number of nodes that no chain has, or profiles of a model that has none.
    """
    nodes, looked_at = how.get("nodes"), how.get("looked_at")
    if nodes is not None and not 2 <= nodes <= MOST_NODES:
        raise ValueError(f"{nodes} nodes; expected 2 to {MOST_NODES}")
    if looked_at is not None and dynamics != "slip":
        raise ValueError(f"profiles along the tendon with dynamics {dynamics!r}; expected 'slip'")
    if dynamics == "lugre":
        steps = how.get("tolerance", TOLERANCE), how.get("step_ends_s", OWN_STEPS)
        return _dynamic(rig, drive, nodes or LUMPS, StepControl(*steps))
    nodes = nodes_of(rig, drive, dynamics, nodes if looked_at is None else nodes or NODES)
    ends = ends_of(rig, drive)
    before = history(rig, ends, drive, nodes)
    skip = len(before)
    frames = None if looked_at is None else empty_frames(looked_at + skip, nodes)
    output = samples_of(_solve(rig, ends.after(before), nodes, frames), slice(skip, None))
    frames = frames and frames._replace(samples=frames.samples - skip)
    return SolvedRun(output, solver_of(nodes), frames=frames)


def nodes_of(rig: Rig, drive: DriveInput, dynamics: Dynamics, nodes: int | None) -> int:
    """Return the nodes of a quasi-static solver, `STATIC` or `CLOSED` where it has none."""
    if dynamics == "static":
        return STATIC
    return nodes or (CLOSED if is_closed(rig, drive) else NODES)


def _dynamic(rig: Rig, drive: DriveInput, lumps: int, control: StepControl) -> SolvedRun:
    """Return the solution of the dynamic chain, from the slip chain's state of rest."""
    if drive.time_s is None:
        raise ValueError("the dynamic model needs the times of its samples")
    if rig.effects.antagonist.preload_N != 0.0:
        raise ValueError("the dynamic model has no antagonist")
    ends = ends_of(rig, drive)
    before = history(rig, ends, drive, lumps)
    start = rest_after(ends.first().after(before).course, rig, ends.boundary, lumps)
    neutral = Effects()
    without_speed = rig.effects._replace(
        stribeck_friction=neutral.stribeck_friction, viscous_friction=neutral.viscous_friction
    )  # each lump has its own speed
    course = ends_of(rig._replace(effects=without_speed), drive).course
    output, progress = lugre_chain(course, start, rig, ends.boundary, lumps, control)
    solver = f"LuGre chain, {lumps} lumps, {progress.step_ends_s.size} steps"
    return SolvedRun(at_drive_sensor(rig, ends, output), solver, progress.step_ends_s)


def solver_of(nodes: int) -> str:
    """Return the description of a quasi-static solver."""
    named = {STATIC: "lumped dead bands", CLOSED: "closed form"}
    return named.get(nodes, f"slip chain, {nodes} nodes")


def is_closed(rig: Rig, drive: DriveInput) -> bool:
    """Return whether the closed form is valid: displacement drive, spring, constant friction."""
    return (
        drive.kind == "displacement"
        and drive.load == "spring"
        and rig.bend_slope == rig.bend_bow == 0.0
        and _effects_on_chain(rig.effects) == _NEUTRAL_ON_CHAIN
    )


def readings_of(rig: Rig, drive: DriveInput, signals: Output, solver: str) -> Prediction:
    """Return the readings of signals that passed the memory of the sensors."""
    return Prediction(
        drive.values if drive.kind == "displacement" else signals.x_in + rig.x_in_zero_mm,
        reading("x_out_mm", signals.x_out, drive.time_s, drive.session_s, rig),
        reading("f_in_N", signals.f_in, drive.time_s, drive.session_s, rig),
        reading("f_out_N", signals.f_out, drive.time_s, drive.session_s, rig),
        signals.phase,
        solver,
    )


def _solve(rig: Rig, ends: EndInputs, nodes: int, frames: Frames | None = None) -> Output:
    return advanced(rig, ends, nodes, at_rest(rig, ends, nodes), frames)[0]


def at_rest(rig: Rig, ends: EndInputs, nodes: int) -> State:
    """Return the state of a quasi-static solver at rest at the preload, before a motion."""
    if nodes == STATIC:
        return StaticState(0.0, rig.preload_N, rig.preload_N)
    if nodes == CLOSED:
        return branches_at_rest(rig.preload_N)
    return initial_state(ends.course, rig, ends.boundary, nodes)


def advanced(
    rig: Rig, ends: EndInputs, nodes: int, state: State, frames: Frames | None = None
) -> tuple[Output, State]:
    """Return the output of a quasi-static solver for a motion from a state, and the final state.

    That of a chain is updated in place; `frames` are written by the slip chain alone.
    """
    if isinstance(state, BranchState):
        state = with_room(state, ends.drive)
        tensions = follow_branches(ends.drive, rig, state)
    elif isinstance(state, StaticState):
        tensions, state = follow_static(ends.drive, rig, state)
    else:
        output, state = follow(ends.course, state, rig, ends.boundary, nodes, frames)
        return at_drive_sensor(rig, ends, output), state
    x_out = (tensions.f_out - rig.preload_N) / rig.load_stiffness_N_per_mm
    output = Output(ends.drive, x_out, tensions.f_in, tensions.f_out, tensions.phase)
    return at_drive_sensor(rig, ends, output), state


def at_drive_sensor(rig: Rig, ends: EndInputs, output: Output) -> Output:
    """Return an output with the force beside the tendon added to f_in, unless f_in is given."""
    if ends.boundary.drive == FORCE:
        return output
    direction, of_motion = ends.course[DIRECTION], ends.course[MOTION]
    beside = force_at_drive(ends.drive, direction, of_motion, rig.effects)
    return output._replace(f_in=output.f_in + beside)


def first_determined_sample(rig: Rig, drive: DriveInput) -> int | None:
    """Return the first sample whose prediction is independent of the history before the run.

    None where there is none. The history is forgotten once the tendon slips as a whole in the same
    direction (or is slack), whether the drive came from far above or from far below.
    """
    ends, nodes = ends_of(rig, drive), CLOSED if is_closed(rig, drive) else NODES
    far = [_far(rig, ends, side, nodes) for side in (1.0, -1.0)]
    phases = [_solve(rig, ends.after([x]), nodes).phase[1:] for x in far]
    same = np.flatnonzero((phases[0] == phases[1]) & np.isin(phases[0], (1, -1, SLACK)))
    return int(same[0]) if same.size else None


def _far(rig: Rig, ends: EndInputs, side: float, nodes: int) -> float:
    """Return a drive position from which the return to the first sample ends in full slip."""
    first = float(ends.drive[0])
    stretch = rig.preload_N * rig.sheath_length_mm / rig.tendon_stiffness_N
    step = 1e-3
    for _ in range(MOST_DOUBLINGS):
        by_force = ends.boundary.drive == FORCE
        past = first * (1.0 + step) ** side if by_force else first + side * step * stretch
        if _solve(rig, ends.first().after([past]), nodes).phase[-1] in (1, -1, SLACK):
            break
        step *= 2.0
    return past


def history(rig: Rig, ends: EndInputs, drive: DriveInput, nodes: int) -> list[float]:
    """Return the drive position before the first sample for which f_in fits there, if measured.

    From rest the drive moves beyond its first position and back; the distance determines the
    tension there, between those of contraction and loosening. It is found by bisection.
    """
    target_f_in_N = drive.start_f_in_N
    if target_f_in_N is None or ends.boundary.drive == FORCE or nodes == STATIC:
        return []

    def f_in(before: list[float]) -> float:
        last = samples_of(_solve(rig, first.after(before), nodes), slice(-1, None))
        signals = sensed(last, None, rig, ends.boundary, new_memory())
        return float(reading("f_in_N", signals.f_in, None, drive.session_s, rig)[0])

    x = float(ends.drive[0])
    first = ends.first()
    side = math.copysign(1.0, f_in([]) - target_f_in_N)  # pulling beyond and back lowers f_in
    near, far = x, _far(rig, ends, side, nodes)
    for _ in range(40):
        middle = 0.5 * (near + far)
        if (f_in([middle]) - target_f_in_N) * side > 0.0:
            near = middle
        else:
            far = middle
    return [far]
