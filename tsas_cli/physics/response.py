"""Simulate one run: which solver, how it starts, what the sensors would read."""

import math
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
import numpy.typing as npt

from tsas_cli.effects import EFFECTS, Effects
from tsas_cli.effects.drive_friction import drive_friction_force
from tsas_cli.effects.proximal_spring import proximal_spring_force
from tsas_cli.physics.boundary import FORCE
from tsas_cli.physics.closed_form.branches import branches
from tsas_cli.physics.closed_form.static import static_model
from tsas_cli.physics.course import Output, Tensions
from tsas_cli.physics.ends import Drive, EndInputs, ends_of
from tsas_cli.physics.frames import Frames, Indices, empty_frames
from tsas_cli.physics.lugre.chain import OWN_STEPS, StepControl, lugre_chain
from tsas_cli.physics.mesh import MOST_NODES
from tsas_cli.physics.phases import SLACK
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.sensors import reading
from tsas_cli.physics.slip.chain import rest_after, slip_chain

Floats = npt.NDArray[np.float64]
Phases = npt.NDArray[np.int8]
Dynamics = Literal["static", "slip", "lugre"]

NODES = 60  # of the slip chain, where the closed form does not hold
LUMPS = 50  # of the dynamic chain
TOLERANCE = 2.5e-6  # of a tension: what a step of the dynamic chain may add to its error
CLOSED = 0  # nodes of the closed form
ELEMENTS = 60  # on which the closed form says what is along the tendon
MOST_DOUBLINGS = 30  # of the way that the drive goes before a run
ON_CHAIN = tuple(effect.name for effect in EFFECTS if not effect.closed_form)


@dataclass(frozen=True)
class Response:
    """What the model predicts, as the sensors would read it, shape (n,) [mm, N].

    `phase` is +1 in contraction and −1 in loosening with the whole tendon slipping, 0 in a dead
    band, 2 slack, 3 not converged. `solver` says what computed it; `step_ends_s` is where the steps
    of the dynamic chain ended, none with any other solver. `frames` is what is along the tendon
    at the samples that were asked for, free of the sensors' errors; None where none were, and with
    the lumped model, which does not say it.
    """

    x_in_mm: Floats
    x_out_mm: Floats
    f_in_N: Floats
    f_out_N: Floats
    phase: Phases
    solver: str
    step_ends_s: Floats = field(default_factory=OWN_STEPS.copy)
    frames: Frames | None = None


def simulate(
    rig: Rig,
    drive: Drive,
    dynamics: Dynamics = "slip",
    *,
    on_mesh: bool = False,
    nodes: int | None = None,
    tolerance: float = TOLERANCE,
    step_ends_s: Floats = OWN_STEPS,
    looked_at: Indices | None = None,
) -> Response:
    """Follow a run with the distributed model (`slip`), the paper's lumped or its dynamic one.

    The distributed model takes the closed form where that holds (`is_closed`), and the slip chain
    everywhere else, or where `on_mesh` asks for it: models that are compared must share a mesh.
    The lumped one (`static`) knows what the closed form knows; the dynamic one (`lugre`) needs the
    times of the samples. `nodes` is the mesh of a chain; `tolerance` is what a step of the dynamic
    one may add to a tension's error, over the larger one at the ends; `step_ends_s` has it take the
    steps of another run. `looked_at` are samples, rising, shape (k,), at which the answer says what
    is along the tendon.
    """
    if nodes is not None and not 2 <= nodes <= MOST_NODES:
        raise ValueError(f"{nodes} nodes; expected 2 to {MOST_NODES}")
    if dynamics == "lugre":
        return _dynamic(rig, drive, nodes or LUMPS, StepControl(tolerance, step_ends_s), looked_at)
    nodes = nodes or NODES
    ends = ends_of(rig, drive)
    if dynamics == "static":
        output = with_spring_load(rig, ends, static_model(ends.drive, rig))
        return sensor_readings(rig, drive, output, 0, solver_of(nodes, dynamics))
    if is_closed(rig, drive) and not on_mesh:
        nodes = CLOSED
    before = history(rig, ends, drive.start_f_in_N, nodes)
    skip, frames = len(before), None
    if looked_at is not None:
        frames = empty_frames(looked_at + skip, nodes or ELEMENTS)
    output = _solve(rig, ends.after(before), nodes, frames)
    response = sensor_readings(rig, drive, output, skip, solver_of(nodes, dynamics))
    return replace(response, frames=frames and frames._replace(samples=frames.samples - skip))


def _dynamic(
    rig: Rig,
    drive: Drive,
    lumps: int,
    control: StepControl,
    looked_at: Indices | None,
) -> Response:
    """Follow a run with the dynamic chain, from a state of rest that the slip chain gives it."""
    if drive.time_s is None:
        raise ValueError("the dynamic model needs the times of its samples")
    ends = ends_of(rig, drive)
    before = history(rig, ends, drive.start_f_in_N, lumps)
    start = rest_after(ends.first().after(before).course, rig, ends.boundary, lumps)
    neutral = Effects()
    by_place = rig.effects._replace(
        stribeck_friction=neutral.stribeck_friction, viscous_friction=neutral.viscous_friction
    )  # each lump has its own speed
    course = ends_of(rig._replace(effects=by_place), drive).course
    frames = None if looked_at is None else empty_frames(looked_at, lumps)
    output, progress = lugre_chain(course, start, rig, ends.boundary, lumps, control, frames)
    output = at_drive_sensor(rig, ends, output)
    solver = f"LuGre chain, {lumps} lumps, {progress.step_ends_s.size} steps"
    response = sensor_readings(rig, drive, output, 0, solver)
    return replace(response, step_ends_s=progress.step_ends_s, frames=frames)


