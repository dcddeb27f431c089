"""One static problem of the slip chain: active set, positions and tensions.

For a given active set the chain is a sequence of affine relations. From the load backwards each
segment's tension is T = (p x + q)/r with the position x of the node before it: a sliding node
multiplies (and adds its pre-sliding), a sticking node restarts the recursion, a segment adds its
compliance. From the drive forwards the positions follow. No sweep waits for a division at every
node, and none is unstable: p and r are positive. Then every node is checked against its own law
(`nodes`): those that violate it enter or leave the active set of those that slip, and nonlinear
laws get a new tangent (a semi-smooth Newton method).

Signs: x grows towards the drive; a node that slips towards the drive (+1) has less tension on the
load's side. Where the net tension is negative (a pair of antagonistic tendons modelled as one),
friction follows its magnitude.
"""

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import DISPLACEMENT, moving_friction
from tsas_cli.physics.slip import state as at
from tsas_cli.physics.slip.ends import drive_position, pull_at_load, update_ends
from tsas_cli.physics.slip.nodes import (
    breakaway,
    extrapolate,
    is_linear,
    set_friction,
    set_lengths,
    slip_after_backwards,
    slips_backwards,
    update_relations,
)
from tsas_cli.physics.slip.state import Moment, SlipLaws
from tsas_cli.support.arrays import Floats

NODES_PER_DIVISION = 16  # in the elimination with presliding
MOST_ITERATIONS = 20  # changes of the active set
MOST_REVERSALS = 20  # further ones, with nodes that reverse without a step at rest
MOST_SINGLE_CHANGES = 5  # further ones, for each node


@kernel
def solve_sample(chain: Floats, now: Moment, laws: SlipLaws) -> bool:
    """Solve the static problem at a moment; return whether it converged."""
    n = laws.n
    if not is_linear(laws):
        extrapolate(chain, laws)
    set_friction(chain, now, laws)
    set_lengths(chain, now, laws)
    update_relations(chain, now, laws)
    sticks = laws.presliding.length_mm == 0.0
    for iteration in range(most_iterations(n)):
        sweep_to_drive(chain, now, laws)
        sweep_to_load(chain, now, laws)
        if laws.friction_exponent != 0.0:
            set_friction(chain, now, laws)
        if laws.bristle_mm_per_N > 0.0:
            set_lengths(chain, now, laws)
        limit, reverse = changes_at(iteration, n)
        unsolved = sticks and update_active_set(chain, now, laws, limit, reverse) > 0
        unsolved = update_relations(chain, now, laws) or unsolved
        if not unsolved or limit == n:
            unsolved = update_ends(chain, now, laws) or unsolved
        if not unsolved:
            return True
    return False


@kernel
def most_iterations(n: int) -> int:
    """Return after how many iterations a problem of n nodes counts as not converged."""
    return MOST_ITERATIONS + MOST_SINGLE_CHANGES * n + MOST_REVERSALS


@kernel
def changes_at(iteration: int, n: int) -> tuple[int, bool]:
    """Return how many nodes may change in an iteration, and whether they reverse without a rest.

    One by one ends where all at once cycle, but for nodes with little friction.
    """
    reverse = iteration >= MOST_ITERATIONS + MOST_SINGLE_CHANGES * n
    return n if reverse or iteration < MOST_ITERATIONS else 1, reverse


@kernel
def sweep_to_drive(chain: Floats, now: Moment, laws: SlipLaws) -> None:
    """Write each segment's tension as (p x + q)/r of the node before it, from the load on."""
    last = laws.n + 1
    guide = moving_friction(laws.load)
    compliance, F0 = chain[at.COMPLIANCE + laws.n], laws.preload_N
    if laws.load.given == DISPLACEMENT:
        p, q, r = 1.0, compliance * F0 - now.load, compliance
    elif chain[at.SLIP + last] == 0.0 and guide > 0.0:
        p, q, r = 1.0, compliance * F0 - chain[at.POSITION_BEFORE + last], compliance
    else:
        p, q = pull_at_load(chain, now, laws)
        q += chain[at.SLIP + last] * guide + p * compliance * F0
        r = 1.0 + p * compliance
    chain[at.SWEEP_P + laws.n], chain[at.SWEEP_Q + laws.n], chain[at.SWEEP_R + laws.n] = p, q, r
    if laws.presliding.length_mm > 0.0:
        eliminate_presliding(chain, p, q, r, laws)
    else:
        eliminate_sliding(chain, p, q, r, laws)


@kernel
def eliminate_sliding(chain: Floats, p: float, q: float, r: float, laws: SlipLaws) -> None:
    """Sweep to the drive over nodes that slip or stick."""
    F0 = laws.preload_N
    for k in range(laws.n):
        i = laws.n - k  # node i, then the segment before it
        compliance = chain[at.COMPLIANCE + i - 1]
        if chain[at.SLIP + i] == 0.0:
            p, q, r = 1.0, compliance * F0 - chain[at.POSITION_BEFORE + i], compliance
        else:
            pull = p * compliance
            q += chain[at.DROP + i] * r + pull * F0
            r = chain[at.FACTOR + i] * r + pull
        chain[at.SWEEP_P + i - 1], chain[at.SWEEP_Q + i - 1], chain[at.SWEEP_R + i - 1] = p, q, r


