"""A force sensor tilts as the tendon moves: its gain changes with the position.

What one sees: the residual of one force channel is the tension times the position, the same on pull
and release, in every run and at every speed. With f_out, f_out over x_out is a parabola although
f_in and x_out fit; with f_in, its lines over x_in bend while the other channels fit.
Equation: the reading is the tension times 1 + c·x, with x_in at the drive's sensor and x_out at the
load's: the first order of a cell that turns out of the tendon's line. Not in the paper.
Mistaken for: force_sensor_curvature (by the tension: where the load is a spring, only different
preloads and dead bands separate them); load_spring_nonlinearity (f_in follows too);
position_dependent_friction (opposite on pull and release); force_sensor_gain_drift (by the time).
Not validated: tilts so large that the cosine matters; side forces. A measured tension that drives
the model is taken as it is.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.numerics.compiled import kernel
from tsas_cli.support.arrays import Values


class ForceSensorTilt(NamedTuple):
    """Relative change of each force sensor's gain with its position [1/mm]."""

    f_in_per_mm: float = 0.0
    f_out_per_mm: float = 0.0


@kernel
def read_tilted(force: Values, per_mm: float, position: Values) -> Values:
    """Return the reading of a sensor that tilts with the position [N]."""
    return force * (1.0 + per_mm * position)


FORCE_SENSOR_TILT = Effect(
    name="force_sensor_tilt",
    title="Force sensor that tilts",
    acts_on="sensor",
    closed_form=True,
    equation="reading of f_in = T0·(1 + c·x_in),  reading of f_out = TL·(1 + c·x_out)",
    doc=__doc__,
    parameters=(
        Parameter("f_in_per_mm", "1/mm", neutral=0.0, start=5e-4, lower=-0.05, upper=0.05),
        Parameter("f_out_per_mm", "1/mm", neutral=0.0, start=5e-4, lower=-0.05, upper=0.05),
    ),
    experiment="Hang one weight on the sensor at both ends of the stroke: the readings differ.",
)
