"""Profiles along the dynamic chain at chosen samples, interpolated by a step's cubics."""

from typing import NamedTuple

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.course import TIME
from tsas_cli.physics.frames import Frames, slips_up_to
from tsas_cli.physics.lugre.ends import Span
from tsas_cli.physics.lugre.input import Cubic, hermite
from tsas_cli.physics.lugre.state import DEFLECTION_NEW, LIMIT, RATE, STIFFNESS, TENSION, LugreLaws
from tsas_cli.physics.phases import SLACK, SLIDING_SHARE
from tsas_cli.support.arrays import Floats


@kernel
def sliding_direction(s: Floats, i: int, laws: LugreLaws) -> int:
    """Return +1 or −1 where a lump's bristles are at their limit, 0 where they are not."""
    steady = s[LIMIT + i] / laws.lump.bristle.stiffness + laws.lump.bristle.travel
    return int(s[DEFLECTION_NEW + i] > SLIDING_SHARE * steady) - int(
        s[DEFLECTION_NEW + i] < -SLIDING_SHARE * steady
    )


class SegmentTensions(NamedTuple):
    """Tensions of the segments and their rates at both ends of a step, shape (n + 1,) [N, N/s]."""

    before: Floats
    rate_before: Floats
    now: Floats
    rate: Floats


@kernel
def empty_tensions(n: int) -> SegmentTensions:
    """Return room for the tensions of n + 1 segments."""
    return SegmentTensions(np.empty(n + 1), np.empty(n + 1), np.empty(n + 1), np.empty(n + 1))


@kernel
def store_tensions(s: Floats, along: SegmentTensions, laws: LugreLaws) -> None:
    """Store tensions and their rates after a step; the stored ones become those before it."""
    for j in range(laws.n + 1):
        along.before[j], along.rate_before[j] = along.now[j], along.rate[j]
        along.now[j] = s[TENSION + j]
        along.rate[j] = s[STIFFNESS + j] * (s[RATE + j] - s[RATE + j + 1])


@kernel
def write_along(
    frames: Frames,
    written: int,
    last: int,
    course: Floats,
    span: Span,
    along: SegmentTensions,
    s: Floats,
    laws: LugreLaws,
) -> int:
    """Write the frames up to a sample within a step; return how many are written.

    The slip state of a lump is that at the end of the step.
    """
    while written < frames.samples.size and frames.samples[written] <= last:
        part = (course[TIME, frames.samples[written]] - span.t) / span.h
        for j in range(laws.n + 1):
            ends = Cubic(along.before[j], along.rate_before[j], along.now[j], along.rate[j])
            frames.tension_N[written, j] = hermite(part, span.h, ends)
        for i in range(laws.n):
            frames.slip[written, i] = sliding_direction(s, i + 1, laws)
        frames.front[written] = slips_up_to(frames, written)
        written += 1
    return written


@kernel
def write_slack_frames(frames: Frames, written: int, last: int) -> int:
    """Write the frames of a slack tendon up to a sample; return how many are written."""
    while written < frames.samples.size and frames.samples[written] <= last:
        frames.tension_N[written, :] = 0.0
        frames.slip[written, :] = SLACK
        frames.front[written] = 0.0
        written += 1
    return written
