"""The scale of a force sensor is curved: its gain changes along its range.

What one sees: the residual of one force channel is a parabola over the tension, the same on pull
and release, in every run and at every speed. With f_out, f_out over x_out is a curve although f_in
and x_out fit; with f_in, both lines of f_in over f_out bend the same way.
Equation: the reading is T + c T²: right without force, where a sensor is tared, and with a slope of
one there. The law is that of the sensor alone, whatever the preload of a run, and the slope at the
preload is 1 + 2 c F0. The nonlinearity of load cells' data sheets; not in the paper.
Mistaken for: load_spring_nonlinearity (bends f_out over x_out too, and f_in with it);
force_sensor_gain, force_sensor_offset (in runs with a small range of tension);
load_dependent_friction (bends the lines of f_in over f_out in opposite directions).
Not validated: scales that are not a parabola; tensions beyond the vertex of the parabola.
"""

from typing import NamedTuple

import numpy as np

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel
from tsas_cli.support.arrays import Values


class ForceSensorCurvature(NamedTuple):
    """Curvature of the scale of each force sensor [1/N]."""

    f_in_per_N: float = 0.0
    f_out_per_N: float = 0.0


@kernel
def read_curved(force: Values, curvature: float) -> Values:
    """Return the reading of a sensor with a curved scale [N]."""
    return force + curvature * force * force


@kernel
def straightened(reading: Values, curvature: float) -> Values:
    """Return the force of a reading [N], that of the vertex for readings beyond it."""
    root: Values = np.sqrt(np.maximum(1.0 + 4.0 * curvature * reading, 0.0))
    return 2.0 * reading / (1.0 + root)


FORCE_SENSOR_CURVATURE = Effect(
    name="force_sensor_curvature",
    title="Curved scale of a force sensor",
    acts_on="sensor",
    closed_form=True,
    equation="reading = T + c·T²",
    doc=__doc__,
    parameters=(
        Parameter("f_in_per_N", "1/N", neutral=0.0, start=2e-4, lower=-0.005, upper=0.005),
        Parameter("f_out_per_N", "1/N", neutral=0.0, start=2e-4, lower=-0.005, upper=0.005),
    ),
    experiment="Hang one, two and four times the same weight on the sensor: the readings less the "
    "tare must be as one to two to four.",
)
