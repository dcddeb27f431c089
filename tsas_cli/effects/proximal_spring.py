"""A spring between the drive's end of the tendon and the ground pulls in parallel to the tendon.

What one sees: f_in is steeper over x_in by the same stiffness in every phase, in pull, release and
dead bands; the whole loop is sheared. f_out and x_out are unaffected.
Equation: Hooke's law parallel to the tendon. It is the disturbance of Yang 2025, Fig. 11, with
12.5 N/mm.
Mistaken for: a stiffer load spring (f_out rises too, and f_in more on a pull than on a release);
force_sensor_gain (proportional to the tension, not to the travel).
Not validated: a spring that hangs slack in a part of the travel, or is preloaded at x_in = 0;
cables of the drive that pull like one but have friction of their own.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel


class ProximalSpring(NamedTuple):
    """Stiffness of the spring to ground [N/mm]."""

    stiffness_N_per_mm: float = 0.0


@kernel
def proximal_spring_force(position: float, stiffness: float) -> float:
    """Return the spring force added to the tension at the drive [N], at a position [mm]."""
    return stiffness * position


PROXIMAL_SPRING = Effect(
    name="proximal_spring",
    title="Spring at the drive's end",
    acts_on="drive",
    closed_form=True,
    equation="f_in = T0 + k · p",
    doc=__doc__,
    parameters=(
        Parameter("stiffness_N_per_mm", "N/mm", neutral=0.0, start=0.5, lower=0.0, upper=1000.0),
    ),
    experiment="Disconnect the tendon from the drive and move it: f_in over x_in is the spring "
    "alone.",
)
