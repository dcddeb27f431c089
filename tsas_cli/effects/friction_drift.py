"""Friction grows or falls with time, within a run and from run to run.

What one sees: at the same x_in the loop of f_in over f_out opens (or closes) during the run: f_in
drifts up on pulls and down on releases, in proportion to the tension. With a rate of the session,
later runs start with a wider (or narrower) loop; this needs `started` in the manifest.
Equation: Yang 2025, Eq. (7), with μ(t): a drift that starts at a rate and converges exponentially,
as in running in and warming up, and a steady one over the session, as in wear. The paper's μ is
constant.
Mistaken for: bend_drift (only μθ is observable: distinguishable only in runs with different bends,
where friction drifts by the same share); force_sensor_drift, preload_loss (the same sign on pull
and release).
Not validated: friction that recovers in a pause, or changes with the travel instead of the time.
"""

from typing import NamedTuple

import numpy as np

from tsas_cli.effects.effect import SETTLING, Effect, Parameter
from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.settling import exponential_drift


class FrictionDrift(NamedTuple):
    """Initial rate in a run, inverse time constant, steady rate over the session [all 1/s]."""

    rate_per_s: float = 0.0
    settling_per_s: float = 0.0
    session_rate_per_s: float = 0.0


@kernel
def friction_factor(drift: FrictionDrift, time_s: float, session_s: float) -> float:
    """Return the factor of the friction coefficient, not below 0.

    `time_s` counts from the start of the run, `session_s` is the start of the run since that of
    the first run.
    """
    run = exponential_drift(drift.rate_per_s, drift.settling_per_s, time_s)
    factor: float = np.maximum(1.0 + run + drift.session_rate_per_s * session_s, 0.0)
    return factor


FRICTION_DRIFT = Effect(
    name="friction_drift",
    title="Friction that drifts",
    acts_on="tendon",
    closed_form=False,
    equation="μ(t) = μ·(1 + rate·(1 − exp(−ν t))/ν + session_rate·t_start)",
    doc=__doc__,
    parameters=(
        Parameter("rate_per_s", "1/s", neutral=0.0, start=0.002, lower=-1.0, upper=1.0),
        SETTLING,
        Parameter("session_rate_per_s", "1/s", neutral=0.0, start=0.0005, lower=-1.0, upper=1.0),
    ),
    experiment="The same long run at two bends with the sheath fixed to a board: ln(f_in/f_out) "
    "drifts by the same share at both.",
)
