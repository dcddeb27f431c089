"""Friction of the nodes of the slip chain: what each passes on, where it sticks, what bristles do.

Without presliding a node sticks or slips, and the set of those that slip is searched for. With
presliding every node slides, by a share of its limit that follows its way (Dahl's law); its
tangent is renewed until the law holds (Newton's method). On either side of no way at all the share
is concave towards its limit, so that from no way on the iteration does not overshoot; a step that
would leave its side stops there first.
"""

import math

from tsas_cli.effects.load_dependent_friction import load_exponent
from tsas_cli.effects.presliding import share_turned, turning_rate
from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.elementary import exponential
from tsas_cli.physics.slip.state import (
    BALANCED,
    DROP,
    DROP_SLOPE,
    FACTOR,
    POSITION,
    POSITION_BEFORE,
    RATIO,
    RATIO_PULLED,
    RATIO_RELEASED,
    SHARE,
    SHARE_BEFORE,
    SLIP,
    TENSION,
    TENSION_BEFORE,
    TENSION_RISE,
    TOLERANCE,
    TRAVEL,
    WRAP_LIMIT,
    WRAP_PULLED,
    WRAP_RELEASED,
    WRAP_SIGNED,
    Floats,
    Moment,
    SlipLaws,
)

MOST_WRAP = 30.0  # friction of a node times its bend, so that it passes on more than nothing
MOST_RATIO_CHANGE = 0.5  # of the ratio that a node passes on: how far a tangent may turn it
SLIDING_SHARE = 0.99  # share of its limit from which a node on a bristle is said to slip


@kernel
def set_friction(chain: Floats, now: Moment, laws: SlipLaws) -> None:
    """Renew what each node's friction leaves of the tension, Eq. (7) of Yang 2025 for its bend."""
    n = laws.n
    pulled, released = now.losses.pulled / n, now.losses.released / n
    if laws.friction_exponent == 0.0:
        passed, kept = math.exp(-pulled), math.exp(-released)
        for i in range(1, n + 1):
            chain[WRAP_PULLED + i], chain[WRAP_RELEASED + i] = pulled, released
            chain[RATIO_PULLED + i], chain[RATIO_RELEASED + i] = passed, kept
        return
    per_N = 0.5 / laws.preload_N
    for i in range(1, n + 1):  # short loops: in one, the compiler runs out of registers
        mean = (chain[TENSION + i - 1] + chain[TENSION + i]) * per_N
        chain[WRAP_PULLED + i] = load_exponent(mean, laws.friction_exponent)
    for i in range(1, n + 1):
        factor = exponential(chain[WRAP_PULLED + i])
        chain[WRAP_PULLED + i] = min(pulled * factor, MOST_WRAP)
        chain[WRAP_RELEASED + i] = min(released * factor, MOST_WRAP)
    if laws.presliding_mm == 0.0:
        for i in range(1, n + 1):
            chain[RATIO_PULLED + i] = exponential(-chain[WRAP_PULLED + i])
        for i in range(1, n + 1):
            chain[RATIO_RELEASED + i] = exponential(-chain[WRAP_RELEASED + i])


@kernel
def is_linear(laws: SlipLaws) -> bool:
    """Say whether all that is not straight is the set of nodes that slip."""
    return (
        laws.friction_exponent == 0.0
        and laws.presliding_mm == 0.0
        and laws.load.mass_kg == 0.0
        and laws.load.nonlinearity.quadratic_per_mm == 0.0
        and laws.load.nonlinearity.cubic_per_mm2 == 0.0
    )


@kernel
def capstan_ratio(direction: float, i: int, chain: Floats) -> float:
    """Return T[i]/T[i−1] of a node that slips in a direction, 1 or −1."""
    ratio: float = chain[RATIO_PULLED + i] if direction > 0.0 else chain[RATIO_RELEASED + i]
    negative = chain[TENSION + i - 1] + chain[TENSION + i] < 0.0
    return ratio if (direction > 0.0) != negative else 1.0 / ratio


@kernel
def update_relations(chain: Floats, now: Moment, laws: SlipLaws) -> bool:
    """Renew what all sliding nodes pass on; return whether it differs from what was used."""
    if laws.presliding_mm > 0.0:
        turned = update_travel(chain, laws)
        return set_tangent_relations(chain, now, laws) or turned
    if laws.friction_exponent == 0.0:
        return set_capstan_relations(chain, now, laws)
    for i in range(1, laws.n + 1):
        chain[SHARE + i] = chain[SLIP + i]
    return set_tangent_relations(chain, now, laws)


@kernel
def set_capstan_relations(chain: Floats, now: Moment, laws: SlipLaws) -> bool:
    """Set what sliding nodes pass on where that is the same of any tension."""
    n = laws.n
    changed = False
    for i in range(1, n + 1):
        slip = chain[SLIP + i]
        if slip != 0.0:
            ratio = capstan_ratio(slip, i, chain)
            half = 0.5 * slip * now.losses.viscous_N / n
            changed = changed or ratio != chain[FACTOR + i]
            chain[FACTOR + i], chain[DROP + i] = ratio, half + ratio * half
    return changed


