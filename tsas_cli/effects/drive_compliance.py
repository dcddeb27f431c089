"""Between its encoder and the tendon the drive deflects in proportion to the force.

What one sees: dead bands are softer in f_in over x_in, by the same compliance at every reversal;
x_out moves less than predicted, by an amount in proportion to f_in. f_in over f_out in full slip
does not change.
Equation: a spring in series, Hooke's law. The paper assumes a stiff drive (before Eq. 24).
Mistaken for: free_tendon (its proximal length has exactly the same signature, c = l/EA: only the
rig's drawing separates them); sheath_compression, a lower tendon modulus (they grow with the
sheath's length); backlash (a flat piece, not wider at higher tension).
Not validated: gears that stiffen with torque, as harmonic drives do, or lose energy as they wind
up.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel


class DriveCompliance(NamedTuple):
    """Compliance between encoder and tendon [mm/N]."""

    compliance_mm_per_N: float = 0.0


@kernel
def drive_deflection(tension_change: float, compliance: float) -> float:
    """Return the deflection of the drive [mm] under a change of tension [N]."""
    return compliance * tension_change


DRIVE_COMPLIANCE = Effect(
    name="drive_compliance",
    title="Compliance of the drive",
    acts_on="drive",
    closed_form=True,
    equation="x_in − x_tendon = c · (f_in − F0)",
    doc=__doc__,
    parameters=(
        Parameter("compliance_mm_per_N", "mm/N", neutral=0.0, start=0.002, lower=0.0, upper=1.0),
    ),
    experiment="Clamp the tendon where it leaves the drive and pull: x_in over f_in is the "
    "compliance, without any sheath.",
)
