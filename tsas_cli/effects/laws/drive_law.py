"""A force at the drive depends on its displacement, by a law of unnamed origin.

What one sees: a residual of f_in that repeats with the displacement of the drive: with its place,
and with the travel since its reversals; f_out and x_out have none of it.
Equation: f_in = T + (1 + speed(ln|v|))·(Σ (friction_k + share_k·T)·s_k + Σ (gap_friction_k +
gap_share_k·T)·g_k) + curve(x), T the tension of the tendon, s_k the stop operator of width
travel·4^(1−k) on the displacement of the motor where its angle was recorded, else of the drive, g_k
that of width travel·2^(1−k) whose spring is loose over half of it, v the speed of that
displacement: generalised Maxwell slip (Al-Bender, Lampaert and Swevers 2005). With weights that are
not negative its elements only dissipate at a steady speed. The paper has none.
Mistaken for: a cause. A law describes what no proven cause explains: friction, lost motion or
springs at the drive, and whatever else acts there.
Not validated: displacements, tensions and speeds beyond those that it was fitted to.
"""

from typing import NamedTuple

import numpy as np

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.stops import (
    ELEMENTS,
    GAPS,
    beyond_gap,
    curve_of,
    speed_curve,
    states_of,
    widths_of,
    widths_with_gaps,
)
from tsas_cli.support.arrays import Floats


class DriveLaw(NamedTuple):
    """Longest width, ranges of place and speed; weights of the elements; heights of the curves."""

    travel_mm: float = 1.0
    low_mm: float = 0.0
    high_mm: float = 1.0
    slow_mm_per_s: float = 1.0
    fast_mm_per_s: float = 10.0
    friction_1_N: float = 0.0
    friction_2_N: float = 0.0
    friction_3_N: float = 0.0
    friction_4_N: float = 0.0
    friction_5_N: float = 0.0
    friction_6_N: float = 0.0
    share_1: float = 0.0
    share_2: float = 0.0
    share_3: float = 0.0
    share_4: float = 0.0
    share_5: float = 0.0
    share_6: float = 0.0
    gap_friction_1_N: float = 0.0
    gap_friction_2_N: float = 0.0
    gap_friction_3_N: float = 0.0
    gap_friction_4_N: float = 0.0
    gap_share_1: float = 0.0
    gap_share_2: float = 0.0
    gap_share_3: float = 0.0
    gap_share_4: float = 0.0
    curve_1_N: float = 0.0
    curve_2_N: float = 0.0
    curve_3_N: float = 0.0
    curve_4_N: float = 0.0
    curve_5_N: float = 0.0
    speed_2: float = 0.0
    speed_3: float = 0.0


FIRST = 5  # of the weights
LAST = FIRST + 2 * (ELEMENTS + GAPS)


def drive_law_force(
    law: DriveLaw, x: Floats, moved: Floats, speed: Floats, tension: Floats, memory: Floats
) -> Floats:
    """Return the force beside the tendon at each sample [N], from arrays of shape (n,).

    `moved` is the displacement that the elements follow, `speed` its speed; `memory` is that of the
    elements, updated in place.
    """
    widths = np.concatenate((widths_of(law.travel_mm), widths_with_gaps(law.travel_mm)))
    states = states_of(moved, widths, memory)
    states[ELEMENTS:] = beyond_gap(states[ELEMENTS:])
    friction, share, gap_friction, gap_share = np.split(
        np.array(law[FIRST:LAST]), (ELEMENTS, 2 * ELEMENTS, 2 * ELEMENTS + GAPS)
    )
    force: Floats = np.concatenate((friction, gap_friction)) @ states
    force += (np.concatenate((share, gap_share)) @ states) * tension
    force *= 1.0 + speed_curve(speed, law.slow_mm_per_s, law.fast_mm_per_s, law[-2:])
    return force + curve_of(x, law.low_mm, law.high_mm, law[LAST:-2])


DRIVE_LAW = Effect(
    name="drive_law",
    title="Force at the drive, of unnamed origin",
    acts_on="drive",
    closed_form=True,
    equation="f_in = T + (1 + speed(ln|v|))·(Σ (friction_k + share_k·T)·s_k + "
    "Σ (gap_friction_k + gap_share_k·T)·g_k) + curve(x)",
    doc=__doc__,
    parameters=(
        Parameter("travel_mm", "mm", 1.0, 1.0, 1e-6, 1e4, given=True),
        Parameter("low_mm", "mm", 0.0, 0.0, -1e5, 1e5, given=True),
        Parameter("high_mm", "mm", 1.0, 1.0, -1e5, 1e5, given=True),
        Parameter("slow_mm_per_s", "mm/s", 1.0, 1.0, 1e-9, 1e5, given=True),
        Parameter("fast_mm_per_s", "mm/s", 10.0, 10.0, 1e-9, 1e5, given=True),
        *(Parameter(f"friction_{k}_N", "N", 0.0, 1.0, 0.0, 1e6) for k in range(1, 7)),
        *(Parameter(f"share_{k}", "1", 0.0, 0.1, 0.0, 1.0) for k in range(1, 7)),
        *(Parameter(f"gap_friction_{k}_N", "N", 0.0, 1.0, 0.0, 1e6) for k in range(1, 5)),
        *(Parameter(f"gap_share_{k}", "1", 0.0, 0.1, 0.0, 1.0) for k in range(1, 5)),
        *(Parameter(f"curve_{k}_N", "N", 0.0, 1.0, -1e6, 1e6) for k in range(1, 6)),
        *(Parameter(f"speed_{k}", "1", 0.0, 0.1, -1.0, 10.0) for k in range(2, 4)),
    ),
    experiment="Nested strokes of the drive without the tendon: what f_in reads is this law alone.",
)
