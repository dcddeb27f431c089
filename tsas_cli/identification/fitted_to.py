"""What a model was fitted to: ranges of the conditions and signals of its recordings.

A model predicts what lies in these ranges; beyond them it extrapolates. A quantity leaves its range
by more than `MARGIN` of the range's width or of its end, whichever is larger. Recordings of one
condition scatter by a few percent, and the tension ratio e^(μθ) changes by a few percent where
friction or bend changes by a tenth; another level of a condition is mostly tens of percent away.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from datetime import date
from typing import Self

import numpy as np
from pydantic import Field, model_validator

from tsas_cli.identification.prepared import Prepared
from tsas_cli.numerics.conditioning import Conditioned
from tsas_cli.recordings.dataset import CONDITIONS
from tsas_cli.recordings.manifest import RigSheet
from tsas_cli.recordings.units import is_unit
from tsas_cli.records.prediction import QuantityOutside
from tsas_cli.support.arrays import Floats
from tsas_cli.support.plausible import LARGEST, AnyNumber
from tsas_cli.support.strict_table import StrictTable

MARGIN = 0.1
CENTRAL_PERCENT = (0.5, 99.5)  # of a tension: single samples are no load
SPEED_PERCENT = 95.0  # of |dx_in/dt|: nearly the fastest part of the motion
SPEED_WINDOWS = 4.0  # of the conditioning, over which a slope is taken: it needs more than a value
STROKE_SHARE = 0.1  # of a stroke, which that window does not exceed
_WITHOUT_DIMENSION = ("deg", "rad", "percent")

Range = tuple[AnyNumber, AnyNumber]


class FittedTo(StrictTable):
    """Ranges by quantity, with its unit in the name, and the words of conditions that have none.

    `f_in_N` and `f_out_N` go over the central 99 % of a run's samples, `f_in_span_N` is its width,
    `stroke_mm` the span of x_in, `speed_mm_per_s` the 95th percentile of |dx_in/dt|; of several
    runs the lowest to the highest.
    """

    ranges: dict[str, Range] = Field(default_factory=dict)
    words: dict[str, tuple[str, ...]] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _ends_are_in_order(self) -> Self:
        for name, (low, high) in self.ranges.items():
            if low > high:
                raise ValueError(f"{name} begins at {low:g}, above its end {high:g}")
        return self


def fitted_to(sheet: RigSheet, runs: Sequence[Prepared]) -> FittedTo:
    """Return the ranges of the conditions and signals of runs, and of the rig's data sheet."""
    ranges: dict[str, Range] = {}
    for name, (low, high) in (one for run in runs for one in _numbers(sheet, run)):
        known = ranges.get(name, (low, high))
        ranges[name] = min(low, known[0]), max(high, known[1])
    words: dict[str, list[str]] = {}
    for name, word in (one for run in runs for one in _words(run)):
        words.setdefault(name, []).append(word)
    return FittedTo(
        ranges=ranges,
        words={
            name: tuple(dict.fromkeys(found))
            for name, found in words.items()
            if name == "load" or len(runs) == 1 or max(Counter(found).values()) > 1
        },
    )


def departures(here: FittedTo, fitted: FittedTo) -> list[QuantityOutside]:
    """Return what of a run leaves the ranges that a model was fitted to."""
    out: list[QuantityOutside] = []
    for name, (low, high) in here.ranges.items():
        known = fitted.ranges.get(name)
        if known is None:
            continue
        width = known[1] - known[0]
        below, above = (MARGIN * max(width, abs(end)) for end in known)
        if low < known[0] - below or high > known[1] + above:
            out.append(QuantityOutside(quantity=name, here=(low, high), fitted=known))
    for name, words in here.words.items():
        stated = fitted.words.get(name)
        if stated is not None and not set(words) <= set(stated):
            out.append(QuantityOutside(quantity=name, here=words, fitted=stated))
    return out


def not_stated(here: FittedTo, fitted: FittedTo) -> list[str]:
    """Return what is known of a run, and not of what a model was fitted to."""
    known = {*fitted.ranges, *fitted.words}
    return [name for name in (*here.ranges, *here.words) if name not in known]


def _numbers(sheet: RigSheet, run: Prepared) -> Iterator[tuple[str, Range]]:
    stated = {name: getattr(sheet, name) for name in type(sheet).model_fields}
    stated |= {name: getattr(run.run, name) for name in CONDITIONS}
    stated |= {name: value for name, value in _further(run) if _is_number(name, value)}
    yield from ((name, (float(v), float(v))) for name, v in stated.items() if v is not None)
    for name in ("f_in_N", "f_out_N"):
        if (values := run.channel(name)) is not None:
            yield name, _ends(values, CENTRAL_PERCENT)
    if (f_in := run.channel("f_in_N")) is not None:
        low, high = _ends(f_in, CENTRAL_PERCENT)
        yield "f_in_span_N", (high - low, high - low)
    if run.drive_column == "x_in_mm":
        x_in = run.conditioned["x_in_mm"]
        stroke = float(np.ptp(x_in.values))
        yield "stroke_mm", (stroke, stroke)
        yield "speed_mm_per_s", _ends(_speeds(run.time_s, x_in), (SPEED_PERCENT, SPEED_PERCENT))
    if run.temperature_C is not None:
        yield "temperature_C", run.temperature_C


def _speeds(time_s: Floats, x_in: Conditioned) -> Floats:
    """Return |dx_in/dt| at all samples [mm/s], shape (n,), over windows that average its noise."""
    stroke_s = (time_s[-1] - time_s[0]) / max(x_in.reversals.size - 1, 1)
    window_s = min(SPEED_WINDOWS * x_in.window_s, STROKE_SHARE * stroke_s)
    if window_s <= 0.0:
        return np.asarray(np.abs(np.gradient(x_in.values, time_s)))
    before, after = time_s - window_s / 2.0, time_s + window_s / 2.0
    moved = np.interp(after, time_s, x_in.values) - np.interp(before, time_s, x_in.values)
    speeds: Floats = np.abs(moved) / window_s
    return speeds


def _ends(values: Floats, percent: Range) -> Range:
    low, high = np.nanpercentile(values, percent)
    return float(low), float(high)


def _words(run: Prepared) -> Iterator[tuple[str, str]]:
    yield "load", run.run.load
    yield from ((n, v) for n, v in _further(run) if isinstance(v, str) and not _is_date(v))


def _further(run: Prepared) -> Iterator[tuple[str, object]]:
    """Yield the conditions that the manifest states beyond those of format 1."""
    yield from (run.run.model_extra or {}).items()


def _is_number(name: str, value: object) -> bool:
    """Return whether a further key is a condition: a number with its unit in the name.

    One without, such as `take`, counts recordings.
    """
    unit = name.rpartition("_")[2]
    if isinstance(value, bool) or not isinstance(value, int | float) or unit == name:
        return False
    return -LARGEST < value < LARGEST and (unit in _WITHOUT_DIMENSION or is_unit(unit))


def _is_date(text: str) -> bool:
    try:
        date.fromisoformat(text[:10])
    except ValueError:
        return False
    return True
