"""The slip chain: the distributed quasi-static model for any load and every effect.

The tendon is n nodes in a row, each with its share a/n of the wrap angle times friction, joined
by springs; half springs at both ends make the mesh second order in 1/n (first order close to a
reversal, where the exact slope is infinite). A node sticks while the ratio of the tensions on its
two sides is within the capstan ratio e^(±a/n), exactly Eq. (7) of Yang 2025 for its bend; it slips
in the direction of the larger one. Each sample is one static problem (`step`), started from the
last sample's active set of slipping nodes.
"""

import math
from typing import NamedTuple

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import (
    DISPLACEMENT,
    FORCE,
    Boundary,
    unloaded_position,
)
from tsas_cli.physics.course import (
    DRIVE,
    LOAD,
    PULLED,
    RELEASED,
    STEP,
    Losses,
    Output,
    losses_between,
    losses_of,
)
from tsas_cli.physics.frames import Frames
from tsas_cli.physics.phases import SLACK, UNCONVERGED
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.slip import state as at
from tsas_cli.physics.slip.ends import (
    stop_ends,
    update_end_speeds,
    update_load_state,
)
from tsas_cli.physics.slip.nodes import accept, update_speeds
from tsas_cli.physics.slip.outputs import phase_of, tension_at_drive, tension_at_sensor, write_frame
from tsas_cli.physics.slip.pair import accept_pair, solve_pair
from tsas_cli.physics.slip.state import Moment, SlipLaws, chain_at_rest, slip_laws
from tsas_cli.physics.slip.step import solve_sample
from tsas_cli.support.arrays import Floats

MOST_UNCONVERGED = 10  # samples, after which a run is aborted
MOST_STEPS = 60  # between two samples, unconverged ones included
SHORTEST_STEP = 1e-3  # of the interval between two samples; shorter steps do not converge either


def rest_after(course: Floats, rig: Rig, boundary: Boundary, n: int) -> Floats:
    """Return positions of the nodes and tensions behind them after a course, shape (2, n + 2)."""
    start = initial_state(course, rig, boundary, n)
    chain = follow(course, start, rig, boundary, n, None)[1].chain
    return np.stack([chain[row : row + n + 2] for row in (at.POSITION, at.TENSION)])


class ChainEnds(NamedTuple):
    """Positions and tensions at both ends at one sample [mm, N]."""

    x_in: float
    x_out: float
    f_in: float
    f_out: float


class ChainState(NamedTuple):
    """State of a chain after a course; `chain` is updated in place."""

    chain: Floats
    before: Moment  # the last one
    ends: ChainEnds  # at that moment
    unconverged: int  # samples so far


@kernel
def initial_state(course: Floats, rig: Rig, boundary: Boundary, n: int) -> ChainState:
    """Return the state of rest at the preload, before a course."""
    drive = rig.preload_N if boundary.drive == FORCE else 0.0
    load = rig.preload_N if boundary.load == FORCE else 0.0
    losses = Losses(course[PULLED, 0], course[RELEASED, 0], 0.0, 0.0)
    before = Moment(drive, load, losses, math.inf)
    return ChainState(chain_at_rest(rig, n), before, ChainEnds(0.0, 0.0, 0.0, 0.0), 0)


@kernel
def follow(
    course: Floats,
    state: ChainState,
    rig: Rig,
    boundary: Boundary,
    n: int,
    frames: Frames | None,  # a default would be compiled apart from None
) -> tuple[Output, ChainState]:
    """Return the output of a chain for the motion of both ends from a state, and the final state.

    Parameters
    ----------
    course
        Inputs of the tendon, with the rows of `course`, shape (11, m).
    state
        That of `initial_state`, or the final one of the course before.
    rig
        The rig; its friction and bend are those of the course.
    boundary
        The given quantity at each end.
    n
        Number of nodes.
    frames
        Written over with the profile along the tendon, n elements with a node in each.

    Returns
    -------
        Positions and tensions at both ends: the tension at the drive is that behind the drive's
        friction (or the given one), the one at the load is its sensor's. A sample of phase 3 is not
        converged; after many such samples the run is aborted: the rest has the last values.
    """
    m = course.shape[1]
    x_in, x_out, f_in, f_out = np.empty(m), np.empty(m), np.empty(m), np.empty(m)
    phases = np.zeros(m, dtype=np.int8)
    laws = slip_laws(rig, n, boundary)
    chain, before, ends, unconverged = state
    written = 0
    for i in range(m):
        phase = UNCONVERGED
        if unconverged <= MOST_UNCONVERGED:
            now = moment(course, i)
            phase, ends = follow_sample(chain, before, now, laws)
            before = now
            unconverged += phase == UNCONVERGED
        x_in[i], x_out[i], f_in[i], f_out[i] = ends
        phases[i] = phase
        if frames is not None:  # compiled away without frames
            written = write_frame(frames, written, i, chain, n, phase)
    output = Output(x_in, x_out, f_in, f_out, phases)
    return output, ChainState(chain, before, ends, unconverged)


