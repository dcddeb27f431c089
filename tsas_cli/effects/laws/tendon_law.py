"""The friction in the sheath depends on the displacement of the drive, by a law of unnamed origin.

What one sees: f_in over f_out, a ratio, differs with the speed of the drive, from place to place,
or with the travel since its reversals, at any tension.
Equation: μ → μ·max(0, 1 + Σ start_k·exp(−τ/w_k) + curve(x) + speed(ln|v|)), τ the travel of the
tendon's end at the drive since its last reversal, w_k = travel·4^(1−k), x its displacement, v its
speed. μ is the friction far from a reversal at the low end and at low speed, where both curves
are 0. The paper's μ is constant.
Mistaken for: a cause. A law describes what no proven cause explains: breakaway, ageing, rolling
strands, coatings, other laws of speed, and whatever else the friction depends on.
Not validated: displacements, tensions and speeds beyond those that it was fitted to; loops with a
friction that changes by more than half over the speeds, which shakes the simulated drive.
"""

import math
from typing import NamedTuple

import numpy as np

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.effects.laws import FAST, HIGH, LOW, SLOW, TRAVEL
from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.stops import KNOTS, RATIO, place_curve_at, speed_curve_at
from tsas_cli.support.arrays import Floats

STARTS = 4
FIRST_START = 5  # of the fields in a row
HEIGHTS = FIRST_START + STARTS  # of the curve
SPEEDS = HEIGHTS + KNOTS - 1  # of that over the speed, from the middle one on


class TendonLaw(NamedTuple):
    """Ranges of travel, place and speed; shares after a reversal; heights of the curves."""

    travel_mm: float = 1.0
    low_mm: float = 0.0
    high_mm: float = 1.0
    slow_mm_per_s: float = 1.0
    fast_mm_per_s: float = 10.0
    start_1: float = 0.0
    start_2: float = 0.0
    start_3: float = 0.0
    start_4: float = 0.0
    curve_2: float = 0.0
    curve_3: float = 0.0
    curve_4: float = 0.0
    curve_5: float = 0.0
    speed_2: float = 0.0
    speed_3: float = 0.0


def tendon_law_factor(law: TendonLaw, x: Floats, travel: Floats, speed: Floats) -> Floats:
    """Return the factor of the friction coefficient at each sample [1].

    From displacement, travel since the last reversal and speed of the tendon's end at the drive,
    shape (n,) each.
    """
    return _factors(np.array(law), x, travel, speed)


@kernel
def _factors(law: Floats, x: Floats, travel: Floats, speed: Floats) -> Floats:
    out = np.empty(x.size)
    for i in range(x.size):
        out[i] = tendon_law_at(law, x[i], travel[i], speed[i])
    return out


@kernel
def tendon_law_at(law: Floats, x: float, travel: float, speed: float) -> float:
    """Return the factor at one moment [1]; `law` are the fields of `TendonLaw`, shape (15,)."""
    factor = 1.0 + place_curve_at(x, law[LOW], law[HIGH], law[HEIGHTS:SPEEDS])
    for k in range(STARTS):
        factor += law[FIRST_START + k] * math.exp(-travel / (law[TRAVEL] * RATIO**k))
    factor += speed_curve_at(speed, law[SLOW], law[FAST], law[SPEEDS], law[SPEEDS + 1])
    return max(factor, 0.0)


TENDON_LAW = Effect(
    name="tendon_law",
    title="Friction in the sheath, of unnamed origin",
    acts_on="tendon",
    closed_form=False,
    equation="μ → μ·max(0, 1 + Σ start_k·exp(−τ/w_k) + curve(x) + speed(ln|v|))",
    doc=__doc__,
    parameters=(
        Parameter("travel_mm", "mm", 1.0, 1.0, 1e-6, 1e4, given=True),
        Parameter("low_mm", "mm", 0.0, 0.0, -1e5, 1e5, given=True),
        Parameter("high_mm", "mm", 1.0, 1.0, -1e5, 1e5, given=True),
        Parameter("slow_mm_per_s", "mm/s", 1.0, 1.0, 1e-9, 1e5, given=True),
        Parameter("fast_mm_per_s", "mm/s", 10.0, 10.0, 1e-9, 1e5, given=True),
        *(Parameter(f"start_{k}", "1", 0.0, 0.1, -1.0, 10.0) for k in range(1, 5)),
        *(Parameter(f"curve_{k}", "1", 0.0, 0.1, -1.0, 10.0) for k in range(2, 6)),
        *(Parameter(f"speed_{k}", "1", 0.0, 0.1, -1.0, 10.0) for k in range(2, 4)),
    ),
    experiment="Short strokes about several places of the drive, at the same tension: ln(f_in/"
    "f_out) over the place and over the travel since the reversal.",
)
