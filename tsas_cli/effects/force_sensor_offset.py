"""A force sensor does not read zero without force.

What one sees: one force channel is off by the same amount at every tension and speed, on pull and
release, in all runs. In f_in over f_out both lines shift by the same amount; x_out does not change.
Equation: the reading is the tension plus a constant; not in the paper.
Mistaken for: a wrong preload (shifts f_in by e^(±μθ) times the shift of f_out); drive_friction,
load_friction (opposite on pull and release); force_sensor_gain, direction_dependent_friction (grow
with the tension); force_sensor_drift (changes during a run).
Not validated: offsets that differ from run to run, as after each taring.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel


class ForceSensorOffset(NamedTuple):
    """Reading of each force sensor without force [N]."""

    f_in_offset_N: float = 0.0
    f_out_offset_N: float = 0.0


@kernel
def offset_reading(force: float, offset: float) -> float:
    """Return the reading of a sensor with an offset [N]."""
    return force + offset


FORCE_SENSOR_OFFSET = Effect(
    name="force_sensor_offset",
    title="Offset of a force sensor",
    acts_on="sensor",
    closed_form=True,
    equation="reading = T + offset",
    doc=__doc__,
    parameters=(
        Parameter("f_in_offset_N", "N", neutral=0.0, start=0.5, lower=-1000.0, upper=1000.0),
        Parameter("f_out_offset_N", "N", neutral=0.0, start=0.5, lower=-1000.0, upper=1000.0),
    ),
    experiment="Let the tendon hang slack and read both force sensors: they must read zero.",
)
