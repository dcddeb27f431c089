"""The exact response of an integrator with lags to a sampled input, from rest.

    y = 1 / ((s + a) P(s)) · u,   P(s) = p0 + p1 s + … with P(0) = 1 and roots to the left

The integrator is split off, 1/((s + a) P) = R/(s + a) + D(s) with R = 1/P(−a): a discrete filter
of both together has a root at z = 1 near others and loses all its digits. The remainder D is a
stable filter, discretised by the matrix exponential for an input that is constant or linear between
samples.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.support.arrays import Floats

Hold = Literal["zero", "first"]

SLOW = 1e-4  # leak per sample below which its weights are computed by their series


@dataclass(frozen=True)
class Sampled:
    """An input on an even clock, and its exact integral since the first sample, shapes (n,)."""

    step_s: float
    values: Floats
    integral: Floats
    hold: Hold


def sampled(step_s: float, values: Floats, hold: Hold) -> Sampled:
    """Return an input with its integral."""
    rate = values[:-1] if hold == "zero" else 0.5 * (values[:-1] + values[1:])
    return Sampled(step_s, values, np.concatenate(([0.0], step_s * np.cumsum(rate))), hold)


def delayed(u: Sampled, delay_s: float) -> Sampled:
    """Return an input delayed, zero before its first sample.

    A linear one that does not begin at zero rises over one sample.
    """
    if delay_s == 0.0:
        return u
    time = u.step_s * np.arange(u.values.size)
    at = time - delay_s
    index = np.clip(np.floor(at / u.step_s).astype(np.int64), 0, u.values.size - 2)
    part = np.maximum(at - time[index], 0.0)
    first = u.values[index]
    slope = (u.values[index + 1] - first) / u.step_s if u.hold == "first" else np.zeros(at.size)
    since = at >= 0.0
    integral = np.where(since, u.integral[index] + part * (first + 0.5 * slope * part), 0.0)
    if u.hold == "first":
        values = np.where(since, first + slope * part, 0.0)
    else:  # the mean over each step, so that a fraction of a step is not lost
        values = np.append(np.diff(integral) / u.step_s, first[-1])
    return Sampled(u.step_s, values, integral, u.hold)


def integrator_with_lags(u: Sampled, leak_per_s: float, lags: Floats) -> Floats:
    """Return y at each sample, shape (n,), from rest.

    The leak is a [1/s], 0 for an integrator; `lags` are the coefficients p0 = 1, p1 [s], p2 [s²] …
    of P, the last not zero.
    """
    a = leak_per_s * u.step_s
    scaled = lags / u.step_s ** np.arange(lags.size)  # time in samples
    # Synthetic division of 1 − R P by (s + a) gives the numerator of D.
    R = 1.0 / float(np.polynomial.polynomial.polyval(-a, scaled))
    numerator = np.zeros(max(lags.size - 1, 1))
    last = 0.0
    for i in range(lags.size - 1, 0, -1):
        last = -R * scaled[i] - a * last
        numerator[i - 1] = last
    y = R * _leaky(u, a)
    if lags.size > 1:
        y += u.step_s * _filtered(u, numerator, scaled)
    return y


def transients(step_s: float, size: int, leak_per_s: float, lags: Floats) -> Floats:
    """Return the free responses of y from initial states not at rest, shape (n, order)."""
    from scipy.signal import lfilter

    columns = []
    if leak_per_s > 0.0:
        columns.append(np.exp(-leak_per_s * step_s * np.arange(size)))
    order = lags.size - 1
    if order:
        poles = np.exp(np.roots(lags[::-1]) * step_s)
        kick = np.zeros(size)
        kick[0] = 1.0
        decay = lfilter([1.0], np.real(np.poly(poles)), kick)
        columns += [np.concatenate((np.zeros(i), decay[: size - i])) for i in range(order)]
    return np.array(columns).T if columns else np.zeros((size, 0))


def _leaky(u: Sampled, a: float) -> Floats:
    """Return the leaky integral of the input, a the leak per sample."""
    if a == 0.0:
        return u.integral.copy()
    from scipy.signal import lfilter

    weight = -np.expm1(-a) / a
    share = (1.0 - weight) / a if a > SLOW else 0.5 - a / 6.0 + a * a / 24.0
    if u.hold == "first":
        inputs = (weight - share) * u.values[:-1] + share * u.values[1:]
    else:
        inputs = weight * u.values[:-1]
    return np.concatenate(([0.0], u.step_s * lfilter([1.0], [1.0, -np.exp(-a)], inputs)))


def lagged(u: Sampled, lags: Floats) -> Floats:
    """Return 1/P · u at each sample, shape (n,), from rest."""
    if lags.size == 1:
        return u.values
    numerator = np.zeros(lags.size - 1)
    numerator[0] = 1.0
    return _filtered(u, numerator, lags / u.step_s ** np.arange(lags.size))


def _filtered(u: Sampled, numerator: Floats, denominator: Floats) -> Floats:
    """Return the response of a strictly proper filter, shape (n,), with time in samples.

    With x(k+1) = Φ x(k) + Γ0 u(k) + Γ1 u(k+1) and y = C x.
    """
    from scipy.linalg import expm

    order = denominator.size - 1
    whole = np.zeros((order + 2, order + 2))
    whole[: order - 1, 1:order] = np.eye(order - 1)
    whole[order - 1, :order] = -denominator[:-1] / denominator[-1]
    whole[order - 1, order] = 1.0 / denominator[-1]
    whole[order, order + 1] = 1.0
    step = expm(whole)
    constant, ramp = step[:order, order].copy(), step[:order, order + 1].copy()
    if u.hold == "zero":
        ramp[:] = 0.0
    else:
        constant -= ramp
    state = np.ascontiguousarray(step[:order, :order])
    return _stepped(state, constant, ramp, numerator, np.ascontiguousarray(u.values))


@kernel
def _stepped(
    state: Floats, constant: Floats, ramp: Floats, numerator: Floats, values: Floats
) -> Floats:
    order = numerator.size
    x, after = np.zeros(order), np.zeros(order)
    out = np.zeros(values.size)
    for k in range(values.size - 1):
        y = 0.0
        for i in range(order):
            new = constant[i] * values[k] + ramp[i] * values[k + 1]
            for j in range(order):
                new += state[i, j] * x[j]
            after[i] = new
            y += numerator[i] * new
        for i in range(order):
            x[i] = after[i]
        out[k + 1] = y
    return out
