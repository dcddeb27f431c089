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
    BRISTLE,
    LIMIT,
    MOVED,
    PASSES,
    PULLED,
    PULLED_BY,
    RATIO,
    RELEASED,
    RELEASED_BY,
    SHARE,
    SLIP,
    T_OLD,
    T_ROSE,
    TAKES,
    TOLERANCE,
    TURNED,
    WRAP,
    X_OLD,
    Floats,
    Laws,
    Moment,
    T,
    X,
)

STRONGEST = 30.0  # friction of a node times its bend, so that it passes on more than nothing
MOST_BENT = 0.5  # of the ratio that a node passes on: how far a tangent may turn it
SLIDES = 0.99  # share of its limit from which a node on a bristle is said to slip


@kernel
def set_friction(chain: Floats, now: Moment, laws: Laws) -> None:
    """Renew what each node's friction leaves of the tension, Eq. (7) of Yang 2025 for its bend."""
    n = laws.n
    pulled, released = now.pulled / n, now.released / n
    if laws.friction_exponent == 0.0:
        passed, kept = math.exp(-pulled), math.exp(-released)
        for i in range(1, n + 1):
            chain[PULLED_BY + i], chain[RELEASED_BY + i] = pulled, released
            chain[PULLED + i], chain[RELEASED + i] = passed, kept
        return
    per_N = 0.5 / laws.preload_N
    for i in range(1, n + 1):  # short loops: in one, the compiler runs out of registers
        mean = (chain[T + i - 1] + chain[T + i]) * per_N
        chain[PULLED_BY + i] = load_exponent(mean, laws.friction_exponent)
    for i in range(1, n + 1):
        factor = exponential(chain[PULLED_BY + i])
        chain[PULLED_BY + i] = min(pulled * factor, STRONGEST)
        chain[RELEASED_BY + i] = min(released * factor, STRONGEST)
    if laws.presliding_mm == 0.0:
        for i in range(1, n + 1):
            chain[PULLED + i] = exponential(-chain[PULLED_BY + i])
        for i in range(1, n + 1):
            chain[RELEASED + i] = exponential(-chain[RELEASED_BY + i])


@kernel
def is_straight(laws: Laws) -> bool:
    """Say whether all that is not straight is the set of nodes that slip."""
    return (
        laws.friction_exponent == 0.0
        and laws.presliding_mm == 0.0
        and laws.load_mass_kg == 0.0
        and laws.load_spring.quadratic_per_mm == 0.0
        and laws.load_spring.cubic_per_mm2 == 0.0
    )


@kernel
def ratio_passed(direction: float, i: int, chain: Floats) -> float:
    """Return T[i]/T[i−1] of a node that slips in a direction, 1 or −1."""
    ratio: float = chain[PULLED + i] if direction > 0.0 else chain[RELEASED + i]
    negative = chain[T + i - 1] + chain[T + i] < 0.0
    return ratio if (direction > 0.0) != negative else 1.0 / ratio


@kernel
def set_slides(chain: Floats, now: Moment, laws: Laws) -> bool:
    """Renew what all sliding nodes pass on; return whether it differs from what was used."""
    if laws.presliding_mm > 0.0:
        turned = follow_ways(chain, laws)
        return set_tangents(chain, now, laws) or turned
    if laws.friction_exponent == 0.0:
        return set_ratios(chain, now, laws)
    for i in range(1, laws.n + 1):
        chain[SHARE + i] = chain[SLIP + i]
    return set_tangents(chain, now, laws)


@kernel
def set_ratios(chain: Floats, now: Moment, laws: Laws) -> bool:
    """Set what sliding nodes pass on where that is the same of any tension."""
    n = laws.n
    changed = False
    for i in range(1, n + 1):
        slip = chain[SLIP + i]
        if slip != 0.0:
            ratio = ratio_passed(slip, i, chain)
            half = 0.5 * slip * now.viscous_N / n
            changed = changed or ratio != chain[PASSES + i]
            chain[PASSES + i], chain[TAKES + i] = ratio, half + ratio * half
    return changed


