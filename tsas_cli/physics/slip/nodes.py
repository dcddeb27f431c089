"""Friction of the nodes of the slip chain: relation of tensions, stick or slip, pre-sliding.

Without presliding a node sticks or slips, and the active set are those that slip. With presliding
every node slides, with a share of its friction limit that follows its travel (Dahl's law), and its
relation is a tangent (Newton's method). On either side of zero travel the share is concave towards
its limit, so that from zero on the iteration does not overshoot; a step that would change the sign
of a travel stops at zero first.
"""

import math

from tsas_cli.effects.load_dependent_friction import load_exponent
from tsas_cli.effects.presliding import fixed_travel, friction_share, friction_share_rate
from tsas_cli.effects.stribeck_friction import stribeck_factor
from tsas_cli.effects.uneven_friction import place_factor
from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.elementary import exponential
from tsas_cli.physics.phases import SLIDING_SHARE
from tsas_cli.physics.slip import state as at
from tsas_cli.physics.slip.state import BALANCED, TOLERANCE, Moment, SlipLaws
from tsas_cli.support.arrays import Floats

MOST_WRAP = 30.0  # friction of a node times its bend, so that the tension behind it is not zero
SHORTEST_MM = 1e-6  # travel of a slack node, where that grows with the tension
MOST_RATIO_CHANGE = 0.5  # of a node's ratio of tensions by a tangent


@kernel
def set_friction(chain: Floats, now: Moment, laws: SlipLaws) -> None:
    """Set each node's friction and its capstan ratios, Eq. (7) of Yang 2025 for its bend.

    The pulleys of the ends have theirs at the first and the last node.
    """
    set_sheath_friction(chain, now, laws)
    add_pulley(chain, 1, laws.pulleys.drive_loss)
    add_pulley(chain, laws.n, laws.pulleys.load_loss)


@kernel
def add_pulley(chain: Floats, i: int, loss: float) -> None:
    """Add the friction of a pulley to that of a node."""
    if loss == 0.0:
        return
    chain[at.WRAP_PULLED + i] += loss
    chain[at.WRAP_RELEASED + i] += loss
    chain[at.RATIO_PULLED + i] = math.exp(-chain[at.WRAP_PULLED + i])
    chain[at.RATIO_RELEASED + i] = math.exp(-chain[at.WRAP_RELEASED + i])


@kernel
def set_sheath_friction(chain: Floats, now: Moment, laws: SlipLaws) -> None:
    """Set the friction of the sheath at each node."""
    n = laws.n
    pulled, released = now.losses.pulled / n, now.losses.released / n
    uniform = laws.friction_exponent == 0.0 and laws.friction_slope == 0.0
    if uniform and laws.stribeck.excess == 0.0:
        ratio_pulled, ratio_released = math.exp(-pulled), math.exp(-released)
        for i in range(1, n + 1):
            chain[at.WRAP_PULLED + i], chain[at.WRAP_RELEASED + i] = pulled, released
            chain[at.RATIO_PULLED + i], chain[at.RATIO_RELEASED + i] = ratio_pulled, ratio_released
        return
    for i in range(1, n + 1):  # short loops: in one, the compiler runs out of registers
        mean = 0.5 * (chain[at.TENSION + i - 1] + chain[at.TENSION + i])
        chain[at.WRAP_PULLED + i] = load_exponent(mean, laws.friction_exponent)
    for i in range(1, n + 1):
        factor = exponential(chain[at.WRAP_PULLED + i])
        factor *= place_factor((i - 0.5) / n, laws.friction_slope)
        if laws.stribeck.excess != 0.0:
            factor *= stribeck_factor(chain[at.SPEED + i], laws.stribeck)
        chain[at.WRAP_PULLED + i] = min(pulled * factor, MOST_WRAP)
        chain[at.WRAP_RELEASED + i] = min(released * factor, MOST_WRAP)
    if laws.presliding.length_mm == 0.0:
        for i in range(1, n + 1):
            chain[at.RATIO_PULLED + i] = exponential(-chain[at.WRAP_PULLED + i])
        for i in range(1, n + 1):
            chain[at.RATIO_RELEASED + i] = exponential(-chain[at.WRAP_RELEASED + i])


@kernel
def set_lengths(chain: Floats, now: Moment, laws: SlipLaws) -> None:
    """Set the travel over which each node's friction reverses, at the tensions of the tangents.

    The deflection of its bristles stays what it was: their friction over the limit does not.
    """
    if laws.presliding.length_mm == 0.0:
        return
    fixed, drag_N = fixed_travel(laws.presliding), now.losses.drag_N / laws.n
    for i in range(1, laws.n + 1):
        tension = 0.5 * abs(chain[at.TENSION + i - 1] + chain[at.TENSION + i])
        wrap = 0.5 * (chain[at.WRAP_PULLED + i] + chain[at.WRAP_RELEASED + i])
        length = max(fixed + laws.bristle_mm_per_N * (tension * wrap + drag_N), SHORTEST_MM)
        if chain[at.LENGTH + i] > 0.0:
            chain[at.SHARE_BEFORE + i] *= chain[at.LENGTH + i] / length
        chain[at.LENGTH + i] = length


