"""The friction in the sheath depends on the displacement of the drive, by a law of unnamed origin.

What one sees: f_in over f_out, a ratio, differs with the speed of the drive, from place to place,
or with the travel since its reversals, at any tension.
Equation: μ → μ·(1 + Σ start_k·exp(−τ/w_k) + curve(x) + speed(ln|v|)), τ the travel of the tendon's
end at the drive since its last reversal, w_k = travel·4^(1−k), x its displacement, v its speed; not
below 0. μ is the friction far from a reversal at the low end and at low speed, where both curves
are 0. The paper's μ is constant.
Mistaken for: a cause. A law describes what no proven cause explains: breakaway, ageing, rolling
strands, coatings, other laws of speed, and whatever else the friction depends on.
Not validated: displacements, tensions and speeds beyond those that it was fitted to; controlled
drives, whose plants have a constant μ.
"""

from typing import NamedTuple

import numpy as np

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.stops import RATIO, curve_of, speed_curve
from tsas_cli.support.arrays import Floats

STARTS = 4


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
    starts, curve, speeds = law[5:9], (0.0, *law[9:13]), law[13:]
    factor = 1.0 + curve_of(x, law.low_mm, law.high_mm, curve)
    for k, start in enumerate(starts, 1):
        factor += start * np.exp(-travel / (law.travel_mm * RATIO ** (k - 1)))
    factor += speed_curve(speed, law.slow_mm_per_s, law.fast_mm_per_s, speeds)
    return np.maximum(factor, 0.0)


TENDON_LAW = Effect(
    name="tendon_law",
    title="Friction in the sheath, of unnamed origin",
    acts_on="tendon",
    closed_form=False,
    equation="μ → μ·(1 + Σ start_k·exp(−τ/w_k) + curve(x) + speed(ln|v|))",
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
