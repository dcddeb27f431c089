"""The sheath gets shorter under the tension that it guides.

What one sees: dead bands are wider and softer, and x_out lags further behind x_in as the tension
rises, exactly as with a softer tendon and in proportion to the sheath's length.
Equation: the sheath is compressed by the force of the tendon, so both are compliant in series:
(1 + ratio)/EA per length of sheathed tendon, ratio = EA of the tendon / EA of the sheath. Hooke's
law as in Yang 2025, Eq. (3), which assumes a rigid sheath.
Mistaken for: a lower tendon modulus (indistinguishable; only bounds on the tendon's modulus, from a
data sheet, separate them); free_tendon, drive_compliance (they do not grow with the sheath's
length).
Not validated: a sheath that slides in its clamps, straightens, or keeps a part of its shortening.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel


class SheathCompression(NamedTuple):
    """Axial stiffness of the tendon divided by that of the sheath [1]."""

    compliance_ratio: float = 0.0


@kernel
def softened(compliance: float, ratio: float) -> float:
    """Return the compliance of sheathed tendon and sheath together, in the unit of the first."""
    return compliance * (1.0 + ratio)


SHEATH_COMPRESSION = Effect(
    name="sheath_compression",
    title="Compression of the sheath",
    acts_on="tendon",
    closed_form=True,
    equation="dx/ds = (1 + ratio)·(T − F0)/EA in the sheath",
    doc=__doc__,
    parameters=(Parameter("compliance_ratio", "1", neutral=0.0, start=0.3, lower=0.0, upper=20.0),),
    experiment="Measure the stiffness of the tendon alone, outside the sheath: the compliance of "
    "the dead bands beyond it is the sheath's.",
)
