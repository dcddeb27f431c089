"""The anchor of the load spring yields and the preload falls during a run.

What one sees: at the same x_in f_out falls during the run, equally on pulls and releases, and f_in
with it, by e^(μθ) times as much on a pull and by e^(−μθ) on a release. The line of f_out over
x_out shifts down in parallel.
Equation: the load of Yang 2025, Eq. (9), with a preload that falls at an initial rate and converges
exponentially, as with an anchor that slides or a spring that sags. The paper's F0 is constant.
Mistaken for: force_sensor_drift (one force channel alone, or both by amounts that the sheath's
friction does not couple); load_relaxation (comes back); friction_drift, bend_drift (opposite on
pull and release).
Not validated: a tendon that creeps, where f_out over x_out stays on its line; a loss that depends
on the tension; a loss that persists from one run to the next.
"""

from typing import NamedTuple

from tsas_cli.effects.effect import SETTLING, Effect, Parameter
from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.settling import exponential_drift


class PreloadLoss(NamedTuple):
    """Initial rate of the loss [N/s] and its inverse time constant [1/s]."""

    rate_N_per_s: float = 0.0
    settling_per_s: float = 0.0


@kernel
def lost_preload(loss: PreloadLoss, time_s: float) -> float:
    """Return the loss of spring force [N] at a time since the start of the run."""
    return exponential_drift(loss.rate_N_per_s, loss.settling_per_s, time_s)


PRELOAD_LOSS = Effect(
    name="preload_loss",
    title="Loss of preload",
    acts_on="load",
    closed_form=False,
    equation="spring force = F0 − rate·(1 − exp(−ν t))/ν + kL·x",
    doc=__doc__,
    parameters=(
        Parameter("rate_N_per_s", "N/s", neutral=0.0, start=0.02, lower=0.0, upper=1000.0),
        SETTLING,
    ),
    experiment="Keep x_in constant for minutes and measure the anchor with a dial gauge: it moves "
    "by the loss divided by the spring's stiffness.",
)
