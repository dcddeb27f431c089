"""The distributed quasi-static model in closed form: spring load, friction that stays the same.

A reversal starts a slip front at the drive; behind it the tension is T0 e^(±a s/L), ahead of it
the old profile stands. From a turning point with tension A at the drive the travel D is

    D = c |T0 − A| + C (√T0 − √A)²,    C = L/(a EA),

with c the compliance of free tendon at the drive: a quadratic in √(T0/A). Nested reversals are a
stack of turning points with return-point memory; when the front reaches the load the tendon
slips as a whole (Yang 2025, Eqs. 7-9) and the stack is forgotten. No mesh, no iteration, except on
the first loading from rest, where T0 solves D = c (T0−F0) + C (T0 − F0 − F0 ln(T0/F0)).
"""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.closed_form.capstan import mean_tension_ratio, tension_ratio
from tsas_cli.physics.compliances import (
    compliance_at_drive,
    compliance_at_load,
    sheath_compliance,
)
from tsas_cli.physics.frames import Frames, is_next
from tsas_cli.physics.phases import SLACK
from tsas_cli.physics.rig import Rig

Floats = npt.NDArray[np.float64]
Phases = npt.NDArray[np.int8]

REST, SLIP = 0, 1  # what lies under the stack of turning points
SMALLEST_WRAP = 1e-9  # a straight sheath: C stays finite, and the dead band has no width


@kernel
def from_turning_point(travel: float, tension: float, direction: int, C: float, c: float) -> float:
    """Return T0 after a travel D ≥ 0 from a turning point with tension A [N]."""
    D = travel / tension
    if direction > 0:
        root = (C + math.sqrt(c * c + (C + c) * D)) / (C + c)
    else:
        inside = c * c + (C - c) * D
        root = (C + c - D) / (C + math.sqrt(inside)) if inside > 0.0 and C + c > D else 0.0
    return tension * root * root


@kernel
def from_rest(travel: float, preload: float, C: float, c: float, highest: float) -> float:
    """Return T0 after a signed travel from uniform tension F0, by Newton's method on ln(T0/F0).

    Beyond `highest` = a the front has reached the load; the root is not sought there.
    """
    target = travel / preload
    y = math.copysign(min(highest, math.sqrt(2.0 * abs(target) / C)), target)
    for _ in range(60):
        grown = math.expm1(y)
        value = c * grown + math.copysign(C * (grown - y), y) - target
        slope = c * (grown + 1.0) + C * abs(grown)
        if slope == 0.0:
            return preload
        step = value / slope
        y = min(max(y - step, -highest - 1.0), highest + 1.0)
        if abs(step) < 1e-14:
            break
    return preload * math.exp(y)


@kernel
def full_slip(direction: float, rig: Rig, wrap: float, c: float) -> tuple[float, float]:
    """Return slope k and zero x* of T0 = k (x − x*) while the whole tendon slips, Eqs. (7)-(9).

    Below x*, where no tension is left, it hangs slack.
    """
    spring = 1.0 / rig.load_stiffness_N_per_mm + compliance_at_load(rig)
    sheath = sheath_compliance(rig)
    compliance = (
        tension_ratio(wrap, direction) * spring + mean_tension_ratio(wrap, direction) * sheath + c
    )
    return 1.0 / compliance, -rig.preload_N * (spring + sheath + c)


@kernel
def strokes(x_in: Floats) -> int:
    """Return how many strokes a motion may have: changes of direction, and of standing still.

    No more reversals can nest. Without a branch, it costs a tenth of the motion itself.
    """
    count = 2  # the way from rest at x = 0 to the first sample, and the first stroke
    for i in range(2, x_in.size):
        before, after = x_in[i - 1] - x_in[i - 2], x_in[i] - x_in[i - 1]
        count += ((before > 0.0) != (after > 0.0)) | ((before < 0.0) != (after < 0.0))
    return count


def branches(x_in: Floats, rig: Rig, frames: Frames | None = None) -> tuple[Floats, Floats, Phases]:
    """Follow a motion of the drive that starts at rest at x = 0 [mm].

    Parameters
    ----------
    x_in
        Displacement of the drive from the state of uniform preload, shape (n,) [mm].
    rig
        The rig; its zeros are not looked at.
    frames
        Where to write down what is along the tendon, on any number of elements.

    Returns
    -------
    f_in, f_out, phase
        Tensions at both ends, shape (n,) [N]; +1 where the whole tendon slips in contraction, −1
        in loosening, 0 in a dead band, 2 where it hangs slack.
    """
    return follow_branches(x_in, rig, at_rest_before(x_in, rig.preload_N), frames)


class BranchState(NamedTuple):
    """What the closed form remembers from one sample to the next; written over as it goes on.

    `now` holds the drive's place [mm], both tensions [N], the direction, how many turning points
    are on the stack, what lies under it, and the phase.
    """

    now: Floats  # (7,)
    turn_x: Floats  # turning points, room for all that may nest
    turn_T: Floats


