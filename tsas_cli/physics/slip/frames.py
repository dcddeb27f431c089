"""Profiles along the slip chain at chosen samples."""

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.frames import Frames, is_next, slips_up_to
from tsas_cli.physics.phases import SLACK, UNCONVERGED
from tsas_cli.physics.slip.state import SLIP, TENSION
from tsas_cli.support.arrays import Floats


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
