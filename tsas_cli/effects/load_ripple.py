"""An eccentric pulley at the load stretches the load spring ahead and behind, periodically.

What one sees: on f_out over x_out a wave with a fixed period in x_out, the same one on pull and
release and at any speed; f_in has it in full slip, higher on a pull than on a release, and not in
dead bands, where the load stands still.
Equation: the spring of Yang 2025, Eq. (9), is stretched by x + s sin a + c (cos a − 1) with a =
2πx/period, the first harmonic of a pulley or drum that turns off its centre; a pulley of radius r
has a period of 2πr.
Mistaken for: load_spring_nonlinearity (where the period is longer than the stroke); drive_ripple
(highest in dead bands, with a period in x_in); position_sensor_ripple (leaves f_in and f_out as
they are); position_sensor_gain (a slope, not a wave).
Not validated: the change of the pulley's lever arm, 2π·amplitude/period of the force; higher
harmonics; a wave so steep that the force falls with x.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.wave import periods, wave_at

LONGEST_MM, SHORTEST_MM, PERIODS = 60.0, 5.0, 8  # each start costs runs of the slip chain


class LoadRipple(NamedTuple):
    """Two amplitudes of the wave and its period in travel of the load [mm]."""

    sine_mm: float = 0.0
    cosine_mm: float = 0.0
    period_mm: float = 10.0


@kernel
def spring_wave(position: float, ripple: LoadRipple) -> tuple[float, float]:
    """Return by how much the spring is stretched beyond the load's travel [mm], and the slope."""
    return wave_at(position, ripple.sine_mm, ripple.cosine_mm, ripple.period_mm)


LOAD_RIPPLE = Effect(
    name="load_ripple",
    title="Eccentric pulley at the load",
    acts_on="load",
    closed_form=False,
    equation="spring force = F0 + kL·(x + s·sin(2πx/period) + c·(cos(2πx/period) − 1))",
    doc=__doc__,
    parameters=(
        Parameter("sine_mm", "mm", neutral=0.0, start=0.1, lower=-5.0, upper=5.0),
        Parameter("cosine_mm", "mm", neutral=0.0, start=0.1, lower=-5.0, upper=5.0),
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
    experiment="Turn the pulley to another angle before the run: the wave moves along x_out with "
    "it.",
)
