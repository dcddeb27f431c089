"""The slip chain: the distributed quasi-static model for any load and every effect.

The tendon is n nodes in a row, each with its share a/n of the wrap angle times friction, joined
by springs; half springs at both ends make the mesh second order in 1/n (first order close to a
reversal, where the exact slope is infinite). A node sticks while the tensions on its two sides
keep within the capstan ratio e^(±a/n), exactly Eq. (7) of Yang 2025 for its bend; it slips in the
direction that the larger one pulls. Each sample is one static problem (`step`), started from
the last sample's set of slipping nodes.
"""

import math
from typing import NamedTuple

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import DISPLACEMENT, FORCE, Boundary, unloaded_position
from tsas_cli.physics.frames import Frames
from tsas_cli.physics.phases import SLACK, UNCONVERGED, Phases
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.slip.ends import load_force, moving_friction, update_load_speed
from tsas_cli.physics.slip.frames import write_frame
from tsas_cli.physics.slip.nodes import accept
from tsas_cli.physics.slip.start import chain_at_rest, slip_laws
from tsas_cli.physics.slip.state import (
    COMPLIANCE,
    LOAD_SPEED,
    POSITION,
    POSITION_BEFORE,
    SHARE_BEFORE,
    SLIP,
    TENSION,
    TENSION_BEFORE,
    TENSION_RISE,
    TRAVEL,
    Floats,
    Moment,
    SlipLaws,
)
from tsas_cli.physics.slip.step import solve_sample

MOST_UNCONVERGED = 10  # samples, after which a run is given up
MOST_STEPS = 60  # between two samples, those included that did not settle
SHORTEST_STEP = 1e-3  # of the way between two samples; where that does not settle, nothing does


def slip_chain(
    course: Floats, rig: Rig, boundary: Boundary, n: int, frames: Frames | None = None
) -> tuple[Floats, Floats, Floats, Floats, Phases]:
    """Follow the motion of both ends, starting from rest at the preload.

    Parameters
    ----------
    course
        The fields of `Moment` at each sample, shape (7, m).
    rig
        The rig; its friction and bend are taken from the course.
    boundary
        What is given at the ends.
    n
        Number of nodes.
    frames
        Where to write down what is along the tendon, n elements with a node in each.

    Returns
    -------
    x_in, x_out, f_in, f_out, phase
        Shape (m,) [mm, mm, N, N]: the drive's end of the tendon, the load, the tension behind the
        drive's friction (as given, where that is given) and at the load's sensor; the phase is
        +1 where the whole tendon slips in contraction, −1 in loosening, 0 where a part of it
        sticks, 2 where it hangs slack, 3 where the set of slipping nodes was not found and the
        sample is not to be trusted. Many such samples, and the rest of the run is given up: it
        keeps the last values.
    """
    return follow(course, initial_state(course, rig, boundary, n), rig, boundary, n, frames)


@kernel
def rest_after(course: Floats, rig: Rig, boundary: Boundary, n: int) -> Floats:
    """Return where a course leaves the nodes and the tensions behind them, shape (2, n + 2)."""
    state = initial_state(course, rig, boundary, n)
    follow(course, state, rig, boundary, n)
    chain = state.chain
    out = np.empty((2, n + 2))
    for j in range(n + 2):
        out[0, j], out[1, j] = chain[POSITION + j], chain[TENSION + j]
    return out


class ChainState(NamedTuple):
    """Where a course has left a chain; written over as it goes on."""

    chain: Floats
    before: Floats  # the fields of the last `Moment`, (7,)
    last: Floats  # x_in, x_out, f_in, f_out of the last sample, and how many did not settle, (5,)


@kernel
def initial_state(course: Floats, rig: Rig, boundary: Boundary, n: int) -> ChainState:
    """Return the state of rest at the preload, before a course."""
    drive = rig.preload_N if boundary.drive == FORCE else 0.0
    load = rig.preload_N if boundary.load == FORCE else 0.0
    before = np.array([drive, load, course[2, 0], course[3, 0], 0.0, 0.0, math.inf])
    return ChainState(chain_at_rest(rig, n), before, np.zeros(5))


