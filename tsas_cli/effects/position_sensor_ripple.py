"""A position sensor that turns off its centre reads ahead and behind, periodically.

What one sees: a wave on x_out alone with a fixed period in x_out, the same one on pull and release,
in every run and at any speed; f_in and f_out fit.
Equation: the reading is x + s sin a + c (cos a − 1) with a = 2πx/period, the first harmonic of an
encoder or a scale whose centre is not that of its shaft, and its second, of one that is oval; on a
drum of radius r the period is 2πr.
Not in the paper.
Mistaken for: load_ripple (f_out over x_out has the wave because the spring has it: f_in and f_out
follow in time); drive_ripple (f_in has it too, highest in dead bands, and so has the encoder of
x_in, which moves all other channels); position_sensor_gain (a slope, not a wave).
Not validated: a third harmonic; a wave so steep that the reading falls while x grows.
"""

import numpy as np

from tsas_cli.effects.effect import Effect, wave_parameters
from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.wave import Wave, periods, wave_at

INVERSIONS = 50  # Newton's steps, far more than any wave that can be inverted needs


@kernel
def without_ripple(reading: float, ripple: Wave) -> float:
    """Return the position of a reading [mm]; NaN where the wave is too steep for one to exist."""
    position = reading
    for _ in range(INVERSIONS):
        wave, slope = wave_at(position, ripple)
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
    equation="reading of x_out = x + s·sin a + c·(cos a − 1) + 2nd harmonic,  a = 2πx/period",
    doc=__doc__,
    parameters=wave_parameters(
        0.05, 10.0, shortest_mm=0.5, longest_mm=60.0, starts=periods(60.0, 0.6, 82)
    ),
    experiment="Turn the encoder on its shaft by half a turn: the wave changes its sign over "
    "x_out, and f_in and f_out stay as they are.",
)
