"""One static problem of a tendon and its antagonist, which share the pulleys of drive and load.

Each tendon is a slip chain with the sweeps and the active set of `step`. The second one lies behind
the first as one loop does: its node 0 is at the load, its last at the drive, and a motion of the
pulleys has one sign all along. Seen from the load it is a tension (p x + q)/r of the load's
position x, as any segment of a chain; the first tendon's sweep starts from the load with it, so
that both are solved at once. Where a tendon would be pressed it is slack and pulls at nothing.

With a force given at the drive the position there is found by two solutions of the same active
set, in between which all tensions are affine.
"""

from tsas_cli.effects.antagonist import is_taut, net_force
from tsas_cli.numerics.compiled import kernel, seldom_kernel
from tsas_cli.physics.boundary import DISPLACEMENT, free_drive, moving_friction
from tsas_cli.physics.course import Losses
from tsas_cli.physics.slip import state as at
from tsas_cli.physics.slip.ends import (
    drive_tangent,
    pull_at_load,
    tension_of_second,
    update_ends,
)
from tsas_cli.physics.slip.nodes import (
    accept,
    extrapolate,
    is_linear,
    set_friction,
    set_lengths,
    update_relations,
    update_speeds,
)
from tsas_cli.physics.slip.state import Moment, SlipLaws, laws_of_second, with_drive
from tsas_cli.physics.slip.step import (
    changes_at,
    most_iterations,
    sweep_to_drive,
    sweep_to_load,
    update_active_set,
)
from tsas_cli.support.arrays import Floats


@seldom_kernel
def solve_pair(chain: Floats, now: Moment, laws: SlipLaws) -> bool:
    """Solve the static problem of both tendons at a moment; return whether it converged."""
    n = laws.n
    second, own, mirrored = chain[at.SECOND :], laws_of_second(laws), seen_by_second(now, laws)
    chain[at.FIRST_IS_SLACK], second[at.IS_SLACK] = chain[at.FIRST_WAS_SLACK], second[at.WAS_SLACK]
    begin(chain, now, laws)
    begin(second, mirrored, own)
    for iteration in range(most_iterations(2 * n)):
        set_both_in_motion(chain, now, laws)
        limit, reverse = changes_at(iteration, 2 * n)
        unsolved = update_slack(chain, at.FIRST_IS_SLACK, at.FIRST_WAS_SLACK, chain, laws)
        unsolved = update_slack(second, at.IS_SLACK, at.WAS_SLACK, chain, own) or unsolved
        if chain[at.FIRST_IS_SLACK] == 0.0:
            unsolved = update_nodes(chain, now, laws, limit, reverse) or unsolved
        if second[at.IS_SLACK] == 0.0:
            unsolved = update_nodes(second, mirrored, own, limit, reverse) or unsolved
        if not unsolved or limit > 1:
            unsolved = update_ends(chain, felt_at_drive(chain, now, laws), laws) or unsolved
        if not unsolved:
            return True
    return False


@kernel
def seen_by_second(now: Moment, laws: SlipLaws) -> Moment:
    """Return a moment with the losses of the second tendon, which is released where x rises."""
    losses, ratio = now.losses, laws.antagonist.friction_ratio
    own = Losses(ratio * losses.released, ratio * losses.pulled, losses.drag_N, 0.0)
    return Moment(now.drive, now.load, own, now.step_s)


@seldom_kernel
def begin(tendon: Floats, now: Moment, laws: SlipLaws) -> None:
    """Set a tendon's relations before the first iteration."""
    if not is_linear(laws):
        extrapolate(tendon, laws)
    set_friction(tendon, now, laws)
    set_lengths(tendon, now, laws)
    update_relations(tendon, now, laws)


@seldom_kernel
def update_nodes(tendon: Floats, now: Moment, laws: SlipLaws, limit: int, reverse: bool) -> bool:
    """Update a tendon's active set and relations; return whether any changed."""
    if laws.friction_exponent != 0.0:
        set_friction(tendon, now, laws)
    if laws.bristle_mm_per_N > 0.0:
        set_lengths(tendon, now, laws)
    sticks = laws.presliding.length_mm == 0.0
    changed = sticks and update_active_set(tendon, now, laws, limit, reverse) > 0
    return update_relations(tendon, now, laws) or changed


@kernel
def set_both_in_motion(chain: Floats, now: Moment, laws: SlipLaws) -> None:
    """Set positions and tensions of both tendons for their active sets."""
    driven = with_drive(laws, free_drive(DISPLACEMENT))
    if laws.drive.given == DISPLACEMENT:
        sweep_both(chain, now.drive, now, driven)
        return
    if chain[at.SLIP] == 0.0 and laws.drive.friction_N > 0.0:
        sweep_both(chain, chain[at.POSITION_BEFORE], now, driven)
        return
    x = chain[at.POSITION]
    sweep_both(chain, x, now, driven)
    here = excess_at_drive(chain, now, laws)
    sweep_both(chain, x + laws.scale_mm, now, driven)
    rise = excess_at_drive(chain, now, laws) - here
    if rise > 0.0:  # else both are slack and nothing holds the drive
        sweep_both(chain, x - here * laws.scale_mm / rise, now, driven)


@kernel
def felt_at_drive(chain: Floats, now: Moment, laws: SlipLaws) -> Moment:
    """Return the moment with the force that the first tendon and what is beside it hold [N]."""
    share = laws.antagonist.f_in_share
    force = net_force(now.drive, tension_of_second(chain, laws.n, laws), -share)
    return Moment(force, now.load, now.losses, now.step_s)


