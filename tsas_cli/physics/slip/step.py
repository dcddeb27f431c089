"""One static problem of the slip chain: which nodes slip, and where everything then is.

Given how the nodes slide, the chain is a row of affine relations. From the load backwards each
segment's tension is T = (p x + q)/r with the position x of the node before it: a sliding node
multiplies (and adds its bristle), a node that sticks starts anew, a segment adds its compliance.
From the drive forwards the positions follow. No sweep waits for a division at every node, and none
can blow up: p and r are positive. Then every node is held against its own law (`nodes`), and
those that break it are revised: an active set of those that slip, tangents of what is not straight
(a semi-smooth Newton method).

Signs: x grows towards the drive; a node that slips towards the drive (+1) has less tension on the
load's side. Where the net tension is negative (a pair of antagonistic tendons seen as one),
friction follows its magnitude.
"""

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.slip.ends import (
    friction_at_load,
    load_law,
    revise_ends,
    start_of_drive,
)
from tsas_cli.physics.slip.nodes import (
    expect,
    is_straight,
    pulled_loose,
    set_friction,
    set_slides,
    slid_back,
)
from tsas_cli.physics.slip.state import (
    BRISTLE,
    DISPLACEMENT,
    GIVE,
    PASSES,
    SLIP,
    SPRING,
    TAKES,
    X_OLD,
    Boundary,
    Floats,
    Laws,
    Moment,
    P,
    Q,
    R,
    T,
    X,
)

TOGETHER = 16  # nodes that share a division
MOST_AT_ONCE = 20  # revisions of the slipping set
MOST_ONE_BY_ONE = 5  # more, for each node


@kernel
def settle(chain: Floats, now: Moment, boundary: Boundary, laws: Laws, scale: float) -> bool:
    """Find the slipping nodes at a moment; return whether the set was found."""
    n = laws.n
    if not is_straight(laws):
        expect(chain, laws)
    set_friction(chain, now, laws)
    set_slides(chain, now, laws)
    for revision in range(MOST_AT_ONCE + MOST_ONE_BY_ONE * n):
        sweep_to_drive(chain, now, boundary, laws)
        sweep_to_load(chain, now, boundary, laws)
        if laws.friction_exponent != 0.0:
            set_friction(chain, now, laws)
        most = n if revision < MOST_AT_ONCE else 1  # one by one ends where all at once cycle
        wrong = laws.presliding_mm == 0.0 and revise(chain, now, laws, scale, most) > 0
        wrong = set_slides(chain, now, laws) or wrong
        if not wrong or most == n:
            wrong = revise_ends(chain, now, boundary, laws, scale) or wrong
        if not wrong:
            return True
    return False


@kernel
def sweep_to_drive(chain: Floats, now: Moment, boundary: Boundary, laws: Laws) -> None:
    """Write each segment's tension as (p x + q)/r of the node before it, from the load on."""
    last = laws.n + 1
    guide = friction_at_load(boundary, laws)
    give, F0 = chain[GIVE + laws.n], laws.preload_N
    if boundary.load == DISPLACEMENT:
        p, q, r = 1.0, give * F0 - now.load, give
    elif chain[SLIP + last] == 0.0 and guide > 0.0:
        p, q, r = 1.0, give * F0 - chain[X_OLD + last], give
    else:
        p, q = load_law(chain, now, laws) if boundary.load == SPRING else (0.0, now.load)
        q += chain[SLIP + last] * guide + p * give * F0
        r = 1.0 + p * give
    chain[P + laws.n], chain[Q + laws.n], chain[R + laws.n] = p, q, r
    if laws.presliding_mm > 0.0:
        pass_leaning(chain, p, q, r, laws)
    else:
        pass_sliding(chain, p, q, r, laws)


