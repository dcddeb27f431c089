"""Between the drive's force sensor and the tendon a damper opposes the drive.

What one sees: f_in is too high on a pull and too low on a release, in proportion to the speed of
x_in, in dead bands as in full slip; f_out and x_out do not change. At each reversal f_in crosses
smoothly where the drive slows down, and jumps where it does not.
Equation: the sensor reads T0 + c v, v the speed of the tendon's end at the drive: the B dx/dt of
the drive in Yang 2025, Eq. (25), but on the tendon's side of the force sensor.
Mistaken for: viscous_friction (in full slip the same; in the middle of a dead band the tendon
slides over a part of the sheath only); drive_friction (does not grow with the speed); sensor_lag,
channel_delay of f_in (proportional to how fast f_in changes, most in dead bands).
Not validated: dampers whose force is not proportional to the speed; a drive by a measured force
that is at rest between samples.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel


class DriveDamping(NamedTuple):
    """Force of the damper per speed of the drive [N s/mm]."""

    coefficient_N_s_per_mm: float = 0.0


@kernel
def drive_damper_force(speed: float, coefficient: float) -> float:
    """Return the force of the damper at the drive [N], added to the tension; speed in mm/s."""
    return coefficient * speed


DRIVE_DAMPING = Effect(
    name="drive_damping",
    title="Damping of the drive behind its force sensor",
    acts_on="drive",
    closed_form=True,
    equation="f_in = T0 + c·v",
    doc=__doc__,
    parameters=(
        Parameter(
            "coefficient_N_s_per_mm", "N s/mm", neutral=0.0, start=0.02, lower=0.0, upper=100.0
        ),
    ),
    experiment="Disconnect the tendon and move the drive at several speeds: f_in is the damper "
    "alone, in proportion to the speed.",
)
