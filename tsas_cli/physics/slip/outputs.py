"""A solved sample of the slip chain: its phase, the forces at the sensors, profiles along it."""

from tsas_cli.effects.antagonist import net_force
from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import DISPLACEMENT, FORCE, moving_friction
from tsas_cli.physics.frames import Frames, is_next, slips_up_to
from tsas_cli.physics.phases import SLACK, UNCONVERGED
from tsas_cli.physics.slip import state as at
from tsas_cli.physics.slip.ends import load_force, tension_of_second
from tsas_cli.physics.slip.state import SLIP, TENSION, Moment, SlipLaws
from tsas_cli.support.arrays import Floats


@kernel
def phase_of(chain: Floats, laws: SlipLaws) -> int:
    """Return +1 or −1 where all nodes of the sheaths slip in that direction, 2 slack, else 0."""
    n, first, paired = laws.n, chain[at.SLIP + 1], laws.antagonist.preload_N > 0.0
    if paired and chain[at.FIRST_IS_SLACK] != 0.0:
        return SLACK
    for i in range(2, n + 1):
        if chain[at.SLIP + i] != first:
            return 0
    if paired and chain[at.SECOND + at.IS_SLACK] == 0.0:
        for i in range(1, n + 1):
            if chain[at.SECOND + at.SLIP + i] != first:
                return 0
    return int(first)


@kernel
def tension_at_drive(chain: Floats, laws: SlipLaws) -> float:
    """Return the tension at the drive's force sensor [N], an antagonist's share subtracted."""
    second_N = tension_of_second(chain, laws.n, laws)
    return net_force(chain[at.TENSION], second_N, laws.antagonist.f_in_share)


@kernel
def tension_at_sensor(chain: Floats, now: Moment, laws: SlipLaws) -> float:
    """Return the force of the load [N]: the tension less an antagonist's and less friction."""
    n = laws.n
    if laws.load.given == FORCE:
        return now.load
    second_N = tension_of_second(chain, 0, laws)
    tension = net_force(chain[at.TENSION + n], second_N, 1.0)
    before = laws.load.friction.before_sensor_N
    if before == 0.0:
        return tension
    if laws.load.given == DISPLACEMENT:
        return float(tension - chain[at.SLIP + n + 1] * before)
    share = before / moving_friction(laws.load)
    return float(tension - share * (chain[at.TENSION + n] - load_force(chain, now, laws)))


@kernel
def write_frame(frames: Frames, written: int, i: int, chain: Floats, n: int, phase: int) -> int:
    """Write the chain at sample i, if it is a frame's; return how many frames are written."""
    if not is_next(frames, written, i):
        return written
    for j in range(n + 1):
        frames.tension_N[written, j] = chain[TENSION + j]
    for j in range(n):
        frames.slip[written, j] = phase if phase in (SLACK, UNCONVERGED) else chain[SLIP + j + 1]
    frames.front[written] = slips_up_to(frames, written)
    return written + 1
