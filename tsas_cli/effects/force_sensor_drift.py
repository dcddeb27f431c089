"""The reading of a force sensor drifts during a run, or from run to run.

What one sees: the residual of one force channel grows steadily during the run, by the same amount
on pull and release and at every tension; the other channels fit to the end. With a rate of the
session, later runs start further off; this needs `started` in the manifest.
Equation: the reading is the tension plus a drift that starts at a rate and converges exponentially,
as with a sensor that warms up, and a steady one over the session, as of a zero that nobody sets
again; both sensors have one time constant. Not in the paper.
Mistaken for: preload_loss (f_in and f_out fall together, coupled by the sheath's friction);
friction_drift, bend_drift (opposite on pull and release); force_sensor_offset (present from the
start, and constant).
Not validated: creep that follows the force.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import SETTLING, Effect, Parameter
from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.settling import exponential_drift
from tsas_cli.support.arrays import Floats, Values


class ForceSensorDrift(NamedTuple):
    """Rates of each force sensor's drift [N/s] and their inverse time constant in a run [1/s]."""

    f_in_rate_N_per_s: float = 0.0
    f_out_rate_N_per_s: float = 0.0
    settling_per_s: float = 0.0
    f_in_session_rate_N_per_s: float = 0.0
    f_out_session_rate_N_per_s: float = 0.0


@kernel
def drift_reading(force: float, rate: float, settling_per_s: float, time_s: Values) -> Values:
    """Return the reading of a drifting sensor [N] at a time since the drift began."""
    return force + exponential_drift(rate, settling_per_s, time_s)


def reading_in_session(
    force: float, drift: ForceSensorDrift, sensor: int, time_s: Floats | None, session_s: float
) -> Floats | float:
    """Return the reading of a drifting sensor [N], the first (f_in) or the second one (f_out).

    `time_s` counts from the start of the run, None for a run without time, and `session_s` is that
    start since the first run's.
    """
    session_rates = drift.f_in_session_rate_N_per_s, drift.f_out_session_rate_N_per_s
    start = drift_reading(force, session_rates[sensor], 0.0, session_s)
    if drift[sensor] == 0.0 or time_s is None:
        return start
    return drift_reading(start, drift[sensor], drift.settling_per_s, time_s)


FORCE_SENSOR_DRIFT = Effect(
    name="force_sensor_drift",
    title="Drift of a force sensor",
    acts_on="sensor",
    closed_form=True,
    equation="reading = T + rate·(1 − exp(−ν t))/ν + session_rate·t_start",
    doc=__doc__,
    parameters=(
        Parameter("f_in_rate_N_per_s", "N/s", neutral=0.0, start=0.02, lower=-100.0, upper=100.0),
        Parameter("f_out_rate_N_per_s", "N/s", neutral=0.0, start=0.02, lower=-100.0, upper=100.0),
        SETTLING,
        Parameter(
            "f_in_session_rate_N_per_s", "N/s", neutral=0.0, start=0.002, lower=-10.0, upper=10.0
        ),
        Parameter(
            "f_out_session_rate_N_per_s", "N/s", neutral=0.0, start=0.002, lower=-10.0, upper=10.0
        ),
    ),
    experiment="Hang a weight on each force sensor, switch it on, and record for as long as a run.",
)
