"""What the slip chain says along the tendon at chosen samples: its state, written down."""

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.frames import Frames, is_next, slips_up_to
from tsas_cli.physics.phases import SLACK, UNCONVERGED
from tsas_cli.physics.slip.state import SLIP, TENSION, Floats


@kernel
def write_frame(frames: Frames, taken: int, i: int, chain: Floats, n: int, phase: int) -> int:
    """Write down the chain at sample i, if it is to be; return how many frames are written."""
    if not is_next(frames, taken, i):
        return taken
    for j in range(n + 1):
        frames.tension_N[taken, j] = chain[TENSION + j]
    for j in range(n):
        frames.slip[taken, j] = phase if phase in (SLACK, UNCONVERGED) else chain[SLIP + j + 1]
    frames.front[taken] = slips_up_to(frames, taken)
    return taken + 1