@kernel
def pass_sliding(chain: Floats, p: float, q: float, r: float, laws: Laws) -> None:
    """Go on to the drive over nodes that slip or stick."""
    F0 = laws.preload_N
    for k in range(laws.n):
        i = laws.n - k  # node i, then the segment before it
        give = chain[GIVE + i - 1]
        if chain[SLIP + i] == 0.0:
            p, q, r = 1.0, give * F0 - chain[X_OLD + i], give
        else:
            pull = p * give
            q += chain[TAKES + i] * r + pull * F0
            r = chain[PASSES + i] * r + pull
        chain[P + i - 1], chain[Q + i - 1], chain[R + i - 1] = p, q, r


@kernel
def pass_leaning(chain: Floats, p: float, q: float, r: float, laws: Laws) -> None:
    """Go on to the drive over nodes on bristles, which all slide."""
    F0 = laws.preload_N
    for k in range(laws.n):
        i = laws.n - k
        if k % TOGETHER == 0:  # without any division they would outgrow a float
            p, q, r = p / r, q / r, 1.0
        p += chain[BRISTLE + i] * r
        pull = p * chain[GIVE + i - 1]
        q += chain[TAKES + i] * r + pull * F0
        r = chain[PASSES + i] * r + pull
        chain[P + i - 1], chain[Q + i - 1], chain[R + i - 1] = p, q, r


@kernel
def sweep_to_load(chain: Floats, now: Moment, boundary: Boundary, laws: Laws) -> None:
    """Find positions and tensions, from the drive on."""
    n, last = laws.n, laws.n + 1
    chain[X] = start_of_drive(chain, now, boundary, laws)
    if laws.presliding_mm > 0.0:
        place_leaning(chain, laws)
    else:
        place_sliding(chain, laws)
    chain[X + last] = chain[X + n] - chain[GIVE + n] * (chain[T + n] - laws.preload_N)
    if boundary.load == DISPLACEMENT:
        chain[X + last] = now.load
    elif chain[SLIP + last] == 0.0 and friction_at_load(boundary, laws) > 0.0:
        chain[X + last] = chain[X_OLD + last]


@kernel
def place_sliding(chain: Floats, laws: Laws) -> None:
    """Find places and tensions of nodes that slip or stick."""
    chain[T] = (chain[P] * chain[X] + chain[Q]) / chain[R]
    for i in range(1, laws.n + 1):
        if chain[SLIP + i] != 0.0:
            drawn = chain[GIVE + i - 1] * (chain[T + i - 1] - laws.preload_N)
            chain[X + i] = chain[X + i - 1] - drawn
            chain[T + i] = chain[PASSES + i] * chain[T + i - 1] - chain[TAKES + i]
        else:
            chain[X + i] = chain[X_OLD + i]
            chain[T + i] = (chain[P + i] * chain[X + i] + chain[Q + i]) / chain[R + i]


@kernel
def place_leaning(chain: Floats, laws: Laws) -> None:
    """Find places and tensions of nodes on bristles; only the places follow from each other."""
    for j in range(laws.n + 1):
        inverse = 1.0 / chain[R + j]
        chain[P + j] *= inverse
        chain[Q + j] *= inverse
        chain[R + j] = 1.0
    place = chain[X]
    for i in range(1, laws.n + 1):
        give = chain[GIVE + i - 1]
        place = (1.0 - give * chain[P + i - 1]) * place + give * (laws.preload_N - chain[Q + i - 1])
        chain[X + i] = place
    for j in range(laws.n + 1):
        chain[T + j] = chain[P + j] * chain[X + j] + chain[Q + j]


@kernel
def revise(chain: Floats, now: Moment, laws: Laws, scale: float, most: int) -> int:
    """Free the nodes whose tensions exceed their friction, hold those that slip backwards.

    Returns how many nodes it revised, at most so many, from the drive on.
    """
    n = laws.n
    loss = now.viscous_N / n
    revised = 0
    for i in range(1, n + 1):
        before = chain[SLIP + i]
        if before == 0.0:
            chain[SLIP + i] = pulled_loose(i, loss, chain)
        elif slid_back(i, chain, scale):
            chain[SLIP + i] = 0.0
        if chain[SLIP + i] != before:
            revised += 1
            if revised == most:
                break
    return revised
