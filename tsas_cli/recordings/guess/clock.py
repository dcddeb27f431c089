"""Which column is the clock, and in which unit."""

from collections.abc import Sequence

import numpy as np

from tsas_cli.numerics.turning_points import turning_points
from tsas_cli.recordings.columns import TIME
from tsas_cli.recordings.guess.columns import Column
from tsas_cli.recordings.guess.looks import increases, is_even
from tsas_cli.recordings.guess.proposed import Proposed, Sureness, with_unit
from tsas_cli.recordings.ingest_map import QUESTION
from tsas_cli.recordings.units import conversion

_USUAL_S = (2.5e-5, 0.2)  # sample intervals of a rig that nobody has to explain
_FASTEST_S = 5e-6
_STROKE_S = (0.02, 500.0)  # strokes that a rig makes
_UNITS = ("s", "ms", "us")


def clock(columns: Sequence[Column]) -> Proposed:
    """Return the time of a file, or the question for it."""
    named = [c for c in columns if c.quantity == "time"]
    if len(named) > 1:
        named = [c for c in named if c.kind == "time" and increases(c.values)] or named
    even = [c for c in columns if like_a_clock(c)]
    if len(named) == 1 and not increases(named[0].values) and even:
        return _which([*named, *even], "what is called a time does not increase, another does")
    if len(named) == 1:
        return _with_unit(named[0], columns, named=True)
    if named:
        return _which(named, "several columns are called a time")
    even = [c for c in even if c.words.quantity is None and c.words.place is None]
    if len(even) == 1:
        return _with_unit(even[0], columns, named=False)
    if even:
        return _which(even, "several columns increase evenly, as a time does")
    counters = [c for c in columns if c.quantity == "counter" and increases(c.values)]
    why = tuple(f"{c.shown} counts samples" for c in counters) or (
        "no column is called a time, and none increases evenly",
    )
    asked = {"rate_Hz": "how many samples a second? Or name the clock: source and unit instead."}
    return Proposed(TIME, {"rate_Hz": QUESTION}, "open", why, asked)


def interval(column: Column) -> float:
    """Return the typical step of a clock that increases, in its own unit."""
    return float(np.median(np.diff(column.values)))


def like_a_clock(column: Column) -> bool:
    """Say whether a column increases evenly, and no unit says that it is no time."""
    may_be = column.kind in (None, "label", "time") and column.quantity != "counter"
    return may_be and increases(column.values) and is_even(column.values)


def _which(found: Sequence[Column], why: str) -> Proposed:
    asked = {"source": f"which one is the clock: {', '.join(c.shown for c in found)}?"}
    return Proposed(TIME, {"source": QUESTION}, "open", (why,), asked)


def _with_unit(column: Column, columns: Sequence[Column], *, named: bool) -> Proposed:
    why = column.reasons
    if not increases(column.values):
        why.append("it stands still or runs backwards somewhere, which ingest refuses with the row")
        entry, asked = with_unit(column, TIME)
        return Proposed(TIME, entry, "open" if asked else "likely", tuple(why), asked)
    why.append("it increases from row to row" + (", evenly" if is_even(column.values) else ""))
    entry = {"source": column.source}
    unit, sentence, others = _unit(column, _rows_per_stroke(columns, column))
    asked = {"unit": sentence} if unit == QUESTION else {}
    if unit:
        entry["unit"] = unit
    if sentence and not asked:
        why.append(sentence)
    if abs(float(column.values[0])) > 0.5 * interval(column):
        entry["offset"] = "first"
        why.append(f"it begins at {column.values[0]:.6g}, which becomes 0")
    sure: Sureness = "sure" if named and column.kind == "time" else "likely"
    return Proposed(TIME, entry, "open" if asked else sure, tuple(why), asked, others)


def _unit(column: Column, rows: float) -> tuple[str, str, tuple[str, ...]]:
    """Return the unit that a map has to say, the reason or the question, and other units.

    Empty where ingest finds it by itself. A unit that is said has to make a rate and strokes (of
    so many rows) that a rig has; without one, only one unit may do so.
    """
    step = interval(column)
    if column.kind == "time":
        seconds = _seconds(step, column.unit)
        if not _odd(seconds, rows):
            return "" if column.own_unit else column.unit, "", ()
        said = f"its unit is said to be {column.unit}, which makes {_rate(seconds)} and "
        said += f"{seconds * column.values.size:.3g} s in all"
        return QUESTION, f"{said}; {_listed(step)}", ()
    likely = [unit for unit in _UNITS if _usual(step, unit)]
    counts = step == 1.0 and bool((column.values == np.round(column.values)).all())
    if len(likely) != 1 or counts:
        or_count = "; if it counts samples, rate_Hz in place of source and unit" if counts else ""
        return QUESTION, f"no unit is said; {_listed(step)}{or_count}", ()
    (unit,) = likely
    others = [f"{u}: {_rate(_seconds(step, u))}" for u in (*_UNITS, "min") if u != unit]
    return unit, f"no unit is said; {unit} makes {_rate(_seconds(step, unit))}", tuple(others)


def _odd(interval_s: float, rows: float) -> bool:
    slow = interval_s >= _USUAL_S[1] and interval_s * rows > _STROKE_S[1]
    return interval_s < _FASTEST_S or interval_s * rows < _STROKE_S[0] or slow


def _usual(step: float, unit: str) -> bool:
    return _USUAL_S[0] <= _seconds(step, unit) <= _USUAL_S[1]


def _seconds(step: float, unit: str) -> float:
    return step * conversion(unit, "s")[0]


def _listed(step: float) -> str:
    return ", ".join(f"{unit} makes {_rate(_seconds(step, unit))}" for unit in _UNITS)


def _rate(interval_s: float) -> str:
    return f"{1.0 / interval_s:.4g} Hz"


def _rows_per_stroke(columns: Sequence[Column], clock: Column) -> float:
    """Return how many rows a stroke takes, by the median of the channels that move."""
    rows = []
    for column in columns:
        values = column.values[np.isfinite(column.values)]
        if column is clock or values.size < 2 or np.ptp(values) == 0.0:
            continue
        turns = turning_points(np.ascontiguousarray(values), 0.5 * float(np.ptp(values)))
        rows.append(values.size / max(turns.size - 1, 1))
    return float(np.median(rows)) if rows else float(clock.values.size)
