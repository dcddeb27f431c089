"""What a solved sample of the slip chain gives: its phase, and the forces at the sensors."""

from tsas_cli.effects.antagonist import net_force
from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import DISPLACEMENT, FORCE, moving_friction
from tsas_cli.physics.phases import SLACK
from tsas_cli.physics.slip import state as at
from tsas_cli.physics.slip.ends import load_force, tension_of_second
from tsas_cli.physics.slip.state import Moment, SlipLaws
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
