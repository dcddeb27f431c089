"""A force sensor reads too much or too little in proportion to the force.

What one sees: in f_in over f_out the slopes of pull and release are wrong by the same factor, at
every bend; f_out over x_out has a wrong slope too. f_in and x_out fit.
Equation: f_out reads gain times the tension. A wrong gain of f_in is equivalent, except that it
scales the load stiffness, the tendon stiffness and the preload; so only the ratio of both gains is
identifiable, and it is assigned to f_out. Not in the paper.
Mistaken for: direction_dependent_friction (in full slip exactly the same within one bend, but it
grows with the bend); force_crosstalk (f_in is wrong too, and differently in dead bands);
force_sensor_curvature (along a small range of tension); force_sensor_offset (the same force at
every tension); a wrong load stiffness or preload, where f_in is not recorded.
Not validated: a gain that changes with temperature.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel


class ForceSensorGain(NamedTuple):
    """Reading of f_out per tension [1]."""

    f_out_gain: float = 1.0


@kernel
def read_gain(force: float, gain: float) -> float:
    """Return the reading of a sensor with a gain [N]."""
    return gain * force


FORCE_SENSOR_GAIN = Effect(
    name="force_sensor_gain",
    title="Wrong gain of a force sensor",
    acts_on="sensor",
    closed_form=True,
    equation="reading of f_out = gain · T",
    doc=__doc__,
    parameters=(Parameter("f_out_gain", "1", neutral=1.0, start=1.05, lower=0.2, upper=5.0),),
    experiment="Hang one weight on both force sensors in series: they must read the same.",
)