@kernel
def update_speeds(chain: Floats, step_s: float, laws: SlipLaws) -> None:
    """Let the speed that a node's friction follows approach that of its step, before `accept`.

    First order in the step; a quasi-static step has no speed.
    """
    if laws.stribeck.excess == 0.0 or step_s == math.inf:
        return
    share = 1.0 - math.exp(-step_s / laws.stribeck.lag_s)
    for i in range(1, laws.n + 1):
        speed = abs(chain[at.POSITION + i] - chain[at.POSITION_BEFORE + i]) / step_s
        chain[at.SPEED + i] += share * (speed - chain[at.SPEED + i])


@kernel
def is_linear(laws: SlipLaws) -> bool:
    """Return whether the problem is linear for a given active set."""
    return (
        laws.friction_exponent == 0.0
        and laws.presliding.length_mm == 0.0
        and laws.load.mass_kg == 0.0
        and laws.load.hysteresis.force_N == 0.0
        and laws.load.nonlinearity.quadratic_per_mm == 0.0
        and laws.load.nonlinearity.cubic_per_mm2 == 0.0
        and laws.load.ripple.sine_mm == 0.0
        and laws.load.ripple.cosine_mm == 0.0
    )


@kernel
def capstan_ratio(direction: float, i: int, chain: Floats) -> float:
    """Return T[i]/T[i−1] of a node that slips in a direction, 1 or −1."""
    ratio: float = chain[at.RATIO_PULLED + i] if direction > 0.0 else chain[at.RATIO_RELEASED + i]
    negative = chain[at.TENSION + i - 1] + chain[at.TENSION + i] < 0.0
    return ratio if (direction > 0.0) != negative else 1.0 / ratio


@kernel
def update_relations(chain: Floats, now: Moment, laws: SlipLaws) -> bool:
    """Set the relations of all sliding nodes; return whether they changed."""
    if laws.presliding.length_mm > 0.0:
        stopped = update_travel(chain, laws)
        return set_tangent_relations(chain, now, laws) or stopped
    if laws.friction_exponent == 0.0:
        return set_capstan_relations(chain, now, laws)
    for i in range(1, laws.n + 1):
        chain[at.SHARE + i] = chain[at.SLIP + i]
    return set_tangent_relations(chain, now, laws)


@kernel
def set_capstan_relations(chain: Floats, now: Moment, laws: SlipLaws) -> bool:
    """Set the relations of sliding nodes where friction does not depend on the tension."""
    n = laws.n
    changed = False
    for i in range(1, n + 1):
        slip = chain[at.SLIP + i]
        if slip != 0.0:
            ratio = capstan_ratio(slip, i, chain)
            half = 0.5 * slip * now.losses.drag_N / n
            changed = changed or ratio != chain[at.FACTOR + i]
            chain[at.FACTOR + i], chain[at.DROP + i] = ratio, half + ratio * half
    return changed


@kernel
def set_tangent_relations(chain: Floats, now: Moment, laws: SlipLaws) -> bool:
    """Set the relations of sliding nodes by tangents; those of sticking nodes too.

    The tangent of (T[i] + w z/2) = E (T[i−1] − w z/2), half of the drag w on either side
    of the bend, E = e^(∓a f z/n), z the ratio of friction to its limit. Friction that depends on
    the tension adds dE/dm = ∓(a/n) E f β/m, m the mean tension of both sides; a bristle adds dz/dx
    of the node's travel.
    """
    n = laws.n
    loss = now.losses.drag_N / n
    unbalanced = 0
    for i in range(1, n + 1):
        share, mean = chain[at.SHARE + i], chain[at.TENSION + i - 1] + chain[at.TENSION + i]
        pulled, released = chain[at.WRAP_PULLED + i], chain[at.WRAP_RELEASED + i]
        limit = pulled if share > 0.0 else released
        chain[at.WRAP_LIMIT + i] = limit
        chain[at.WRAP_SIGNED + i] = -share * limit if mean >= 0.0 else share * limit
        chain[at.RATIO + i] = exponential(chain[at.WRAP_SIGNED + i])
    for i in range(1, n + 1):
        share, before, behind = (
            chain[at.SHARE + i],
            chain[at.TENSION + i - 1],
            chain[at.TENSION + i],
        )
        half, mean = 0.5 * share * loss, before + behind
        carried = before - half
        limit, wrap, ratio = (
            chain[at.WRAP_LIMIT + i],
            chain[at.WRAP_SIGNED + i],
            chain[at.RATIO + i],
        )
        residual = behind + half - ratio * carried
        ratio_change = (
            wrap * ratio * laws.friction_exponent * carried / (mean if mean != 0.0 else math.inf)
        )
        ratio_change = min(max(ratio_change, -MOST_RATIO_CHANGE), MOST_RATIO_CHANGE)
        inverse = 1.0 / (1.0 - ratio_change)
        factor = (ratio + ratio_change) * inverse
        chain[at.FACTOR + i] = factor
        chain[at.DROP + i] = factor * before - behind + residual * inverse
        # Derivative of the drop by the share; pre-sliding multiplies it by that of the share by x.
        chain[at.DROP_SLOPE + i] = (
            0.5 * (1.0 + ratio) * loss + ratio * abs(carried) * limit
        ) * inverse
        unbalanced += abs(share * residual) > BALANCED * abs(share) * (abs(before) + laws.preload_N)
    if laws.presliding.length_mm > 0.0:
        add_presliding_slope(chain, laws)
    return unbalanced > 0


