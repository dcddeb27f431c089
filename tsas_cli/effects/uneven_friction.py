"""Friction is not the same along the sheath: more at one of its ends.

What one sees: in full slip nothing, since only the sum along the sheath counts there. After a
reversal the dead band has another shape: with more friction at the drive f_in changes faster at
first and slower later, and a dead band that ends early shows another tension. Residuals of f_in sit
in dead bands and repeat at each.
Equation: Yang 2025, Eq. (2), with μ (1 + slope·(s/L − ½)) at the place s along the sheath, counted
by its bend: linear from 1 − slope/2 at the drive to 1 + slope/2 at the load, with the same mean.
The paper's μ is the same everywhere.
Mistaken for: presliding (rounds the beginning of a dead band, by a travel); sheath_compression,
free_tendon, drive_compliance (make the whole dead band wider); a bend that is not even along the
sheath (indistinguishable where it comes with a length of sheath without bend).
Not validated: friction that changes along the sheath by another law than a line.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel


class UnevenFriction(NamedTuple):
    """Friction at the load's end less that at the drive's, over the mean [1]."""

    slope: float = 0.0


@kernel
def place_factor(place: float, slope: float) -> float:
    """Return the factor of the friction coefficient at a place, from 0 (drive) to 1 (load)."""
    return 1.0 + slope * (place - 0.5)


UNEVEN_FRICTION = Effect(
    name="uneven_friction",
    title="Friction that changes along the sheath",
    acts_on="tendon",
    closed_form=False,
    equation="μ → μ·(1 + slope·(s/L − ½))",
    doc=__doc__,
    parameters=(Parameter("slope", "1", neutral=0.0, start=0.2, lower=-1.9, upper=1.9),),
    experiment="Swap the ends of the sheath and repeat the run: the shape of the dead bands "
    "changes, that of full slip does not.",
)
