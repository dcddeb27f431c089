"""A drift that starts at a rate and decays exponentially to a steady state."""

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