@kernel
def set_tangent_relations(chain: Floats, now: Moment, laws: SlipLaws) -> bool:
    """Set what sliding nodes pass on by a tangent, all at once; a node that sticks gets one too.

    The tangent of (T[i] + w z/2) = E (T[i−1] − w z/2), half of the viscous loss w on either side
    of the bend, E = e^(∓a f z/n), z the share of its limit that friction has reached. Friction that
    depends on the tension turns it by dE/dm = ∓(a/n) E f β/m, m the mean tension of both sides; a
    bristle by dz/dx of the node's way.
    """
    n = laws.n
    loss = now.losses.viscous_N / n
    wrong = 0
    for i in range(1, n + 1):
        share, mean = chain[SHARE + i], chain[TENSION + i - 1] + chain[TENSION + i]
        pulled, released = chain[WRAP_PULLED + i], chain[WRAP_RELEASED + i]
        limit = pulled if share > 0.0 else released
        chain[WRAP_LIMIT + i] = limit
        chain[WRAP_SIGNED + i] = -share * limit if mean >= 0.0 else share * limit
        chain[RATIO + i] = exponential(chain[WRAP_SIGNED + i])
    for i in range(1, n + 1):
        share, before, behind = chain[SHARE + i], chain[TENSION + i - 1], chain[TENSION + i]
        half, mean = 0.5 * share * loss, before + behind
        carried = before - half
        limit, wrap, ratio = chain[WRAP_LIMIT + i], chain[WRAP_SIGNED + i], chain[RATIO + i]
        off = behind + half - ratio * carried
        bent = wrap * ratio * laws.friction_exponent * carried / (mean if mean != 0.0 else math.inf)
        bent = min(max(bent, -MOST_RATIO_CHANGE), MOST_RATIO_CHANGE)
        inverse = 1.0 / (1.0 - bent)
        passes = (ratio + bent) * inverse
        chain[FACTOR + i] = passes
        chain[DROP + i] = passes * before - behind + off * inverse
        # How what is passed on falls with the share: what a bristle turns into a slope.
        chain[DROP_SLOPE + i] = (
            0.5 * (1.0 + ratio) * loss + ratio * abs(carried) * limit
        ) * inverse
        wrong += abs(share * off) > BALANCED * abs(share) * (abs(before) + laws.preload_N)
    if laws.presliding_mm > 0.0:
        add_presliding_slope(chain, laws)
    return wrong > 0


@kernel
def add_presliding_slope(chain: Floats, laws: SlipLaws) -> None:
    """Let what each node takes rise with its way, from where its tangent was taken."""
    for i in range(1, laws.n + 1):
        moved = chain[TRAVEL + i]
        rate = turning_rate(chain[SHARE + i], moved, laws.presliding_mm)
        chain[DROP_SLOPE + i] *= rate
        chain[DROP + i] -= chain[DROP_SLOPE + i] * (chain[POSITION_BEFORE + i] + moved)


@kernel
def update_travel(chain: Floats, laws: SlipLaws) -> bool:
    """Take the nodes' ways so far, none further than to its turning; return whether one turned."""
    turned = 0
    for i in range(1, laws.n + 1):
        moved = chain[POSITION + i] - chain[POSITION_BEFORE + i]
        back = moved * chain[TRAVEL + i] < 0.0
        turned += back
        moved = 0.0 if back else moved
        chain[TRAVEL + i] = moved
        chain[SHARE + i] = share_turned(chain[SHARE_BEFORE + i], moved, laws.presliding_mm)
    return turned > 0


@kernel
def extrapolate(chain: Floats, laws: SlipLaws) -> None:
    """Go on as in the last step: laws that are not straight are bent about what comes out."""
    for j in range(laws.n + 2):
        chain[POSITION + j] = chain[POSITION_BEFORE + j] + chain[TRAVEL + j]
        chain[TENSION + j] = chain[TENSION_BEFORE + j] + chain[TENSION_RISE + j]


@kernel
def accept(chain: Floats, laws: SlipLaws) -> None:
    """Take the present state as the settled one."""
    if laws.presliding_mm > 0.0:
        for i in range(1, laws.n + 1):
            share = chain[SHARE + i]
            direction = 1.0 if share > 0.0 else -1.0
            chain[SHARE_BEFORE + i] = share
            chain[SLIP + i] = direction if abs(share) > SLIDING_SHARE else 0.0
    if not is_linear(laws):
        for j in range(laws.n + 2):
            chain[TRAVEL + j] = chain[POSITION + j] - chain[POSITION_BEFORE + j]
            chain[TENSION_RISE + j] = chain[TENSION + j] - chain[TENSION_BEFORE + j]
    for j in range(laws.n + 2):
        chain[POSITION_BEFORE + j], chain[TENSION_BEFORE + j] = (
            chain[POSITION + j],
            chain[TENSION + j],
        )


@kernel
def slips_backwards(i: int, chain: Floats, laws: SlipLaws) -> bool:
    """Say whether a slipping node has slid against its own direction."""
    slid = chain[POSITION + i] - chain[POSITION_BEFORE + i]
    return bool(chain[SLIP + i] * slid < -TOLERANCE * laws.scale_mm)


@kernel
def breakaway(i: int, loss: float, chain: Floats) -> float:
    """Return the direction in which the tensions pull a node that sticks, 0 where it holds."""
    before, behind, half = chain[TENSION + i - 1], chain[TENSION + i], 0.5 * loss
    margin = TOLERANCE * abs(before)
    if behind + half < capstan_ratio(1.0, i, chain) * (before - half) - margin:
        return 1.0
    if behind - half > capstan_ratio(-1.0, i, chain) * (before + half) + margin:
        return -1.0
    return 0.0
