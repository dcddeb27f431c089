"""The gear moves the tendon's end a little ahead and behind, periodically in the drive's travel.

What one sees: a wave on f_in, f_out and x_out with a fixed period in x_in; twice the speed gives
twice its frequency in time. On f_in it is much higher in dead bands than in full slip, because
the tendon is stiff there.
Equation: two harmonics of the kinematic error of a gear (for harmonic drives e.g. Tuttle and
Seering 1996, IEEE Trans. Robotics and Automation 12(3)). Two waves per revolution of the wave
generator make a period of 2π r1/(2 im), 0.7095 mm for the drive of Yang 2025, Eq. (48): r1 =
27.1 mm, im = 120. An encoder of x_in that turns off its centre is equivalent: what it reads too
much, the tendon's end lags behind x_in, in every channel. The phase belongs to x_in as recorded: a
tendon that is tightened anew moves the zero of x_in, and not the gear.
Mistaken for: position_sensor_ripple (x_out alone has the wave); mains hum on a sensor (its period
is one of time); load_spring_nonlinearity (where the period is longer than the stroke).
Not validated: a third harmonic; an encoder that is set to zero elsewhere in each run; a ripple that
changes with torque; one so steep that 2π·amplitude/period exceeds 1, which reverses the tendon's
end.
"""

from tsas_cli.effects.effect import Effect, wave_parameters
from tsas_cli.numerics.wave import periods

PERIOD_MM = 0.7095

DRIVE_RIPPLE = Effect(
    name="drive_ripple",
    title="Ripple of the drive's gear, or of its encoder",
    acts_on="drive",
    closed_form=True,
    equation="p = x_in + s·sin a + c·(cos a − 1) + 2nd harmonic,  a = 2π x_in/period",
    doc=__doc__,
    parameters=wave_parameters(
        0.05,
        PERIOD_MM,
        shortest_mm=0.05,
        longest_mm=10.0,
        starts=(PERIOD_MM, *periods(10.0, 0.3, 60)),
    ),
    experiment="One slow stroke at two constant speeds: the wave keeps its period in x_in and "
    "doubles its frequency in time with the speed.",
)
