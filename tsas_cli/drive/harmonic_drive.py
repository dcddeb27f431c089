"""The harmonic drive from motor speed u to the tendon's end x_in, with its imperfections.

Yang 2025, Eqs. (23)-(25), with F_in − F0 = k_p x (24), and Eqs. (46)-(51):

    τ dw/dt + w = u(t − T)                              the motor follows the commanded speed
    dx_m/dt = K w − a x_m,  K = 2π r1/(60 im)           position of a stiff drive
    p = play(x_m + ripple)                              the gear's ripple and play
    (J/r1²) d²x/dt² + B dx/dt + k_p x = k_d (p − x)     the drive's stiffness, with reaction

Eq. (25) has k_d p on the right-hand side: no reaction on the position. From u and x alone one
identifies G(s) = g e^{−Ts} / ((s + a)(τs + 1)(s²/ω² + 2ζs/ω + 1)); with the reaction
g = K k_d/(k_d + k_p) and ω² = (k_d + k_p) r1²/J, without it g = K k_d/k_p and ω² = k_p r1²/J. Only
ratios of J, B, k_d and k_p are identifiable: the others follow from the data sheet's J.
Not validated: play with a spring behind it is modelled by the play operator, as if without load.
"""

import math
from typing import NamedTuple

import numpy as np

from tsas_cli.effects.backlash import follow_play
from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.linear_response import (
    Sampled,
    delayed,
    integrator_with_lags,
    lagged,
    sampled,
    transients,
)
from tsas_cli.numerics.wave import Wave, rippled
from tsas_cli.support.arrays import Floats

WAVES = 2.0  # of the ripple, per revolution of the wave generator, which is the motor's
SECONDS_PER_MINUTE = 60.0


class DriveValues(NamedTuple):
    """The parameters of a drive; zero means absent, a frequency of zero a stiff drive."""

    gain_mm_per_s_rpm: float
    motor_lag_s: float = 0.0
    delay_s: float = 0.0
    leak_per_s: float = 0.0
    natural_frequency_Hz: float = 0.0
    damping_ratio: float = 0.0
    sine_mm: float = 0.0
    cosine_mm: float = 0.0
    play_mm: float = 0.0


def lag_coefficients(values: DriveValues) -> Floats:
    """Return p0 = 1, p1 … of (τs + 1)(s²/ω² + 2ζs/ω + 1), without absent factors."""
    lags = np.ones(1)
    if values.motor_lag_s > 0.0:
        lags = np.array([1.0, values.motor_lag_s])
    if values.natural_frequency_Hz > 0.0:
        lags = np.convolve(lags, _spring(values))
    return lags


def _spring(values: DriveValues) -> Floats:
    w = 2.0 * math.pi * values.natural_frequency_Hz
    return np.array([1.0, 2.0 * values.damping_ratio / w, 1.0 / (w * w)])


def linear_response(u: Sampled, values: DriveValues) -> Floats:
    """Return x_in − x_in(0) [mm] of a perfect gear from rest, at each sample of u [rpm], (n,)."""
    input_delayed = delayed(u, values.delay_s)
    response = integrator_with_lags(input_delayed, values.leak_per_s, lag_coefficients(values))
    return np.asarray(values.gain_mm_per_s_rpm * response)


def gear_response(u: Sampled, values: DriveValues, start_mm: float) -> Floats:
    """Return the contribution of the gear's ripple and play to x_in [mm], shape (n,).

    `start_mm` is the initial x_in: it determines the angle of the wave generator, whose waves are
    zero at x_in = 0.
    """
    input_delayed = delayed(u, values.delay_s)
    motor = np.array([1.0, values.motor_lag_s]) if values.motor_lag_s > 0.0 else np.ones(1)
    g = values.gain_mm_per_s_rpm
    stiff = g * integrator_with_lags(input_delayed, values.leak_per_s, motor)
    period = g * SECONDS_PER_MINUTE / WAVES
    ripple = Wave(float(values.sine_mm), float(values.cosine_mm), period)
    error = _through_gear(stiff, float(start_mm), ripple, float(values.play_mm)) - stiff
    if values.natural_frequency_Hz == 0.0:
        return error
    return lagged(sampled(u.step_s, error, "first"), _spring(values))


def has_gear(values: DriveValues) -> bool:
    """Return whether the gear has ripple or play."""
    return values.sine_mm != 0.0 or values.cosine_mm != 0.0 or values.play_mm != 0.0


def free_motion(u: Sampled, values: DriveValues) -> Floats:
    """Return the free responses of a drive from initial states not at rest, shape (n, order)."""
    lags = lag_coefficients(values)
    return transients(u.step_s, u.values.size, values.leak_per_s, lags)


@kernel
def _through_gear(stiff: Floats, start: float, ripple: Wave, play: float) -> Floats:
    """Return the positions of the gear's output, from the middle of its play, shape (n,)."""
    out = np.empty(stiff.size)
    unmoved = rippled(start, ripple) - start
    position = 0.0
    for i in range(stiff.size):
        moved = rippled(start + stiff[i], ripple) - start - unmoved
        position = follow_play(position, moved, play)
        out[i] = position
    return out