def solver_of(nodes: int, dynamics: Dynamics) -> str:
    """Return what is said of how a run was followed, with the lumped or the distributed model."""
    if dynamics == "static":
        return "lumped dead bands"
    return "closed form" if nodes == CLOSED else f"slip chain, {nodes} nodes"


def is_closed(rig: Rig, drive: Drive) -> bool:
    """Say whether the closed form holds: drive by displacement, a spring, constant friction."""
    neutral = Effects()
    return (
        drive.kind == "displacement"
        and drive.load == "spring"
        and rig.bend_slope == rig.bend_bow == 0.0
        and all(getattr(rig.effects, name) == getattr(neutral, name) for name in ON_CHAIN)
    )


def sensor_readings(rig: Rig, drive: Drive, output: Output, skip: int, solver: str) -> Response:
    """Drop the samples before the run and return what the sensors read of the others."""
    x_in = output.x_in[skip:]
    return Response(
        drive.values if drive.kind == "displacement" else x_in + rig.x_in_zero_mm,
        reading("x_out_mm", output.x_out[skip:], drive.time_s, rig),
        reading("f_in_N", output.f_in[skip:], drive.time_s, rig),
        reading("f_out_N", output.f_out[skip:], drive.time_s, rig),
        output.phase[skip:],
        solver,
    )


def _solve(rig: Rig, ends: EndInputs, nodes: int, frames: Frames | None = None) -> Output:
    """Return the output of the closed form, or of the slip chain."""
    if nodes == CLOSED:
        return with_spring_load(rig, ends, branches(ends.drive, rig, frames))
    output = slip_chain(ends.course, rig, ends.boundary, nodes, frames)
    return at_drive_sensor(rig, ends, output)


def with_spring_load(rig: Rig, ends: EndInputs, tensions: Tensions) -> Output:
    """Return the output of a model that knows a spring load and a drive by displacement."""
    x_out = (tensions.f_out - rig.preload_N) / rig.load_stiffness_N_per_mm
    f_in = tensions.f_in + force_beside_tendon(rig, ends)
    return Output(ends.drive, x_out, f_in, tensions.f_out, tensions.phase)


def at_drive_sensor(rig: Rig, ends: EndInputs, output: Output) -> Output:
    """Return an output with the force beside the tendon in f_in, where the drive is not a force."""
    if ends.boundary.drive == FORCE:
        return output
    return output._replace(f_in=output.f_in + force_beside_tendon(rig, ends))


def force_beside_tendon(rig: Rig, ends: EndInputs) -> Floats | float:
    """Return what the drive's sensor feels beside the tendon [N]."""
    friction = rig.effects.drive_friction.friction_N
    stiffness = rig.effects.proximal_spring.stiffness_N_per_mm
    if friction == 0.0 and stiffness == 0.0:
        return 0.0
    rubbing = drive_friction_force(friction, 1.0) * ends.direction
    return rubbing + proximal_spring_force(1.0, stiffness) * ends.drive


def forgotten(rig: Rig, drive: Drive) -> int | None:
    """Return the first sample whose answer does not depend on what came before the run, or None.

    The tendon has forgotten that when it slips as a whole in the same direction (or hangs slack),
    whether the drive came from far above or from far below.
    """
    ends, nodes = ends_of(rig, drive), CLOSED if is_closed(rig, drive) else NODES
    far = [_far(rig, ends, side, nodes) for side in (1.0, -1.0)]
    phases = [_solve(rig, ends.after([x]), nodes).phase[1:] for x in far]
    same = np.flatnonzero((phases[0] == phases[1]) & np.isin(phases[0], (1, -1, SLACK)))
    return int(same[0]) if same.size else None


def _far(rig: Rig, ends: EndInputs, side: float, nodes: int) -> float:
    """Return a drive from which the way back to the first sample makes the whole tendon slip."""
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


def history(rig: Rig, ends: EndInputs, wanted_f_in: float | None, nodes: int) -> list[float]:
    """Return a drive position to pass before the first sample, if one is needed, so that f_in fits.

    From rest the drive goes past its first position and back; how far decides the tension there,
    between those of contraction and loosening. It is found by bisection.
    """
    if wanted_f_in is None or ends.boundary.drive == FORCE:
        return []

    def f_in(before: list[float]) -> float:
        last = _solve(rig, first.after(before), nodes).f_in[-1:]
        return float(reading("f_in_N", last, None, rig)[0])

    x = float(ends.drive[0])
    first = ends.first()
    side = math.copysign(1.0, f_in([]) - wanted_f_in)  # pulling past and back lowers the tension
    near, far = x, _far(rig, ends, side, nodes)
    for _ in range(40):
        middle = 0.5 * (near + far)
        if (f_in([middle]) - wanted_f_in) * side > 0.0:
            near = middle
        else:
            far = middle
    return [far]
