"""A position sensor reads too much or too little in proportion to the travel.

What one sees: x_out is wrong in proportion to its travel, on pull and release and in every run;
f_in and f_out fit. f_out over x_out has a wrong slope.
Equation: x_out reads gain times the displacement. A wrong gain of x_in, such as a wrong radius of
the turntable, is equivalent, except that it scales the load stiffness and the tendon stiffness; so
only the ratio of both gains is identifiable, and it is assigned to x_out. Not in the paper.
Mistaken for: a wrong load stiffness (changes f_in and f_out over x_in too); free_tendon,
drive_compliance, sheath_compression (x_out moves less, but f_out over x_out keeps its slope).
Not validated: a gain that changes along the travel, as with a laser at an angle.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel


class PositionSensorGain(NamedTuple):
    """Reading of x_out per displacement [1]."""

    x_out_gain: float = 1.0


@kernel
def read_position(position: float, gain: float) -> float:
    """Return the reading of a position sensor with a gain [mm]."""
    return gain * position


POSITION_SENSOR_GAIN = Effect(
    name="position_sensor_gain",
    title="Wrong gain of a position sensor",
    acts_on="sensor",
    closed_form=True,
    equation="reading of x_out = gain · x",
    doc=__doc__,
    parameters=(Parameter("x_out_gain", "1", neutral=1.0, start=1.02, lower=0.01, upper=100.0),),
    experiment="Move each position sensor by the same gauge block: x_in and x_out must read the "
    "same travel.",
)