@kernel
def at_rest_before(x_in: Floats, preload: float) -> BranchState:
    """Return the state of uniform preload, with room for the turning points of a motion."""
    now = np.array([0.0, preload, preload, 0.0, 0.0, float(REST), 0.0])
    room = strokes(x_in)  # growing it in the loop would cost 20 ns a sample
    return BranchState(now, np.empty(room), np.empty(room))


def with_room(state: BranchState, x_in: Floats) -> BranchState:
    """Return a copy of a state that has room for the turning points of more motion."""
    more = np.empty(strokes(x_in))
    depth = int(state.now[4])
    turns = (np.concatenate((turn[:depth], more)) for turn in (state.turn_x, state.turn_T))
    return BranchState(state.now.copy(), *turns)


@kernel
def follow_branches(
    x_in: Floats, rig: Rig, state: BranchState, frames: Frames | None = None
) -> tuple[Floats, Floats, Phases]:
    """Follow a motion from a state, which is written over; see `branches`."""
    wrap = max(rig.friction_coefficient * rig.total_bend_rad, SMALLEST_WRAP)
    C = sheath_compliance(rig) / wrap
    c = compliance_at_drive(rig)
    swing = math.exp(2.0 * wrap)
    rest_high, rest_low = rig.preload_N * math.exp(wrap), rig.preload_N * math.exp(-wrap)
    pulled, slack = full_slip(1.0, rig, wrap, c)
    released, slack = full_slip(-1.0, rig, wrap, c)
    out_pulled, out_released = tension_ratio(wrap, 1.0), tension_ratio(wrap, -1.0)
    n = x_in.size
    f_in = np.empty(n)
    f_out = np.empty(n)
    phase = np.zeros(n, dtype=np.int8)
    turn_x, turn_T = state.turn_x, state.turn_T
    x, T, out = state.now[0], state.now[1], state.now[2]
    direction, depth, base = int(state.now[3]), int(state.now[4]), int(state.now[5])
    before = int(state.now[6])
    taken = 0
    for i in range(n):
        if x_in[i] != x:
            now = 1 if x_in[i] > x else -1
            if now != direction and direction != 0 and T > 0.0:
                turn_x[depth], turn_T[depth] = x, T
                depth += 1
            direction, x = now, x_in[i]
            # Climb down the stack: each branch holds until it meets the turn that encloses it.
            while depth > 0:
                A = turn_T[depth - 1]
                T = from_turning_point(abs(x - turn_x[depth - 1]), A, direction, C, c)
                if depth > 1:
                    end = turn_T[depth - 2]
                elif base == REST:
                    end = rig.preload_N * rig.preload_N / A
                else:
                    end = A * swing if direction > 0 else A / swing
                if (T - end) * direction <= 0.0:
                    break
                depth = max(depth - 2, 0)
            if depth == 0 and base == REST:
                T = from_rest(x, rig.preload_N, C, c, wrap)
                if not rest_low < T < rest_high:
                    base = SLIP
            if depth == 0 and base == SLIP:
                T = max((pulled if direction > 0 else released) * (x - slack), 0.0)
                out = T * (out_pulled if direction > 0 else out_released)
                phase[i] = direction if T > 0.0 else SLACK
        elif before == SLACK:
            phase[i] = SLACK
        before = phase[i]
        f_in[i] = T
        f_out[i] = out
        if frames is not None and is_next(frames, taken, i):  # compiled away where there are none
            write_profile(frames, taken, T, direction, turn_T[:depth], base, rig.preload_N, wrap)
            taken += 1
    state.now[:] = np.array([x, T, out, direction, depth, base, before])
    return f_in, f_out, phase


@kernel
def write_profile(
    frames: Frames,
    k: int,
    T0: float,
    direction: int,
    turns: Floats,
    base: int,
    preload: float,
    wrap: float,
) -> None:
    """Write down the profile that the strokes have left, the last one up to its front.

    Each stroke lays T0 e^(∓a s/L) over what the ones before have left, as far as that is above
    (contraction) or below (loosening); a stroke that has slid the whole tendon leaves nothing of
    what was before.
    """
    m = frames.slip.shape[1]
    depth = turns.size
    for half in range(2 * m + 1):  # places at the even ones, the middles of elements between
        s = 0.5 * half / m
        tension, laid = preload, False
        for stroke in range(depth + 1):
            way = direction if (depth - stroke) % 2 == 0 else -direction
            at_drive = turns[stroke] if stroke < depth else T0
            new = at_drive * math.exp(-way * wrap * s)
            laid = (base == SLIP and stroke == 0) or (new - tension) * way > 0.0
            tension = new if laid else tension
        if half % 2 == 0:
            frames.tension_N[k, half // 2] = tension
        elif T0 == 0.0:
            frames.slip[k, half // 2] = SLACK
        else:
            frames.slip[k, half // 2] = direction if laid else 0
    if T0 == 0.0 or direction == 0:
        frames.front[k] = 0.0
    elif depth > 0:
        frames.front[k] = min(abs(math.log(T0 / turns[depth - 1])) / (2.0 * wrap), 1.0)
    else:
        frames.front[k] = 1.0 if base == SLIP else min(abs(math.log(T0 / preload)) / wrap, 1.0)
