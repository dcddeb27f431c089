"""What the dynamic chain says along the tendon at chosen samples: read off a step's cubics."""

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.frames import Frames, slips_up_to
from tsas_cli.physics.lugre.input import hermite
from tsas_cli.physics.lugre.state import (
    DEFLECTION_NEW,
    LIMIT,
    RATE,
    STIFFNESS,
    TENSION,
    Floats,
    LugreLaws,
)
from tsas_cli.physics.phases import SLACK, SLIDING_SHARE


@kernel
def sliding_direction(s: Floats, i: int, law: LugreLaws) -> int:
    """Return +1 or −1 where a lump's bristles are at their limit, 0 where they are not."""
    longest = s[LIMIT + i] / law.bristle.stiffness + law.bristle.travel
    return int(s[DEFLECTION_NEW + i] > SLIDING_SHARE * longest) - int(
        s[DEFLECTION_NEW + i] < -SLIDING_SHARE * longest
    )


@kernel
def store_tensions(s: Floats, along: Floats, law: LugreLaws) -> None:
    """Note tensions and their rates after a step; those noted before become its beginning.

    `along` holds both for the beginning and for the end of the step, shape (4, n + 1) [N, N/s].
    """
    for j in range(law.n + 1):
        along[0, j], along[1, j] = along[2, j], along[3, j]
        along[2, j] = s[TENSION + j]
        along[3, j] = s[STIFFNESS + j] * (s[RATE + j] - s[RATE + j + 1])


@kernel
def write_along(
    frames: Frames,
    taken: int,
    times: Floats,
    last: int,
    t: float,
    h: float,
    s: Floats,
    along: Floats,
    law: LugreLaws,
) -> int:
    """Write the frames up to a sample, in the step h that begins at t; return how many are written.

    Whether a lump slides is that of the step's end.
    """
    while taken < frames.samples.size and frames.samples[taken] <= last:
        part = (times[frames.samples[taken]] - t) / h
        for j in range(law.n + 1):
            frames.tension_N[taken, j] = hermite(
                part, h, along[0, j], along[1, j], along[2, j], along[3, j]
            )
        for i in range(law.n):
            frames.slip[taken, i] = sliding_direction(s, i + 1, law)
        frames.front[taken] = slips_up_to(frames, taken)
        taken += 1
    return taken


@kernel
def write_slack_frames(frames: Frames, taken: int, last: int) -> int:
    """Write the frames of a slack tendon up to a sample; return how many are written."""
    while taken < frames.samples.size and frames.samples[taken] <= last:
        frames.tension_N[taken, :] = 0.0
        frames.slip[taken, :] = SLACK
        frames.front[taken] = 0.0
        taken += 1
    return taken