@kernel
def eliminate_presliding(chain: Floats, p: float, q: float, r: float, laws: SlipLaws) -> None:
    """Sweep to the drive over nodes with presliding, which all slide."""
    F0 = laws.preload_N
    for k in range(laws.n):
        i = laws.n - k
        if k % NODES_PER_DIVISION == 0:  # without any division they would outgrow a float
            p, q, r = p / r, q / r, 1.0
        p += chain[at.DROP_SLOPE + i] * r
        pull = p * chain[at.COMPLIANCE + i - 1]
        q += chain[at.DROP + i] * r + pull * F0
        r = chain[at.FACTOR + i] * r + pull
        chain[at.SWEEP_P + i - 1], chain[at.SWEEP_Q + i - 1], chain[at.SWEEP_R + i - 1] = p, q, r


@kernel
def sweep_to_load(chain: Floats, now: Moment, laws: SlipLaws) -> None:
    """Set positions and tensions, from the drive on."""
    n, last = laws.n, laws.n + 1
    chain[at.POSITION] = drive_position(chain, now, laws)
    if laws.presliding.length_mm > 0.0:
        substitute_presliding(chain, laws)
    else:
        substitute_sliding(chain, laws)
    chain[at.POSITION + last] = chain[at.POSITION + n] - chain[at.COMPLIANCE + n] * (
        chain[at.TENSION + n] - laws.preload_N
    )
    if laws.load.given == DISPLACEMENT:
        chain[at.POSITION + last] = now.load
    elif chain[at.SLIP + last] == 0.0 and moving_friction(laws.load) > 0.0:
        chain[at.POSITION + last] = chain[at.POSITION_BEFORE + last]


@kernel
def substitute_sliding(chain: Floats, laws: SlipLaws) -> None:
    """Set positions and tensions of nodes that slip or stick."""
    chain[at.TENSION] = (chain[at.SWEEP_P] * chain[at.POSITION] + chain[at.SWEEP_Q]) / chain[
        at.SWEEP_R
    ]
    for i in range(1, laws.n + 1):
        if chain[at.SLIP + i] != 0.0:
            elongation = chain[at.COMPLIANCE + i - 1] * (chain[at.TENSION + i - 1] - laws.preload_N)
            chain[at.POSITION + i] = chain[at.POSITION + i - 1] - elongation
            chain[at.TENSION + i] = (
                chain[at.FACTOR + i] * chain[at.TENSION + i - 1] - chain[at.DROP + i]
            )
        else:
            chain[at.POSITION + i] = chain[at.POSITION_BEFORE + i]
            chain[at.TENSION + i] = (
                chain[at.SWEEP_P + i] * chain[at.POSITION + i] + chain[at.SWEEP_Q + i]
            ) / chain[at.SWEEP_R + i]


@kernel
def substitute_presliding(chain: Floats, laws: SlipLaws) -> None:
    """Set positions and tensions of nodes with presliding; positions alone are a recursion."""
    for j in range(laws.n + 1):
        inverse = 1.0 / chain[at.SWEEP_R + j]
        chain[at.SWEEP_P + j] *= inverse
        chain[at.SWEEP_Q + j] *= inverse
        chain[at.SWEEP_R + j] = 1.0
    position = chain[at.POSITION]
    for i in range(1, laws.n + 1):
        compliance = chain[at.COMPLIANCE + i - 1]
        position = (1.0 - compliance * chain[at.SWEEP_P + i - 1]) * position + compliance * (
            laws.preload_N - chain[at.SWEEP_Q + i - 1]
        )
        chain[at.POSITION + i] = position
    for j in range(laws.n + 1):
        chain[at.TENSION + j] = (
            chain[at.SWEEP_P + j] * chain[at.POSITION + j] + chain[at.SWEEP_Q + j]
        )


@kernel
def update_active_set(chain: Floats, now: Moment, laws: SlipLaws, limit: int, reverse: bool) -> int:
    """Update the active set: nodes beyond their friction slip, others stick or reverse.

    Returns the number of changed nodes, at most `limit`, from the drive on.
    """
    n = laws.n
    loss = now.losses.drag_N / n
    changed = 0
    for i in range(1, n + 1):
        before = chain[at.SLIP + i]
        if before == 0.0:
            chain[at.SLIP + i] = breakaway(i, loss, chain)
        elif slips_backwards(i, chain, laws):
            chain[at.SLIP + i] = slip_after_backwards(i, loss, chain) if reverse else 0.0
        if chain[at.SLIP + i] != before:
            changed += 1
            if changed == limit:
                break
    return changed
