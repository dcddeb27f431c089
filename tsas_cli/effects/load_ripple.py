"""An eccentric pulley at the load stretches the load spring ahead and behind, periodically.

What one sees: on f_out over x_out a wave with a fixed period in x_out, the same one on pull and
release and at any speed; f_in has it in full slip, higher on a pull than on a release, and not in
dead bands, where the load stands still.
Equation: the spring of Yang 2025, Eq. (9), is stretched by x + s sin a + c (cos a − 1) with a =
2πx/period, the first harmonic of a pulley or drum that turns off its centre, and its second; a
pulley of radius r has a period of 2πr.
Mistaken for: load_spring_nonlinearity (where the period is longer than the stroke); drive_ripple
(highest in dead bands, with a period in x_in); position_sensor_ripple (leaves f_in and f_out as
they are); position_sensor_gain (a slope, not a wave).
Not validated: the change of the pulley's lever arm, 2π·amplitude/period of the force; a third
harmonic; a wave so steep that the force falls with x.
"""

from tsas_cli.effects.effect import Effect, wave_parameters
from tsas_cli.numerics.wave import periods

LOAD_RIPPLE = Effect(
    name="load_ripple",
    title="Eccentric pulley at the load",
    acts_on="load",
    closed_form=False,
    equation="spring force = F0 + kL·(x + s·sin a + c·(cos a − 1) + 2nd harmonic),  a = 2πx/period",
    doc=__doc__,
    parameters=wave_parameters(
        0.1, 10.0, shortest_mm=0.5, longest_mm=60.0, starts=periods(60.0, 2.5, 19)
    ),
    experiment="Turn the pulley to another angle before the run: the wave moves along x_out with "
    "it.",
)
