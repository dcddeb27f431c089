"""A position sensor that turns off its centre reads ahead and behind, periodically.

What one sees: a wave on x_out alone with a fixed period in x_out, the same one on pull and release,
in every run and at any speed; f_in and f_out fit.
Equation: the reading is x + s sin a + c (cos a − 1) with a = 2πx/period, the first harmonic of an
encoder or a scale whose centre is not that of its shaft; on a drum of radius r the period is 2πr.
Not in the paper.
Mistaken for: load_ripple (f_out over x_out has the wave because the spring has it: f_in and f_out
follow in time); drive_ripple (f_in has it too, highest in dead bands, and so has the encoder of
x_in, which moves all other channels); position_sensor_gain (a slope, not a wave).
Not validated: higher harmonics; a wave so steep that the reading falls while x grows.
"""

from typing import NamedTuple

import numpy as np

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.wave import periods, wave_at

LONGEST_MM, SHORTEST_MM, PERIODS = 60.0, 2.0, 24
INVERSIONS = 50  # Newton's steps, far more than any wave that can be inverted needs


class PositionSensorRipple(NamedTuple):
    """Two amplitudes of the wave of x_out and its period in travel of the load [mm]."""

    sine_mm: float = 0.0
    cosine_mm: float = 0.0
    period_mm: float = 10.0


@kernel
def read_rippled(position: float, ripple: PositionSensorRipple) -> float:
    """Return the reading of a sensor that turns off its centre [mm]."""
    return position + wave_at(position, ripple.sine_mm, ripple.cosine_mm, ripple.period_mm)[0]


@kernel
def without_ripple(reading: float, ripple: PositionSensorRipple) -> float:
    """Return the position of a reading [mm]; NaN where the wave is too steep for one to exist."""
    position = reading
    for _ in range(INVERSIONS):
        wave, slope = wave_at(position, ripple.sine_mm, ripple.cosine_mm, ripple.period_mm)
        missed = position + wave - reading
        if np.abs(missed) <= 1e-12 * (1.0 + np.abs(reading)):
            return position
        position -= missed / (1.0 + slope)
    return np.nan


POSITION_SENSOR_RIPPLE = Effect(
    name="position_sensor_ripple",
    title="Position sensor off its centre",
    acts_on="sensor",
    closed_form=True,
    equation="reading of x_out = x + s·sin(2πx/period) + c·(cos(2πx/period) − 1)",
    doc=__doc__,
    parameters=(
        Parameter("sine_mm", "mm", neutral=0.0, start=0.05, lower=-5.0, upper=5.0),
        Parameter("cosine_mm", "mm", neutral=0.0, start=0.05, lower=-5.0, upper=5.0),
        Parameter(
            "period_mm",
            "mm",
            neutral=10.0,
            start=10.0,
            lower=0.5,
            upper=LONGEST_MM,  # a longer one is like a gain within the strokes of most rigs
            shape=True,
            period=True,
            starts=periods(LONGEST_MM, SHORTEST_MM, PERIODS),
        ),
    ),
    experiment="Turn the encoder on its shaft by half a turn: the wave changes its sign over "
    "x_out, and f_in and f_out stay as they are.",
)
