"""What the tendon's path loses by giving way: a loose clamp of the sheath, and creep.

Neither is in the catalogue of effects. Both follow the tension of the sample before, so
creep has to be slow beside the clock.
"""

from math import exp, inf
from typing import NamedTuple

from tsas_studies.challenge.rig.compiled import compiled


class Give(NamedTuple):
    """How the path gives way; zeros are a firm one."""

    # A loose clamp: the sheath jumps to a stop so far away when the tension at the drive exceeds
    # clamp_up_N, and back when it falls below clamp_down_N.
    clamp_step_mm: float = 0.0
    clamp_up_N: float = inf
    clamp_down_N: float = -inf
    # The tendon stretches further by so much per change of the tension, so slowly.
    creep_mm_per_N: float = 0.0
    creep_time_s: float = 1.0


class Path(NamedTuple):
    """How the path gives way, and what has been given so far [mm]: by the clamp and by creep."""

    give: Give
    jumped: float = 0.0
    crept: float = 0.0


@compiled
def given(path: Path, tension: float, preload: float, h: float) -> Path:
    """Return the path after h seconds at a tension of the drive's end [N]."""
    give, jumped = path.give, path.jumped
    if tension > give.clamp_up_N:
        jumped = give.clamp_step_mm
    elif tension < give.clamp_down_N:
        jumped = 0.0
    wanted = give.creep_mm_per_N * (tension - preload)
    crept = wanted + (path.crept - wanted) * exp(-h / give.creep_time_s)
    return Path(give, jumped, crept)
