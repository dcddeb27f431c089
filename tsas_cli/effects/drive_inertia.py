"""Between the drive's force sensor and the tendon a mass needs a force where it accelerates.

What one sees: in f_in a force that follows the acceleration of x_in: in a sine lower at the far end
of the stroke and higher at the near one, by m ω² for each mm; short peaks where a ramp starts,
stops or reverses. f_out and x_out do not change. Slow runs fit.
Equation: the sensor reads T0 + m a, a the acceleration of the tendon's end at the drive: Newton's
second law; 1 kg times 1 mm/s² is 1e-3 N. The J of the drive in Yang 2025, Eq. (25), but on the
tendon's side of the force sensor.
Mistaken for: proximal_spring (in sines of one frequency the same with the opposite sign, and the
same at every frequency); drive_damping (proportional to the speed); load_inertia (f_out has it
too).
Not validated: noise of x_in, whose second derivative is large; the mass of the tendon itself; an
inertia that oscillates on the tendon between two samples.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel

N_S2_PER_KG_MM = 1e-3


class DriveInertia(NamedTuple):
    """Mass between force sensor and tendon [kg]."""

    mass_kg: float = 0.0


@kernel
def drive_inertia_force(acceleration: float, mass_kg: float) -> float:
    """Return the force of the mass at the drive [N], added to the tension; in mm/s²."""
    return N_S2_PER_KG_MM * mass_kg * acceleration


DRIVE_INERTIA = Effect(
    name="drive_inertia",
    title="Mass of the drive behind its force sensor",
    acts_on="drive",
    closed_form=True,
    equation="f_in = T0 + m·a",
    doc=__doc__,
    parameters=(Parameter("mass_kg", "kg", neutral=0.0, start=1.0, lower=0.0, upper=1000.0),),
    experiment="Disconnect the tendon and move the drive by sines of rising frequency: f_in over "
    "x_in falls with the frequency squared.",
)
