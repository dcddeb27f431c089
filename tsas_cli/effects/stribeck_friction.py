"""Slow sliding has more friction than fast sliding.

What one sees: f_in over f_out is widest near reversals, where the drive is slow, and narrows
towards the middle of a stroke; a whole run at a lower speed has a wider loop. The residual of f_in
is proportional to the tension and changes sign with the direction.
Equation: the exponential Stribeck curve on the friction coefficient of Eq. (2) of Yang 2025, with
the exponent of Armstrong-Helouvry, Dupont and Canudas de Wit 1994: 2 in Eq. (15), 1 in Tustin's
law; near 1 it is close to the 1/(1 + (v/vs)²) of Hess and Soom 1990. v is the sliding speed of each
point of the tendon, which friction follows late, first order: the frictional lag of Hess and Soom,
3 to 9 ms there, 10 ms where it is not known. The bristles of the dynamic model have a lag of their
own. The paper's 0.01 mm/s is far below the speed of its strokes, at which the excess has vanished.
Mistaken for: viscous_friction (more at high speed, at any tension the same); presliding (depends on
travel since the reversal, not on speed); load_dependent_friction (depends on the tension).
Not validated: stick-slip.
"""

from typing import NamedTuple

import numpy as np

from tsas_cli.effects.effect import Effect, Parameter, shape
from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.elementary import exponential, logarithm

SMALLEST_SHARE = 1e-300  # of the velocity: a normal float, whose power is as that of 0


class StribeckFriction(NamedTuple):
    """Excess of friction at rest, the speed at which it has fallen to 1/e, exponent, lag."""

    excess: float = 0.0
    velocity_mm_per_s: float = 5.0
    exponent: float = 2.0
    lag_s: float = 0.01


@kernel
def stribeck(speed: float, law: StribeckFriction) -> tuple[float, float]:
    """Return the factor of friction at a sliding speed [mm/s], and its slope [s/mm]."""
    per_mm_s = 1.0 / law.velocity_mm_per_s  # hoisted out of loops over nodes
    log_share = logarithm(max(abs(speed) * per_mm_s, SMALLEST_SHARE))
    left = law.excess * exponential(-exponential(law.exponent * log_share))
    rise = law.exponent * exponential((law.exponent - 1.0) * log_share) * per_mm_s
    return 1.0 + left, -np.sign(speed) * rise * left


@kernel
def stribeck_factor(speed: float, law: StribeckFriction) -> float:
    """Return the factor of the friction coefficient at a sliding speed [mm/s]."""
    return stribeck(speed, law)[0]


STRIBECK_FRICTION = Effect(
    name="stribeck_friction",
    title="Higher friction at low speed",
    acts_on="tendon",
    closed_form=False,
    equation="μ → μ·(1 + e·exp(−(v/vs)^δ))",
    doc=__doc__,
    parameters=(
        Parameter("excess", "1", neutral=0.0, start=0.2, lower=0.0, upper=10.0),
        shape("velocity_mm_per_s", "mm/s", 5.0, lower=0.01, upper=500.0, starts=(1.0, 4.0, 15.0)),
        shape("exponent", "1", 2.0, lower=1.0, upper=4.0),
        shape("lag_s", "s", 0.01, lower=0.005, upper=0.1),
    ),
    experiment="The same stroke at constant speeds over two decades: f_in/f_out at one position of "
    "the stroke, over the speed.",
)
