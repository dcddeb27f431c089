"""First-order laws of time: a drift that decays to a steady state, a low pass."""

import numpy as np

from tsas_cli.numerics.compiled import kernel


@kernel
def exponential_drift(rate: float, settling_per_s: float, time_s: float) -> float:
    """Return rate·(1 − exp(−ν t))/ν, which is rate·t where ν is zero.

    Parameters
    ----------
    rate
        Initial rate, in any unit per second.
    settling_per_s
        The inverse ν of the time constant [1/s]; at zero the drift never ends.
    time_s
        Time t since the start [s].
    """
    if settling_per_s == 0.0:
        return rate * time_s
    settled: float = -np.expm1(-settling_per_s * time_s)
    return rate * settled / settling_per_s


@kernel
def lag_after(before: float, rise: float, step_s: float, time_s: float) -> float:
    """Return by how much a first-order low pass lags its input after a step, in the input's unit.

    Exact for an input that rises linearly within the step; none after an infinite one.

    Parameters
    ----------
    before
        Lag at the start of the step.
    rise
        Change of the input over the step.
    step_s
        Length of the step [s].
    time_s
        Time constant, positive [s].
    """
    steps = step_s / time_s
    decay: float = np.exp(-steps)
    after: float = decay * before - np.expm1(-steps) / steps * rise
    return after
