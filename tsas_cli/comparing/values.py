"""The values of two models, pair by pair, and the interval of each difference."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from tsas_cli.comparing.sides import Side
from tsas_cli.identification.estimate import Estimate

Overlap = Literal["none", "some", "all", "unknown"]
MOST_DECIMALS = 10
FALSE_CLAIMS = 0.05  # of intervals of 95 % that exclude a difference of zero by chance


@dataclass(frozen=True)
class Difference:
    """B less A in the parameter's unit; without an interval where there is none, and why."""

    value: float
    low: float | None = None
    high: float | None = None
    why_none: str = ""

    @property
    def excludes_zero(self) -> bool | None:
        """Whether the difference is more than its uncertainty, None where that is not known."""
        if self.low is None or self.high is None:
            return None
        return self.low > 0.0 or self.high < 0.0

    def text(self) -> str:
        """Return value and interval for a printed table."""
        if self.low is None or self.high is None:
            return f"{self.value:.4g}"
        value, low, high = rounded(self.value, self.low, self.high)
        return f"{value} [{low}, {high}]"


@dataclass(frozen=True)
class Pair:
    """One parameter in both models, or in one of them; `run_a` and `run_b` are run ids there."""

    name: str
    unit: str
    a: Estimate | None
    b: Estimate | None
    difference: Difference | None = None

    @property
    def run(self) -> str:
        """The run that the value belongs to, under both names where they differ."""
        ids = (None if side is None else side.run for side in (self.a, self.b))
        return shared_name(*ids) or "all"


def rounded(value: float, low: float, high: float) -> tuple[str, str, str]:
    """Return a value and its interval, cut at the second digit of the interval's half width.

    Examples
    --------
    >>> rounded(0.024987, 0.024969, 0.025005)
    ('0.024987', '0.024969', '0.025005')
    """
    width = (high - low) / 2.0
    decimals = max(1 - math.floor(math.log10(width)), 0) if width > 0.0 else MOST_DECIMALS
    if decimals >= MOST_DECIMALS:
        return f"{value:.4g}", f"{low:.4g}", f"{high:.4g}"
    return f"{value:.{decimals}f}", f"{low:.{decimals}f}", f"{high:.{decimals}f}"


def shared_name(a: str | None, b: str | None) -> str:
    """Return a run's id; both where the same recording has two.

    Examples
    --------
    >>> shared_name("a", "a"), shared_name("a", "first"), shared_name(None, "b")
    ('a', 'a = first', 'b')
    """
    return " = ".join(dict.fromkeys(name for name in (a, b) if name))


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


def pairs(a: Side, b: Side) -> list[Pair]:
    """Return the parameters of two models in the order of A's, then those in B alone.

    What belongs to a run alone is paired where both were fitted to that recording.
    """
    if a.model is None or b.model is None:
        return []
    runs = same_runs(a.recordings or {}, b.recordings or {})
    how = overlap(a, b)
    second = {(e.name, e.run): e for e in b.model.estimates}
    out = []
    for one in a.model.estimates:
        there = one.run is None or one.run in runs
        other = second.pop((one.name, runs.get(one.run or "")), None) if there else None
        found = None if other is None else _difference(one, other, how)
        out.append(Pair(one.name, one.unit, one, other, found))
    return out + [Pair(e.name, e.unit, None, e) for e in second.values()]


def difference(a: Estimate, b: Estimate) -> Difference:
    """Return B less A with its 95 % interval, for estimates whose errors are independent.

    The interval goes as far below as A above and B below in quadrature, and the other way round:
    low = d − √((b − b_low)² + (a_high − a)²), high = d + √((b_high − b)² + (a − a_low)²). For
    symmetric intervals of normal errors that is exact; for others Zou and Donner 2008, Statistics
    in Medicine 27:1693, "recovery of variance estimates".

    Raises
    ------
    ValueError
        One of them has no interval.
    """
    a_ends, b_ends = (a.interval_low, a.interval_high), (b.interval_low, b.interval_high)
    if None in a_ends or None in b_ends:
        raise ValueError(f"{a.name} has no interval")
    (a_low, a_high), (b_low, b_high) = a_ends, b_ends
    value = b.value - a.value
    return Difference(
        value,
        value - math.hypot(b.value - b_low, a_high - a.value),  # type: ignore[operator]
        value + math.hypot(b_high - b.value, a.value - a_low),  # type: ignore[operator]
    )


def _difference(a: Estimate, b: Estimate, how: Overlap) -> Difference:
    """Return the difference, with an interval where one may be claimed."""
    why = ""
    if any(e.interval_low is None or e.interval_high is None for e in (a, b)):
        why = "not estimated on both sides"
    elif a.at_bound or b.at_bound:
        why = "at its bound"
    elif how != "none":
        why = "not known to be independent" if how == "unknown" else "the same recordings"
    return Difference(b.value - a.value, why_none=why) if why else difference(a, b)
