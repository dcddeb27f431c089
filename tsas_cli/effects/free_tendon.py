"""Tendon outside the sheath stretches in series with it, at either end.

What one sees: x_out moves less than predicted, by an amount in proportion to the tension; dead
bands are softer in f_in over x_in (proximal length), loaded slopes fall slightly (both).
Equation: a free length l under tension F is longer by (F − F0) l/(EA), Hooke's law as in Yang
2025, Eq. (3), without friction. The paper supposes this effect under its Fig. 4 and does not
test it. A sheath that is straight at an end, where the tendon hardly rubs, adds to that length.
Mistaken for: drive_compliance (the same as a proximal length, c = l/EA); sheath_compression, a
lower tendon modulus (recordings with two sheath lengths separate them); position_sensor_gain
(x_out over f_out is wrong too); a soft load spring.
Not validated: tendon that touches a guide on its free length.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel


class FreeTendon(NamedTuple):
    """Free lengths at the drive and at the load [mm]."""

    proximal_length_mm: float = 0.0
    distal_length_mm: float = 0.0


@kernel
def free_compliance(length_mm: float, tendon_stiffness_N: float) -> float:
    """Return the compliance l/(EA) of a free length [mm/N]."""
    return length_mm / tendon_stiffness_N


FREE_TENDON = Effect(
    name="free_tendon",
    title="Tendon outside the sheath",
    acts_on="tendon",
    closed_form=True,
    equation="x_in − x_sheath = (T0 − F0)·l_proximal/EA,  x_sheath − x_out = (TL − F0)·l_distal/EA",
    doc=__doc__,
    parameters=(
        Parameter("proximal_length_mm", "mm", neutral=0.0, start=50.0, lower=0.0, upper=5000.0),
        Parameter("distal_length_mm", "mm", neutral=0.0, start=50.0, lower=0.0, upper=5000.0),
    ),
    experiment="Clamp the tendon where it leaves the drive, then where it enters the sheath, and "
    "pull: x_in over f_in differs by the compliance of the proximal length.",
)