@kernel
def follow(
    course: Floats,
    state: ChainState,
    rig: Rig,
    boundary: Boundary,
    n: int,
    frames: Frames | None = None,
) -> tuple[Floats, Floats, Floats, Floats, Phases]:
    """Let a chain follow a course from a state, which is written over; see `slip_chain`."""
    m = course.shape[1]
    chain, b, last = state.chain, state.before, state.last
    x_in, x_out, f_in, f_out = np.empty(m), np.empty(m), np.empty(m), np.empty(m)
    phase = np.zeros(m, dtype=np.int8)
    laws = slip_laws(rig, n)
    scale = rig.sheath_length_mm * rig.preload_N / rig.tendon_stiffness_N / n + 1e-9
    before = Moment(b[0], b[1], b[2], b[3], b[4], b[5], b[6])
    unsettled, taken = int(last[4]), 0
    for i in range(m):
        if unsettled > MOST_UNCONVERGED:
            x_in[i], x_out[i], f_in[i], f_out[i] = last[0], last[1], last[2], last[3]
            phase[i] = UNCONVERGED
            if frames is not None:
                taken = write_frame(frames, taken, i, chain, n, UNCONVERGED)
            continue
        now = moment(course, i)
        if boundary.load == DISPLACEMENT and now.load != before.load:
            chain[SLIP + n + 1] = 1 if now.load > before.load else -1
        found = advance(chain, before, now, boundary, laws, scale)
        before = now
        unsettled += not found
        phase[i] = phase_of(chain, n) if found else UNCONVERGED
        if boundary.load != FORCE and chain[TENSION] < 0.0:
            phase[i] = SLACK
            go_slack(chain, now, boundary, laws)
        x_in[i], x_out[i] = chain[POSITION], chain[POSITION + n + 1]
        f_in[i] = now.drive if boundary.drive == FORCE else chain[TENSION]
        f_out[i] = tension_at_sensor(chain, now, boundary, laws)
        last[0], last[1], last[2], last[3] = x_in[i], x_out[i], f_in[i], f_out[i]
        if frames is not None:  # compiled away where none are asked for
            taken = write_frame(frames, taken, i, chain, n, phase[i])
    last[4] = unsettled
    b[0], b[1], b[2], b[3] = before.drive, before.load, before.pulled, before.released
    b[4], b[5], b[6] = before.viscous_N, before.lost_N, before.step_s
    return x_in, x_out, f_in, f_out, phase


@kernel
def moment(course: Floats, i: int) -> Moment:
    """Return one sample of the course."""
    return Moment(
        course[0, i],
        course[1, i],
        course[2, i],
        course[3, i],
        course[4, i],
        course[5, i],
        course[6, i],
    )


@kernel
def advance(
    chain: Floats, start: Moment, end: Moment, boundary: Boundary, laws: SlipLaws, scale: float
) -> bool:
    """Go from one sample to the next, in smaller steps where one is too large.

    The way between two samples is a straight line. Returns whether every step settled.
    """
    done, step = 0.0, 1.0
    for _ in range(MOST_STEPS):
        if step < SHORTEST_STEP:
            return False
        to = min(done + step, 1.0)
        now = between(start, end, to, end.step_s * (to - done))
        if solve_sample(chain, now, boundary, laws, scale):
            update_load_speed(chain, now.step_s, laws.n)
            accept(chain, laws)
            if to == 1.0:
                return True
            done = to
            step *= 2.0
        else:
            for j in range(laws.n + 2):
                chain[POSITION + j], chain[TENSION + j], chain[SLIP + j] = (
                    chain[POSITION_BEFORE + j],
                    chain[TENSION_BEFORE + j],
                    0.0,
                )
                chain[TRAVEL + j] = 0.0
            step *= 0.5
    return False


@kernel
def between(start: Moment, end: Moment, part: float, step_s: float) -> Moment:
    """Return the moment at a part of the way, after a step of its own; the last one exactly."""
    if part == 1.0:
        drive, load, pulled, released = end.drive, end.load, end.pulled, end.released
        return Moment(drive, load, pulled, released, end.viscous_N, end.lost_N, step_s)
    return Moment(
        start.drive + part * (end.drive - start.drive),
        start.load + part * (end.load - start.load),
        start.pulled + part * (end.pulled - start.pulled),
        start.released + part * (end.released - start.released),
        start.viscous_N + part * (end.viscous_N - start.viscous_N),
        start.lost_N + part * (end.lost_N - start.lost_N),
        step_s,
    )


@kernel
def phase_of(chain: Floats, n: int) -> int:
    """Return +1 or −1 where all nodes of the sheath slip alike, 0 otherwise."""
    first = chain[SLIP + 1]
    for i in range(2, n + 1):
        if chain[SLIP + i] != first:
            return 0
    return int(first)


@kernel
def tension_at_sensor(chain: Floats, now: Moment, boundary: Boundary, laws: SlipLaws) -> float:
    """Return what a force sensor at the load feels [N], friction before it taken off."""
    n = laws.n
    tension: float = chain[TENSION + n]
    if boundary.load == FORCE:
        return now.load
    before = laws.load_friction.before_sensor_N
    if before == 0.0:
        return tension
    if boundary.load == DISPLACEMENT:
        return float(tension - chain[SLIP + n + 1] * before)
    share = before / moving_friction(boundary, laws)
    return tension - share * (tension - load_force(chain, now, boundary, laws))


@kernel
def go_slack(chain: Floats, now: Moment, boundary: Boundary, laws: SlipLaws) -> None:
    """Lay the tendon without tension against the load; the next pull finds all nodes slipping."""
    last = laws.n + 1
    if boundary.load != DISPLACEMENT:
        preload_N, stiffness = laws.preload_N - now.lost_N, laws.load_stiffness_N_per_mm
        chain[POSITION + last] = unloaded_position(
            chain[POSITION + last], preload_N, stiffness, laws.load_spring
        )
    for j in range(last - 1, -1, -1):
        chain[TENSION + j] = 0.0
        if j > 0:
            chain[POSITION + j] = chain[POSITION + j + 1] - chain[COMPLIANCE + j] * laws.preload_N
            chain[SLIP + j] = 1.0
    chain[SLIP + last] = 1.0
    chain[LOAD_SPEED + last] = 0.0
    accept(chain, laws)
    for j in range(laws.n + 2):
        chain[SHARE_BEFORE + j], chain[TRAVEL + j], chain[TENSION_RISE + j] = 1.0, 0.0, 0.0