@kernel
def set_tangents(chain: Floats, now: Moment, laws: Laws) -> bool:
    """Set what sliding nodes pass on by a tangent, all at once; a node that sticks gets one too.

    The tangent of (T[i] + w z/2) = E (T[i−1] − w z/2), half of the viscous loss w on either side
    of the bend, E = e^(∓a f z/n), z the share of its limit that friction has reached. Friction that
    depends on the tension turns it by dE/dm = ∓(a/n) E f β/m, m the mean tension of both sides; a
    bristle by dz/dx of the node's way.
    """
    n = laws.n
    loss = now.viscous_N / n
    wrong = 0
    for i in range(1, n + 1):
        share, mean = chain[SHARE + i], chain[T + i - 1] + chain[T + i]
        pulled, released = chain[PULLED_BY + i], chain[RELEASED_BY + i]
        limit = pulled if share > 0.0 else released
        chain[LIMIT + i] = limit
        chain[WRAP + i] = -share * limit if mean >= 0.0 else share * limit
        chain[RATIO + i] = exponential(chain[WRAP + i])
    for i in range(1, n + 1):
        share, before, behind = chain[SHARE + i], chain[T + i - 1], chain[T + i]
        half, mean = 0.5 * share * loss, before + behind
        carried = before - half
        limit, wrap, ratio = chain[LIMIT + i], chain[WRAP + i], chain[RATIO + i]
        off = behind + half - ratio * carried
        bent = wrap * ratio * laws.friction_exponent * carried / (mean if mean != 0.0 else math.inf)
        bent = min(max(bent, -MOST_BENT), MOST_BENT)
        inverse = 1.0 / (1.0 - bent)
        passes = (ratio + bent) * inverse
        chain[PASSES + i] = passes
        chain[TAKES + i] = passes * before - behind + off * inverse
        # How what is passed on falls with the share: what a bristle turns into a slope.
        chain[BRISTLE + i] = (0.5 * (1.0 + ratio) * loss + ratio * abs(carried) * limit) * inverse
        wrong += abs(share * off) > BALANCED * abs(share) * (abs(before) + laws.preload_N)
    if laws.presliding_mm > 0.0:
        lean_on_bristles(chain, laws)
    return wrong > 0


@kernel
def lean_on_bristles(chain: Floats, laws: Laws) -> None:
    """Let what each node takes rise with its way, from where its tangent was taken."""
    for i in range(1, laws.n + 1):
        moved = chain[MOVED + i]
        rate = turning_rate(chain[SHARE + i], moved, laws.presliding_mm)
        chain[BRISTLE + i] *= rate
        chain[TAKES + i] -= chain[BRISTLE + i] * (chain[X_OLD + i] + moved)


@kernel
def follow_ways(chain: Floats, laws: Laws) -> bool:
    """Take the nodes' ways so far, none further than to its turning; return whether one turned."""
    turned = 0
    for i in range(1, laws.n + 1):
        moved = chain[X + i] - chain[X_OLD + i]
        back = moved * chain[MOVED + i] < 0.0
        turned += back
        moved = 0.0 if back else moved
        chain[MOVED + i] = moved
        chain[SHARE + i] = share_turned(chain[TURNED + i], moved, laws.presliding_mm)
    return turned > 0


@kernel
def expect(chain: Floats, laws: Laws) -> None:
    """Go on as in the last step: laws that are not straight are bent about what comes out."""
    for j in range(laws.n + 2):
        chain[X + j] = chain[X_OLD + j] + chain[MOVED + j]
        chain[T + j] = chain[T_OLD + j] + chain[T_ROSE + j]


@kernel
def keep(chain: Floats, laws: Laws) -> None:
    """Take the present state as the settled one."""
    if laws.presliding_mm > 0.0:
        for i in range(1, laws.n + 1):
            share = chain[SHARE + i]
            direction = 1.0 if share > 0.0 else -1.0
            chain[TURNED + i] = share
            chain[SLIP + i] = direction if abs(share) > SLIDES else 0.0
    if not is_straight(laws):
        for j in range(laws.n + 2):
            chain[MOVED + j] = chain[X + j] - chain[X_OLD + j]
            chain[T_ROSE + j] = chain[T + j] - chain[T_OLD + j]
    for j in range(laws.n + 2):
        chain[X_OLD + j], chain[T_OLD + j] = chain[X + j], chain[T + j]


@kernel
def slid_back(i: int, chain: Floats, scale: float) -> bool:
    """Say whether a slipping node has slid against its own direction."""
    slid = chain[X + i] - chain[X_OLD + i]
    return bool(chain[SLIP + i] * slid < -TOLERANCE * scale)


@kernel
def pulled_loose(i: int, loss: float, chain: Floats) -> float:
    """Return the direction in which the tensions pull a node that sticks, 0 where it holds."""
    before, behind, half = chain[T + i - 1], chain[T + i], 0.5 * loss
    margin = TOLERANCE * abs(before)
    if behind + half < ratio_passed(1.0, i, chain) * (before - half) - margin:
        return 1.0
    if behind - half > ratio_passed(-1.0, i, chain) * (before + half) + margin:
        return -1.0
    return 0.0