@kernel
def excess_at_drive(chain: Floats, now: Moment, laws: SlipLaws) -> float:
    """Return by how much the drive holds more than the given force [N]."""
    slope, value = drive_tangent(chain, now, laws)
    held = (
        chain[at.TENSION]
        + slope * chain[at.POSITION]
        + value
        + chain[at.SLIP] * laws.drive.friction_N
    )
    return float(held - felt_at_drive(chain, now, laws).drive)


@seldom_kernel
def sweep_both(chain: Floats, x_in: float, now: Moment, driven: SlipLaws) -> None:
    """Set positions and tensions of both tendons for a position of the drive [mm]."""
    last = driven.n + 1
    second, own, losses = chain[at.SECOND :], laws_of_second(driven), now.losses
    if second[at.IS_SLACK] == 0.0:
        eliminate(second, Moment(0.0, x_in, losses, now.step_s), own)
    if chain[at.FIRST_IS_SLACK] == 0.0:
        first = Moment(x_in, now.load, losses, now.step_s)
        eliminate(chain, first, driven)
        substitute(chain, first, driven)
    else:
        hang(chain, x_in, load_without_first(chain, now, driven), driven.n)
    x_out = chain[at.POSITION + last]
    if second[at.IS_SLACK] == 0.0:
        substitute(second, Moment(x_out, x_in, losses, now.step_s), own)
    else:
        hang(second, x_out, x_in, driven.n)


@seldom_kernel
def eliminate(tendon: Floats, now: Moment, laws: SlipLaws) -> None:
    """Sweep over a tendon from its last node on."""
    sweep_to_drive(tendon, now, laws)


@seldom_kernel
def substitute(tendon: Floats, now: Moment, laws: SlipLaws) -> None:
    """Set positions and tensions of a tendon, from its first node on."""
    sweep_to_load(tendon, now, laws)


@kernel
def load_without_first(chain: Floats, now: Moment, laws: SlipLaws) -> float:
    """Return the position of the load where the first tendon is slack [mm]."""
    last, guide = laws.n + 1, moving_friction(laws.load)
    if laws.load.given == DISPLACEMENT:
        return now.load
    if chain[at.SLIP + last] == 0.0 and guide > 0.0:
        return float(chain[at.POSITION_BEFORE + last])
    slope, value = pull_at_load(chain, now, laws)
    if slope <= 0.0:  # both are slack, and no spring holds the load
        return float(chain[at.POSITION_BEFORE + last])
    return float(-(value + chain[at.SLIP + last] * guide) / slope)


@kernel
def hang(tendon: Floats, x_first: float, x_last: float, n: int) -> None:
    """Set a slack tendon between the positions of its ends [mm]."""
    tendon[at.POSITION], tendon[at.POSITION + n + 1] = x_first, x_last
    for j in range(n + 1):
        tendon[at.TENSION + j] = 0.0


@kernel
def update_slack(
    tendon: Floats, is_slack: int, was_slack: int, chain: Floats, laws: SlipLaws
) -> bool:
    """Update whether a tendon is slack, by the positions of its ends; return whether it changed."""
    n = laws.n
    compliance = 0.0
    for j in range(n + 1):
        compliance += tendon[at.COMPLIANCE + j]
    taut = is_taut(tendon[at.POSITION] - tendon[at.POSITION + n + 1], compliance, laws.preload_N)
    if taut == (tendon[is_slack] == 0.0):
        return False
    tendon[is_slack] = 0.0 if taut else 1.0
    if taut and tendon[was_slack] != 0.0:
        lay(tendon, chain[at.POSITION] - chain[at.POSITION_BEFORE], laws)
    return True


@seldom_kernel
def lay(tendon: Floats, moved: float, laws: SlipLaws) -> None:
    """Lay a tendon taut without tension, about to be pulled along by a motion of the drive."""
    n, last = laws.n, laws.n + 1
    direction = 1.0 if moved > 0.0 else -1.0
    x = tendon[at.POSITION_BEFORE + last] if moved > 0.0 else tendon[at.POSITION_BEFORE]
    for k in range(1, n + 1):
        i = last - k if moved > 0.0 else k
        shorter = tendon[at.COMPLIANCE + (i if moved > 0.0 else i - 1)] * laws.preload_N
        x -= direction * shorter
        tendon[at.POSITION + i] = tendon[at.POSITION_BEFORE + i] = x
    for j in range(n + 2):
        tendon[at.TENSION + j] = tendon[at.TENSION_BEFORE + j] = 0.0
        tendon[at.TRAVEL + j] = tendon[at.TENSION_RISE + j] = 0.0
        tendon[at.SHARE_BEFORE + j] = direction
    for i in range(1, n + 1):
        tendon[at.SLIP + i] = direction


@seldom_kernel
def accept_pair(chain: Floats, now: Moment, laws: SlipLaws) -> None:
    """Accept the present state of both tendons as the solution of the step."""
    second, own = chain[at.SECOND :], laws_of_second(laws)
    moved = chain[at.POSITION] - chain[at.POSITION_BEFORE]
    update_speeds(second, now.step_s, own)
    accept(chain, laws)
    accept(second, own)
    chain[at.FIRST_WAS_SLACK], second[at.WAS_SLACK] = chain[at.FIRST_IS_SLACK], second[at.IS_SLACK]
    if chain[at.FIRST_IS_SLACK] != 0.0:
        lay(chain, moved, laws)
    if second[at.IS_SLACK] != 0.0:
        lay(second, moved, own)
