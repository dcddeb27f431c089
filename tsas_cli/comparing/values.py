"""The values of two models, pair by pair, and the interval of each difference."""

import math
from collections.abc import Mapping
from typing import Literal

from tsas_cli.comparing.sides import Side
from tsas_cli.identification.estimate import Estimate
from tsas_cli.records.base import ParameterValue, parameters_of
from tsas_cli.records.comparison import ParameterPair, ValueDifference

AnyEstimate = Estimate | ParameterValue
Overlap = Literal["none", "some", "all", "unknown"]
MOST_DECIMALS = 10
FALSE_CLAIMS = 0.05  # of intervals of 95 % that exclude a difference of zero by chance


def rounded(value: float, low: float, high: float) -> tuple[str, str, str]:
    """Return a value and its interval, cut at the second digit of the interval's half width.

    >>> rounded(0.024987, 0.024969, 0.025005)
    ('0.024987', '0.024969', '0.025005')
    """
    width = (high - low) / 2.0
    decimals = max(1 - math.floor(math.log10(width)), 0) if width > 0.0 else MOST_DECIMALS
    if decimals >= MOST_DECIMALS:
        return f"{value:.4g}", f"{low:.4g}", f"{high:.4g}"
    return f"{value:.{decimals}f}", f"{low:.{decimals}f}", f"{high:.{decimals}f}"


def overlap(a: Side, b: Side) -> Overlap:
    """Say how many of the recordings that the two fits have read are the same, by checksum."""
    if a.recordings is None or b.recordings is None:
        return "unknown"
    first, second = set(a.recordings.values()), set(b.recordings.values())
    if not first & second:
        return "none"
    return "all" if first == second else "some"


def same_runs(a: Mapping[str, str], b: Mapping[str, str]) -> dict[str, str]:
    """Return, by the id in A, the id in B of each recording that both hold, by checksum.

    A recording that one side holds twice goes with the one of the same name, else the first.
    """
    out: dict[str, str] = {}
    for run, digest in a.items():
        there = [other for other, known in b.items() if known == digest]
        free = [other for other in there if other not in out.values()]
        if free:
            out[run] = run if run in free else free[0]
    return out


def pairs(a: Side, b: Side) -> list[ParameterPair]:
    """Return the parameters of two models in the order of A's, then those in B alone.

    What belongs to a run alone is paired where both were fitted to that recording.
    """
    if a.model is None or b.model is None:
        return []
    runs = same_runs(a.recordings or {}, b.recordings or {})
    how = overlap(a, b)
    first, others = (parameters_of(side.estimates) for side in (a.model, b.model))
    second = {(e.name, e.run): e for e in others}
    out = []
    for one in first:
        there = one.run is None or one.run in runs
        other = second.pop((one.name, runs.get(one.run or "")), None) if there else None
        found = None if other is None else _difference(one, other, how)
        out.append(ParameterPair(name=one.name, unit=one.unit, a=one, b=other, difference=found))
    return out + [ParameterPair(name=e.name, unit=e.unit, b=e) for e in second.values()]


def difference(a: AnyEstimate, b: AnyEstimate) -> ValueDifference:
    """Return B less A with its 95 % interval, for estimates whose errors are independent.

    The interval goes as far below as A above and B below in quadrature, and the other way round:
    low = d − √((b − b_low)² + (a_high − a)²), high = d + √((b_high − b)² + (a − a_low)²). For
    symmetric intervals of normal errors that is exact; for others Zou and Donner 2008, Statistics
    in Medicine 27:1693, "recovery of variance estimates".

    ValueError: one of them has no interval.
    """
    ends = a.value, a.interval_low, a.interval_high, b.value, b.interval_low, b.interval_high
    known = [end for end in ends if end is not None]
    if len(known) < len(ends):
        raise ValueError(f"{a.name} has no interval")
    at_a, a_low, a_high, at_b, b_low, b_high = known
    value = at_b - at_a
    low = value - math.hypot(at_b - b_low, a_high - at_a)
    high = value + math.hypot(b_high - at_b, at_a - a_low)
    apart = low > 0.0 or high < 0.0
    return ValueDifference(value=value, low=low, high=high, excludes_zero=apart)


def _difference(a: ParameterValue, b: ParameterValue, how: Overlap) -> ValueDifference | None:
    """Return the difference, with an interval where one may be claimed."""
    why = ""
    if any(e.interval_low is None or e.interval_high is None for e in (a, b)):
        why = "not estimated on both sides"
    elif a.at_bound or b.at_bound:
        why = "at its bound"
    elif how != "none":
        why = "not known to be independent" if how == "unknown" else "the same recordings"
    if a.value is None or b.value is None:
        return None
    return ValueDifference(value=b.value - a.value, why_none=why) if why else difference(a, b)