@kernel
def follow_sample(
    chain: Floats, before: Moment, now: Moment, laws: SlipLaws
) -> tuple[int, ChainEnds]:
    """Advance to one sample; return the phase and the ends there."""
    last = laws.n + 1
    if laws.load.given == DISPLACEMENT and now.load != before.load:
        chain[at.SLIP + last] = 1 if now.load > before.load else -1
    converged = advance(chain, before, now, laws)
    phase = phase_of(chain, laws) if converged else UNCONVERGED
    f_in = tension_at_drive(chain, laws)
    if laws.antagonist.preload_N == 0.0 and laws.load.given != FORCE and chain[at.TENSION] < 0.0:
        phase, f_in = SLACK, 0.0
        if pulls_at_neither_end(chain, now, laws):
            go_slack(chain, now, laws)
    if laws.drive.given == FORCE:
        f_in = now.drive
    f_out = tension_at_sensor(chain, now, laws)
    return phase, ChainEnds(chain[at.POSITION], chain[at.POSITION + last], f_in, f_out)


@kernel
def moment(course: Floats, i: int) -> Moment:
    """Return one sample of the course."""
    return Moment(course[DRIVE, i], course[LOAD, i], losses_of(course, i), course[STEP, i])


@kernel
def advance(chain: Floats, start: Moment, end: Moment, laws: SlipLaws) -> bool:
    """Advance from one sample to the next, in smaller steps where one does not converge.

    Inputs are linear between samples. Returns whether every step converged.
    """
    reached, step = 0.0, 1.0
    for _ in range(MOST_STEPS):
        if step < SHORTEST_STEP:
            return False
        target = min(reached + step, 1.0)
        now = between(start, end, target, end.step_s * (target - reached))
        paired = laws.antagonist.preload_N > 0.0
        if solve_pair(chain, now, laws) if paired else solve_sample(chain, now, laws):
            update_end_speeds(chain, now.step_s, laws.n)
            update_speeds(chain, now.step_s, laws)
            update_load_state(chain, now.step_s, laws)
            if paired:
                accept_pair(chain, now, laws)
            else:
                accept(chain, laws)
            if target == 1.0:
                return True
            reached = target
            step *= 2.0
        else:
            go_back(chain, laws.n)
            if paired:
                go_back(chain[at.SECOND :], laws.n)
            step *= 0.5
    return False


@kernel
def go_back(tendon: Floats, n: int) -> None:
    """Set a tendon back to the end of the last step, with no node slipping."""
    for j in range(n + 2):
        tendon[at.POSITION + j], tendon[at.TENSION + j], tendon[at.SLIP + j] = (
            tendon[at.POSITION_BEFORE + j],
            tendon[at.TENSION_BEFORE + j],
            0.0,
        )
        tendon[at.TRAVEL + j] = 0.0


@kernel
def between(start: Moment, end: Moment, part: float, step_s: float) -> Moment:
    """Return the moment interpolated linearly, with its own step; the last one exactly."""
    if part == 1.0:
        return Moment(end.drive, end.load, end.losses, step_s)
    return Moment(
        start.drive + part * (end.drive - start.drive),
        start.load + part * (end.load - start.load),
        losses_between(start.losses, end.losses, part),
        step_s,
    )


@kernel
def pulls_at_neither_end(chain: Floats, now: Moment, laws: SlipLaws) -> bool:
    """Return whether a tendon without tension at the drive has none at the load either.

    Drag in the sheath still holds the load where the drive has let go: then the tendon is taken to
    follow the drive, pressed by no more than the drag.
    """
    held = now.losses.drag_N > 0.0 and chain[at.TENSION + laws.n] > 0.0
    return chain[at.TENSION] < 0.0 and not held


@kernel
def go_slack(chain: Floats, now: Moment, laws: SlipLaws) -> None:
    """Set the tendon taut without tension at the load; all nodes slip on the next pull."""
    last = laws.n + 1
    if laws.load.given != DISPLACEMENT:
        preload_N = laws.preload_N - now.losses.preload_N - laws.load.hysteresis.force_N
        chain[at.ELEMENT] = -laws.load.hysteresis.force_N  # the load has returned far enough
        chain[at.POSITION + last] = unloaded_position(
            chain[at.POSITION + last], preload_N, laws.load
        )
    for j in range(last - 1, -1, -1):
        chain[at.TENSION + j] = 0.0
        if j > 0:
            chain[at.POSITION + j] = (
                chain[at.POSITION + j + 1] - chain[at.COMPLIANCE + j] * laws.preload_N
            )
            chain[at.SLIP + j] = 1.0
    chain[at.SLIP + last] = 1.0
    stop_ends(chain, laws.n)
    chain[at.STRETCH] = 0.0
    accept(chain, laws)
    for j in range(laws.n + 2):
        chain[at.SHARE_BEFORE + j], chain[at.TRAVEL + j], chain[at.TENSION_RISE + j] = 1.0, 0.0, 0.0
