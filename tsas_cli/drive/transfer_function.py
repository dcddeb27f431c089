"""The drive's transfer function from motor speed [rpm] to x_in [mm] as an object of python-control.

This is the only file that imports `control`.
"""

import math
from typing import Any

import numpy as np

from tsas_cli.drive.harmonic_drive import DriveValues, lag_coefficients
from tsas_cli.support.arrays import Complex, Floats


def transfer_function(values: DriveValues) -> Any:
    """Return G(s) without its delay, a `control.TransferFunction`; Yang 2025, Eqs. (46), (47)."""
    from control import tf

    denominator = np.polymul([1.0, values.leak_per_s], lag_coefficients(values)[::-1])
    return tf([values.gain_mm_per_s_rpm], denominator, inputs="motor speed", outputs="x_in")


def bode_curve(values: DriveValues, frequency_Hz: Floats) -> tuple[Floats, Floats]:
    """Return magnitude [mm per rpm s] and phase [°] of G e^{−Ts}, shapes (m,)."""
    w = 2.0 * math.pi * frequency_Hz
    response = transfer_function(values).frequency_response(w)
    phase = np.unwrap(np.atleast_1d(response.phase.squeeze())) - w * values.delay_s
    return np.atleast_1d(response.magnitude.squeeze()), np.degrees(phase)


def poles(values: DriveValues) -> Complex:
    """Return the poles of G [rad/s], shape (order,)."""
    return np.asarray(transfer_function(values).poles(), dtype=np.complex128)
