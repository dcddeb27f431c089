"""Friction of the nodes of the slip chain: what each passes on, where it sticks, what bristles do.

Without presliding a node sticks or slips, and the set of those that slip is searched for. With
presliding every node slides, by a share of its limit that follows its way (Dahl's law); its
tangent is renewed until the law holds (Newton's method). On either side of no way at all the share
is concave towards its limit, so that from no way on the iteration does not overshoot; a step that
would leave its side stops there first.
"""

import math

from tsas_cli.effects.load_dependent_friction import load_factor
from tsas_cli.effects.presliding import share_turned, turning_rate
from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.chain_state import (
    BALANCED,
    BRISTLE,
    MOVED,
    PASSES,
    PULLED,
    PULLED_BY,
    RELEASED,
    RELEASED_BY,
    SLIP,
    T_OLD,
    TAKES,
    TOLERANCE,
    TURNED,
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
    for i in range(1, n + 1):
        tension = 0.5 * (chain[T + i - 1] + chain[T + i])
        factor = load_factor(tension / laws.preload_N, laws.friction_exponent)
        chain[PULLED_BY + i] = min(pulled * factor, STRONGEST)
        chain[RELEASED_BY + i] = min(released * factor, STRONGEST)


@kernel
def is_straight(laws: Laws) -> bool:
    """Say whether a sliding node passes on the same ratio of any tension."""
    return laws.friction_exponent == 0.0 and laws.presliding_mm == 0.0


@kernel
def wrap_of(share: float, i: int, chain: Floats) -> float:
    """Return friction times bend of a node whose friction has reached a share of its limit."""
    own: float = chain[PULLED_BY + i] if share > 0.0 else chain[RELEASED_BY + i]
    return abs(share) * own


@kernel
def ratio_passed(share: float, i: int, chain: Floats, laws: Laws) -> float:
    """Return T[i]/T[i−1] of a node whose friction has reached a share of its limit, −1 to 1."""
    if is_straight(laws):
        ratio: float = chain[PULLED + i] if share > 0.0 else chain[RELEASED + i]
    else:
        ratio = math.exp(-wrap_of(share, i, chain))
    negative = chain[T + i - 1] + chain[T + i] < 0.0
    return ratio if (share > 0.0) != negative else 1.0 / ratio


@kernel
def set_slides(chain: Floats, now: Moment, laws: Laws) -> bool:
    """Renew what all sliding nodes pass on; return whether it differs from what was used.

    The tangent of (T[i] + w z/2) = E (T[i−1] − w z/2), half of the viscous loss w on either side
    of the bend, E = e^(∓a f z/n). Friction that depends on the tension turns it by
    dE/dm = ∓(a/n) E f β/m, m the mean tension of both sides; a bristle by dz/dx of the node's way.
    """
    n = laws.n
    straight = is_straight(laws)
    changed = False
    for i in range(1, n + 1):
        share = chain[SLIP + i]
        if laws.presliding_mm > 0.0:
            share = follow(i, chain, laws)
            changed = changed or chain[MOVED + i] != chain[X + i] - chain[X_OLD + i]
        elif share == 0.0:
            continue
        ratio = ratio_passed(share, i, chain, laws)
        half = 0.5 * share * now.viscous_N / n
        if straight:
            changed = changed or ratio != chain[PASSES + i]
            chain[PASSES + i], chain[TAKES + i] = ratio, half + ratio * half
            continue
        before, behind = chain[T + i - 1], chain[T + i]
        carried, mean = before - half, before + behind
        off = behind + half - ratio * carried
        changed = changed or abs(off) > BALANCED * (abs(before) + laws.preload_N)
        wrap = wrap_of(share, i, chain) if ratio > 1.0 else -wrap_of(share, i, chain)
        bent = wrap * ratio * laws.friction_exponent * carried / mean if mean else 0.0
        bent = min(max(bent, -MOST_BENT), MOST_BENT)
        passes = (ratio + bent) / (1.0 - bent)
        takes = passes * before - behind + off / (1.0 - bent)
        chain[PASSES + i], chain[TAKES + i] = passes, takes
        if laws.presliding_mm > 0.0:
            own = wrap_of(1.0 if share > 0.0 else -1.0, i, chain)
            limit = 0.5 * (1.0 + ratio) * now.viscous_N / n + ratio * abs(carried) * own
            lean_on_bristle(i, share, limit / (1.0 - bent), chain, laws)
    return changed


@kernel
def lean_on_bristle(i: int, share: float, limit: float, chain: Floats, laws: Laws) -> None:
    """Let what a node takes rise with its way, from where its tangent was taken."""
    rate = turning_rate(share, chain[MOVED + i], laws.presliding_mm)
    chain[BRISTLE + i] = limit * rate
    chain[TAKES + i] -= chain[BRISTLE + i] * (chain[X_OLD + i] + chain[MOVED + i])


@kernel
def follow(i: int, chain: Floats, laws: Laws) -> float:
    """Take a node's way so far, no further than to its turning; return its share of friction."""
    moved = chain[X + i] - chain[X_OLD + i]
    if moved * chain[MOVED + i] < 0.0:
        moved = 0.0
    chain[MOVED + i] = moved
    return share_turned(chain[TURNED + i], moved, laws.presliding_mm)


@kernel
def expect(chain: Floats, laws: Laws) -> None:
    """Let each node on a bristle set off by the way of the last step."""
    for i in range(1, laws.n + 1):
        chain[X + i] = chain[X_OLD + i] + chain[MOVED + i]


@kernel
def keep(chain: Floats, laws: Laws) -> None:
    """Take the present state as the settled one."""
    if laws.presliding_mm > 0.0:
        for i in range(1, laws.n + 1):
            moved = chain[X + i] - chain[X_OLD + i]
            share = share_turned(chain[TURNED + i], moved, laws.presliding_mm)
            chain[TURNED + i], chain[MOVED + i] = share, moved
            chain[SLIP + i] = math.copysign(1.0, share) if abs(share) > SLIDES else 0.0
    for j in range(laws.n + 2):
        chain[X_OLD + j], chain[T_OLD + j] = chain[X + j], chain[T + j]


@kernel
def slid_back(i: int, chain: Floats, scale: float) -> bool:
    """Say whether a slipping node has slid against its own direction."""
    slid = chain[X + i] - chain[X_OLD + i]
    return bool(chain[SLIP + i] * slid < -TOLERANCE * scale)


@kernel
def pulled_loose(i: int, loss: float, chain: Floats, laws: Laws) -> float:
    """Return the direction in which the tensions pull a node that sticks, 0 where it holds."""
    before, behind, half = chain[T + i - 1], chain[T + i], 0.5 * loss
    margin = TOLERANCE * abs(before)
    if behind + half < ratio_passed(1.0, i, chain, laws) * (before - half) - margin:
        return 1.0
    if behind - half > ratio_passed(-1.0, i, chain, laws) * (before + half) + margin:
        return -1.0
    return 0.0
