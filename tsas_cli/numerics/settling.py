"""First-order laws of time: a drift that decays to a steady state, a low pass."""

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.support.arrays import Values


@kernel
def exponential_drift(rate: float, settling_per_s: float, time_s: Values) -> Values:
    """Return rate·(1 − exp(−ν t))/ν, which is rate·t where ν is zero: a drift that never ends.

    The initial rate is in any unit per second, ν [1/s] the inverse of the time constant.
    """
    if settling_per_s == 0.0:
        return rate * time_s
    settled: Values = -np.expm1(-settling_per_s * time_s)
    return rate * settled / settling_per_s


@kernel
def lag_after(before: float, rise: float, step_s: float, time_s: float) -> float:
    """Return by how much a first-order low pass lags its input after a step, in the input's unit.

    Exact for an input that rises linearly within the step; none after an infinite one. `before` is
    the lag at the start of the step, `rise` the change of the input over it, `time_s` the time
    constant, positive.
    """
    steps = step_s / time_s
    decay: float = np.exp(-steps)
    after: float = decay * before - np.expm1(-steps) / steps * rise
    return after
