"""The simple form of a fitted curve, as a clause of a sentence: nothing where it has none."""

import math

import numpy as np

from tsas_cli.records.base import number_text
from tsas_cli.support.arrays import Floats

CLOSE = 0.1  # largest error of a form that is said, over the span of the curve
LAMBDAS = 200  # travels of decay that are tried, over five decades


def straight_line(heights: Floats) -> str:
    """Return that a curve of evenly spaced points, shape (n,), is a line, with its error."""
    x = np.arange(heights.size, dtype=np.float64)
    slope, level = map(float, np.polyfit(x, heights, 1))
    return _clause("in a straight line", heights, slope * x + level)


def exponential(travel_mm: Floats, change: Floats) -> str:
    """Return that a curve, shape (n,), approaches its last value exponentially over the travel."""
    lambdas = travel_mm[-1] * np.geomspace(1e-5, 1.0, LAMBDAS)
    left = np.exp(-travel_mm / lambdas[:, None])
    forms = change[-1] + (change[0] - change[-1]) * left
    best = int(np.argmin(np.abs(forms - change).max(axis=1)))
    decay = number_text(float(lambdas[best]), ".2g")
    return _clause(f"as 1 − exp(−travel/{decay} mm)", change, forms[best])


def power(speeds: Floats, factors: Floats) -> str:
    """Return that factors at some speeds, shape (n,), are a power of the speed."""
    if not (factors > 0.0).all():
        return ""
    exponent, level = np.polyfit(np.log(speeds), np.log(factors), 1)
    form = math.exp(level) * speeds**exponent
    as_power = f"as |v|^{number_text(float(exponent), '.2g')}"
    return _clause(as_power, factors, form)


def _clause(form: str, curve: Floats, values: Floats) -> str:
    span, error = float(np.ptp(curve)), float(np.abs(values - curve).max())
    if span == 0.0 or error > CLOSE * span:
        return ""
    percent = f"{100.0 * error / span:.0f}"
    return f", {form}" if percent == "0" else f", {form} to within {percent} % of that"
