"""Inputs of a controller at one sample: the error of x_in, its estimated rates, the reference.

The rates of a sampled, noisy, quantised x_in are not measured. They are estimated from the error
e = x_inv − x_in by a Butterworth filter of third order, whose states are e, de/dt and d²e/dt², all
delayed by 2/(2π f); the reference is known and needs no filter, so that rates of x_in itself are
those of the reference minus those of the error. The filter is exact for an error that is constant
between samples.
"""

import math
from typing import NamedTuple

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.support.arrays import Floats

ORDER = 3


class Signals(NamedTuple):
    """The error x_inv − x_in as measured, filtered with its rates, and the reference."""

    e: float  # [mm], as measured
    e_filtered: float  # [mm]
    de: float  # [mm/s]
    dde: float  # [mm/s²]
    v: float  # of x_inv [mm/s]
    a: float  # [mm/s²]
    jerk: float  # [mm/s³]
    applied: float  # speed applied at the last sample on top of the feedforward [rpm]
    limited: bool  # whether the motor's limit had reduced it


def error_filter(cutoff_Hz: float, step_s: float) -> tuple[Floats, Floats]:
    """Return A, shape (3, 3), and b, shape (3,), of z ← A z + b e for z = (e, de/dt, d²e/dt²)."""
    from scipy.linalg import expm

    w = 2.0 * math.pi * cutoff_Hz
    whole = np.zeros((ORDER + 1, ORDER + 1))
    whole[0, 1] = whole[1, 2] = 1.0
    whole[2] = [-(w**3), -2.0 * w**2, -2.0 * w, w**3]
    step = expm(whole * step_s)
    return np.ascontiguousarray(step[:ORDER, :ORDER]), np.ascontiguousarray(step[:ORDER, ORDER])


@kernel
def filtered(state: Floats, e: float, A: Floats, b: Floats) -> None:
    """Update the filter's state, in place, by one sample of the error."""
    e0, e1, e2 = state[0], state[1], state[2]
    for i in range(3):
        state[i] = A[i, 0] * e0 + A[i, 1] * e1 + A[i, 2] * e2 + b[i] * e
