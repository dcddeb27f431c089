"""A force at the drive depends on its displacement, by a law of unnamed origin.

What one sees: a residual of f_in that repeats with the displacement of the drive: with its place,
and with the travel since its reversals; f_out and x_out have none of it.
Equation: f_in = T + max(0, 1 + speed(ln|v|) + place(x))·(Σ (friction_k + share_k·T)·s_k +
Σ (gap_friction_k + gap_share_k·T)·g_k) + curve(x), T the tension of the tendon, s_k the stop
operator of width travel·4^(1−k) on the displacement of the motor where its angle was recorded, else
of the drive, g_k that of width travel·2^(1−k) whose spring is loose over half of it, v the speed of
that displacement, place 0 at the low end of the stroke: generalised Maxwell slip (Al-Bender,
Lampaert and Swevers 2005). With weights that are not negative its elements only dissipate at a
steady speed and an even place. The paper has none.
Mistaken for: a cause. A law describes what no proven cause explains: friction, lost motion or
springs at the drive, and whatever else acts there.
Not validated: displacements, tensions and speeds beyond those that it was fitted to.
"""

from typing import NamedTuple

import numpy as np

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.effects.laws import FAST, HIGH, LOW, SLOW
from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.stops import (
    ELEMENTS,
    GAPS,
    KNOTS,
    beyond_gap,
    curve_at,
    move_elements,
    place_curve_at,
    speed_curve_at,
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
    place_2: float = 0.0
    place_3: float = 0.0
    place_4: float = 0.0
    place_5: float = 0.0


FIRST = 5  # of the weights
LAST = FIRST + 2 * (ELEMENTS + GAPS)
SPEEDS = LAST + KNOTS  # of the factor of the elements, from the middle speed on
PLACES = SPEEDS + 2  # and over the place, from the second height on


def drive_law_widths(law: DriveLaw) -> Floats:
    """Return the widths of the elements, those with a gap last, shape (ELEMENTS + GAPS,) [mm]."""
    return np.concatenate((widths_of(law.travel_mm), widths_with_gaps(law.travel_mm)))


def drive_law_force(
    law: DriveLaw, x: Floats, moved: Floats, speed: Floats, tension: Floats, memory: Floats
) -> Floats:
    """Return the force beside the tendon at each sample [N], from arrays of shape (n,).

    `moved` is the displacement that the elements follow, `speed` its speed; `memory` is that of the
    elements, updated in place.
    """
    return _forces(np.array(law), drive_law_widths(law), x, moved, speed, tension, memory)


@kernel
def _forces(
    law: Floats,
    widths: Floats,
    x: Floats,
    moved: Floats,
    speed: Floats,
    tension: Floats,
    memory: Floats,
) -> Floats:
    out = np.empty(x.size)
    for i in range(x.size):
        move_elements(moved[i], widths, memory)
        out[i] = drive_law_at(law, memory, x[i], speed[i], tension[i])
    return out


@kernel
def drive_law_at(law: Floats, memory: Floats, x: float, speed: float, tension: float) -> float:
    """Return the force beside the tendon at one moment [N].

    `law` are the fields of `DriveLaw` in a row, shape (36,): as a record they would take a minute
    to compile. `memory` is that of the elements at this moment.
    """
    force = 0.0
    for k in range(ELEMENTS):
        force += (law[FIRST + k] + law[FIRST + ELEMENTS + k] * tension) * memory[1 + k]
    for k in range(GAPS):
        at = FIRST + 2 * ELEMENTS + k
        force += (law[at] + law[at + GAPS] * tension) * beyond_gap(memory[1 + ELEMENTS + k])
    factor = 1.0 + speed_curve_at(speed, law[SLOW], law[FAST], law[SPEEDS], law[SPEEDS + 1])
    factor += place_curve_at(x, law[LOW], law[HIGH], law[PLACES : PLACES + KNOTS - 1])
    force *= max(factor, 0.0)
    return force + curve_at(x, law[LOW], law[HIGH], law[LAST : LAST + KNOTS])


DRIVE_LAW = Effect(
    name="drive_law",
    title="Force at the drive, of unnamed origin",
    acts_on="drive",
    closed_form=True,
    equation="f_in = T + max(0, 1 + speed(ln|v|) + place(x))·(Σ (friction_k + share_k·T)·s_k + "
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
        *(Parameter(f"place_{k}", "1", 0.0, 0.1, -1.0, 10.0) for k in range(2, 6)),
    ),
    experiment="Nested strokes of the drive without the tendon: what f_in reads is this law alone.",
)
