"""During a run the sheath is bent more, or less.

What one sees: at the same x_in the loop of f_in over f_out opens (or closes) during the run: f_in
drifts up on pulls and down on releases, in proportion to the tension. Every run starts without it.
Equation: Yang 2025, Eq. (7), with the total bend θ(t) of Eq. (6), which starts at a rate and
converges exponentially. The paper's curvature κ(s, t) may change with time, its θ does not.
Mistaken for: friction_drift (only μθ is observable: distinguishable only in runs with different
bends, where a bend drifts by the same angle and friction by the same share); force_sensor_drift,
preload_loss (the same sign on pull and release).
Not validated: the change of the tendon's path length with the bend.
"""

from typing import NamedTuple

import numpy as np

from tsas_cli.effects.effect import SETTLING, Effect, Parameter
from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.settling import exponential_drift


class BendDrift(NamedTuple):
    """Initial rate of the drift [rad/s] and its inverse time constant [1/s]."""

    rate_rad_per_s: float = 0.0
    settling_per_s: float = 0.0


@kernel
def drifted_bend(bend: float, drift: BendDrift, time_s: float) -> float:
    """Return the total bend [rad] at a time since the start of the run, not below 0."""
    drifted = bend + exponential_drift(drift.rate_rad_per_s, drift.settling_per_s, time_s)
    angle: float = np.maximum(drifted, 0.0)
    return angle


BEND_DRIFT = Effect(
    name="bend_drift",
    title="Bend that drifts",
    acts_on="tendon",
    closed_form=False,
    equation="θ(t) = θ + rate·(1 − exp(−ν t))/ν",
    doc=__doc__,
    parameters=(
        Parameter("rate_rad_per_s", "rad/s", neutral=0.0, start=0.005, lower=-10.0, upper=10.0),
        SETTLING,
    ),
    experiment="The same long run with the sheath free and fixed to a board: fixed, the drift "
    "vanishes.",
)
