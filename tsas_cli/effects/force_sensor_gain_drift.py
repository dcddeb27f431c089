"""The gain of a force sensor drifts during a run.

What one sees: the residual of one force channel grows during the run in proportion to the tension,
with the same sign on pull and release; the other channels fit to the end. Every run starts without
it.
Equation: the reading is the tension times 1 + rate·t, a drift of the sensor's span as with its
temperature or its supply; the first order of any slow change. Not in the paper.
Mistaken for: force_sensor_drift (the same at every tension); friction_drift, bend_drift (opposite
on pull and release); preload_loss (f_in and f_out fall together); force_sensor_gain (present from
the start, and constant); force_sensor_tilt (by the position, not by the time).
Not validated: a drift that settles, or that continues from one run to the next.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel
from tsas_cli.support.arrays import Values


class ForceSensorGainDrift(NamedTuple):
    """Relative rate at which each force sensor's gain grows [1/s]."""

    f_in_rate_per_s: float = 0.0
    f_out_rate_per_s: float = 0.0


@kernel
def drifted_gain(gain: float, rate_per_s: float, time_s: Values) -> Values:
    """Return a sensor's gain at a time since the start of the run."""
    return gain * (1.0 + rate_per_s * time_s)


FORCE_SENSOR_GAIN_DRIFT = Effect(
    name="force_sensor_gain_drift",
    title="Drift of a force sensor's gain",
    acts_on="sensor",
    closed_form=True,
    equation="reading = (1 + rate·t)·T",
    doc=__doc__,
    parameters=(
        Parameter("f_in_rate_per_s", "1/s", neutral=0.0, start=0.002, lower=-0.5, upper=0.5),
        Parameter("f_out_rate_per_s", "1/s", neutral=0.0, start=0.002, lower=-0.5, upper=0.5),
    ),
    experiment="Hang a weight on the sensor and take it off, again and again for as long as a run: "
    "the step between both readings grows or shrinks.",
)
