"""The distributed quasi-static model in closed form: spring load, constant friction.

A reversal starts a slip front at the drive; behind it the tension is T0 e^(±a s/L), ahead of it
the old profile persists. From a reversal with tension A at the drive the travel D is

    D = c |T0 − A| + C (√T0 − √A)²,    C = L/(a EA),

with c the compliance of free tendon at the drive: a quadratic in √(T0/A). Nested reversals are a
stack with return-point memory; when the front reaches the load the tendon slips as a whole (Yang
2025, Eqs. 7-9) and the stack is cleared. No mesh, no iteration, except on the first loading from
rest, where T0 solves D = c (T0−F0) + C (T0 − F0 − F0 ln(T0/F0)).
"""

import math
from typing import NamedTuple

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.closed_form.capstan import mean_tension_ratio, tension_ratio
from tsas_cli.physics.course import Tensions
from tsas_cli.physics.mesh import (
    compliance_at_drive,
    compliance_at_load,
    sheath_compliance,
)
from tsas_cli.physics.phases import SLACK
from tsas_cli.physics.rig import Rig
from tsas_cli.support.arrays import Floats

REST, SLIP = 0, 1  # base of the stack of reversals: uniform preload, full slip
SMALLEST_WRAP = 1e-9  # a straight sheath: C stays finite, and the dead band has no width


@kernel
def from_turning_point(travel: float, tension: float, direction: int, C: float, c: float) -> float:
    """Return T0 after a travel D ≥ 0 from a reversal with tension A [N]."""
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

    Beyond `highest` = a the front has reached the load; the iteration is bounded there.
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

    Below x* the tension is zero and the tendon slack.
    """
    spring = 1.0 / rig.load_stiffness_N_per_mm + compliance_at_load(rig)
    sheath = sheath_compliance(rig)
    compliance = (
        tension_ratio(wrap, direction) * spring + mean_tension_ratio(wrap, direction) * sheath + c
    )
    return 1.0 / compliance, -rig.preload_N * (spring + sheath + c)


@kernel
def strokes(x_in: Floats) -> int:
    """Return an upper bound of the strokes of a motion: changes between rise, fall and rest.

    No more reversals can nest. Branch-free, it costs a tenth of the simulation.
    """
    count = 2  # the travel from rest at x = 0 to the first sample, and the first stroke
    for i in range(2, x_in.size):
        before, after = x_in[i - 1] - x_in[i - 2], x_in[i] - x_in[i - 1]
        count += ((before > 0.0) != (after > 0.0)) | ((before < 0.0) != (after < 0.0))
    return count


# State at the last sample: position [mm] and both tensions [N], direction of the last motion,
# depth of the stack of reversals, its base, and the phase.
LAST_X, LAST_F_IN, LAST_F_OUT, DIRECTION, DEPTH, BASE, PHASE = range(7)


class BranchState(NamedTuple):
    """State of the closed form from one sample to the next, updated in place."""

    now: Floats  # at the last sample, as named above, (7,)
    reversal_x: Floats  # stack of reversals, with room for all that may nest
    reversal_T: Floats


@kernel
def branches_at_rest(preload: float) -> BranchState:
    """Return the state of uniform preload."""
    now = np.zeros(7)
    now[LAST_F_IN] = now[LAST_F_OUT] = preload
    now[BASE] = REST
    return BranchState(now, np.empty(0), np.empty(0))


def with_room(state: BranchState, x_in: Floats) -> BranchState:
    """Return a copy of a state with room for the reversals of a motion.

    Growing it in the loop of `follow_branches` would cost 20 ns a sample.
    """
    more, depth = np.empty(strokes(x_in)), int(state.now[DEPTH])
    reversal_x, reversal_T = (np.concatenate((row[:depth], more)) for row in state[1:])
    return BranchState(state.now.copy(), reversal_x, reversal_T)


@kernel
def follow_branches(x_in: Floats, rig: Rig, state: BranchState) -> Tensions:
    """Return the tensions for a motion from a state, which is updated in place.

    Parameters
    ----------
    x_in
        Displacement of the drive from the state of uniform preload, shape (n,) [mm].
    rig
        The rig; its sensor zeros are not used.
    state
        The state before the motion, `with_room` for it.
    """
    wrap = max(rig.friction_coefficient * rig.total_bend_rad, SMALLEST_WRAP)
    C = sheath_compliance(rig) / wrap
    c = compliance_at_drive(rig)
    ratio = math.exp(2.0 * wrap)
    rest_high, rest_low = rig.preload_N * math.exp(wrap), rig.preload_N * math.exp(-wrap)
    pull_slope, slack_x = full_slip(1.0, rig, wrap, c)
    release_slope, slack_x = full_slip(-1.0, rig, wrap, c)
    out_pulled, out_released = tension_ratio(wrap, 1.0), tension_ratio(wrap, -1.0)
    n = x_in.size
    f_in = np.empty(n)
    f_out = np.empty(n)
    phase = np.zeros(n, dtype=np.int8)
    last, reversal_x, reversal_T = state
    x, T, out = last[LAST_X], last[LAST_F_IN], last[LAST_F_OUT]
    direction, depth, base = int(last[DIRECTION]), int(last[DEPTH]), int(last[BASE])
    before = int(last[PHASE])
    for i in range(n):
        if x_in[i] != x:
            sign = 1 if x_in[i] > x else -1
            if sign != direction and direction != 0 and T > 0.0:
                reversal_x[depth], reversal_T[depth] = x, T
                depth += 1
            direction, x = sign, x_in[i]
            # Each branch is valid until it meets the enclosing reversal: pop both there.
            while depth > 0:
                A = reversal_T[depth - 1]
                T = from_turning_point(abs(x - reversal_x[depth - 1]), A, direction, C, c)
                if depth > 1:
                    end = reversal_T[depth - 2]
                elif base == REST:
                    end = rig.preload_N * rig.preload_N / A
                else:
                    end = A * ratio if direction > 0 else A / ratio
                if (T - end) * direction <= 0.0:
                    break
                depth = max(depth - 2, 0)
            if depth == 0 and base == REST:
                T = from_rest(x, rig.preload_N, C, c, wrap)
                if not rest_low < T < rest_high:
                    base = SLIP
            if depth == 0 and base == SLIP:
                T = max((pull_slope if direction > 0 else release_slope) * (x - slack_x), 0.0)
                out = T * (out_pulled if direction > 0 else out_released)
                phase[i] = direction if T > 0.0 else SLACK
        elif before == SLACK:
            phase[i] = SLACK
        before = phase[i]
        f_in[i] = T
        f_out[i] = out
    # In the order of the indices: stored one by one, or in a record, the loop takes a fifth longer.
    last[:] = np.array([x, T, out, direction, depth, base, before])
    return Tensions(f_in, f_out, phase)