@kernel
def add_presliding_slope(chain: Floats, laws: SlipLaws) -> None:
    """Add the derivative of the drop of tension by a node's travel, at the tangent's point."""
    for i in range(1, laws.n + 1):
        moved = chain[at.TRAVEL + i]
        rate = friction_share_rate(chain[at.SHARE + i], moved, chain[at.LENGTH + i])
        chain[at.DROP_SLOPE + i] *= rate
        chain[at.DROP + i] -= chain[at.DROP_SLOPE + i] * (chain[at.POSITION_BEFORE + i] + moved)


@kernel
def update_travel(chain: Floats, laws: SlipLaws) -> bool:
    """Set the nodes' travel, zero on a change of sign; return whether one was set so.

    A change of sign within rounding, of a node that rests, is none: it would never end.
    """
    stopped = 0
    for i in range(1, laws.n + 1):
        moved = chain[at.POSITION + i] - chain[at.POSITION_BEFORE + i]
        reversed_sign = moved * chain[at.TRAVEL + i] < 0.0
        stopped += reversed_sign and abs(moved - chain[at.TRAVEL + i]) > TOLERANCE * laws.scale_mm
        moved = 0.0 if reversed_sign else moved
        chain[at.TRAVEL + i] = moved
        length = chain[at.LENGTH + i]
        chain[at.SHARE + i] = friction_share(chain[at.SHARE_BEFORE + i], moved, length)
    return stopped > 0


@kernel
def extrapolate(chain: Floats, laws: SlipLaws) -> None:
    """Extrapolate the last step, the point of the tangents of nonlinear laws."""
    for j in range(laws.n + 2):
        chain[at.POSITION + j] = chain[at.POSITION_BEFORE + j] + chain[at.TRAVEL + j]
        chain[at.TENSION + j] = chain[at.TENSION_BEFORE + j] + chain[at.TENSION_RISE + j]


@kernel
def accept(chain: Floats, laws: SlipLaws) -> None:
    """Accept the present state as the solution of the step."""
    if laws.presliding.length_mm > 0.0:
        for i in range(1, laws.n + 1):
            share = chain[at.SHARE + i]
            chain[at.SHARE_BEFORE + i] = share
            chain[at.SLIP + i] = math.copysign(1.0, share) if abs(share) > SLIDING_SHARE else 0.0
    if not is_linear(laws):
        for j in range(laws.n + 2):
            chain[at.TRAVEL + j] = chain[at.POSITION + j] - chain[at.POSITION_BEFORE + j]
            chain[at.TENSION_RISE + j] = chain[at.TENSION + j] - chain[at.TENSION_BEFORE + j]
    for j in range(laws.n + 2):
        chain[at.POSITION_BEFORE + j], chain[at.TENSION_BEFORE + j] = (
            chain[at.POSITION + j],
            chain[at.TENSION + j],
        )


@kernel
def slips_backwards(i: int, chain: Floats, laws: SlipLaws) -> bool:
    """Return whether a slipping node has slid against its own direction."""
    slid = chain[at.POSITION + i] - chain[at.POSITION_BEFORE + i]
    return bool(chain[at.SLIP + i] * slid < -TOLERANCE * laws.scale_mm)


@kernel
def slip_after_backwards(i: int, loss: float, chain: Floats) -> float:
    """Return the next slip of a node that has slid backwards: none, or the other direction.

    Held in place it would need a force of the two segments beside it; where that exceeds the
    friction of both directions the node cannot stick. Without this, nodes with little friction
    between two ends that stretch the tendon stick and slip in turn, without an end.
    """
    slid = abs(chain[at.POSITION + i] - chain[at.POSITION_BEFORE + i])
    force = slid * (1.0 / chain[at.COMPLIANCE + i - 1] + 1.0 / chain[at.COMPLIANCE + i])
    limits = 1.0 / capstan_ratio(1.0, i, chain) - 1.0 / capstan_ratio(-1.0, i, chain)
    return -chain[at.SLIP + i] if force > abs(limits * chain[at.TENSION + i]) + 2.0 * loss else 0.0


@kernel
def breakaway(i: int, loss: float, chain: Floats) -> float:
    """Return the direction in which the tensions exceed a sticking node's friction, else 0."""
    before, behind, half = chain[at.TENSION + i - 1], chain[at.TENSION + i], 0.5 * loss
    margin = TOLERANCE * abs(before)
    if behind + half < capstan_ratio(1.0, i, chain) * (before - half) - margin:
        return 1.0
    if behind - half > capstan_ratio(-1.0, i, chain) * (before + half) + margin:
        return -1.0
    return 0.0
