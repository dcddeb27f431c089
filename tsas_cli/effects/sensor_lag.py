"""A channel passes a low-pass filter before it is recorded.

What one sees: the channel is late and its corners are round: short peaks are lower, a step becomes
an exponential. In slow motion the residual is that of a delay, proportional to how fast the channel
changes; in fast motion the amplitude falls as well.
Equation: dy/dt = (signal − y)/lag, the first-order low pass of an amplifier or a filter with a
corner frequency of 1/(2π lag); 20 ms are 8 Hz. Exact from sample to sample for a signal that is
linear in between. Not in the paper.
Mistaken for: channel_delay (indistinguishable in slow sines, where the lag is a delay of the same
time; only corners and fast motion separate them); presliding (rounds the same corners, by travel
and not by time); viscous_friction, drive_damping (f_in alone, proportional to the speed of x_in).
Not validated: filters of higher order; a lag of x_in itself; a recording that starts in the middle
of a fast motion, before which the filter is taken to be at rest. A measured load is taken back to
its true value by its rate alone, which does not restore corners.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter


class SensorLag(NamedTuple):
    """Time constant of each channel's low pass [s]."""

    f_in_lag_s: float = 0.0
    f_out_lag_s: float = 0.0
    x_out_lag_s: float = 0.0


SENSOR_LAG = Effect(
    name="sensor_lag",
    title="Low pass of a channel",
    acts_on="sensor",
    closed_form=True,
    equation="dy/dt = (signal − y)/lag, reading = y",
    doc=__doc__,
    parameters=(
        Parameter("f_in_lag_s", "s", neutral=0.0, start=0.01, lower=0.0, upper=1.0),
        Parameter("f_out_lag_s", "s", neutral=0.0, start=0.01, lower=0.0, upper=1.0),
        Parameter("x_out_lag_s", "s", neutral=0.0, start=0.01, lower=0.0, upper=1.0),
    ),
    experiment="Cut the thread by which a weight hangs on the sensor: a delayed channel steps "
    "late, a filtered one falls exponentially.",
)
