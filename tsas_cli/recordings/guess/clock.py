"""The clock among the columns of a file, and its unit."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from tsas_cli.numerics.turning_points import turning_points
from tsas_cli.recordings.columns import TIME
from tsas_cli.recordings.guess.columns import Certainty, FileColumn, Proposed, with_unit
from tsas_cli.recordings.guess.looks import increases, is_even
from tsas_cli.recordings.guess.words import words_of
from tsas_cli.recordings.ingest_map import QUESTION
from tsas_cli.recordings.units import conversion
from tsas_cli.support.arrays import Floats

_USUAL_S = (2.5e-5, 0.2)  # usual sample intervals of a rig
_FASTEST_S, _SLOWEST_S = 5e-6, 2.0
_STROKE_S = (0.02, 500.0)  # plausible strokes of a rig
_UNITS = ("s", "ms", "us", "ns")
_EPOCH_S = (9.4e8, 4.1e9)  # 2000 to 2099, since 1970
_MOST_REPEATS = 0.9  # of the rows: what stays for longer numbers strokes or runs


def clock(columns: Sequence[FileColumn], unusable: Mapping[str, str]) -> Proposed:
    """Return the proposed time of a file, or an open question.

    `unusable` are the columns that hold no numbers, and why.
    """
    named = [c for c in columns if c.quantity == "time"]
    if len(named) > 1:
        named = [c for c in named if c.kind == "time" and increases(c.values)] or named
    even = [c for c in columns if like_a_clock(c)]
    others = [c for c in even if c not in named]
    if len(named) == 1 and not increases(named[0].values) and others:
        return _which(
            [*named, *others], "the column named as a time does not increase, another one does"
        )
    if len(named) == 1:
        return _with_unit(named[0], columns, named=True)
    if named:
        return _which(named, "several columns are named as a time")
    even = [c for c in even if (c.words.quantity or c.words.end) is None or _is_t(c)]
    if len(even) == 1:
        return _with_unit(even[0], columns, named=False)
    if even:
        return _which(even, "several columns increase evenly, as a time does")
    counters = [c for c in columns if c.quantity == "counter" and increases(c.values)]
    why = tuple(f"{c.shown} counts samples" for c in counters) or (
        "no column is named as a time, and none increases evenly",
    )
    asked = "how many samples a second? Or name the clock: source and unit instead."
    named_so = {s: said for s, said in unusable.items() if words_of(s).quantity == "time"}
    for source, said in named_so.items():
        why = (f"{source} is named as a time: {said}",)
        asked = (
            f"{source} cannot be used as the clock: {said}. Write seconds or 2026-03-03 14:05:06.7 "
            f"there. If there is none: {asked}"
        )
    questions = {"rate_Hz": asked}
    return Proposed(TIME, {"rate_Hz": QUESTION}, "open", why, questions)


def interval(column: FileColumn) -> float:
    """Return the typical step of a clock that increases, in its own unit."""
    return float(np.median(np.diff(column.values)))


def repeats(values: Floats) -> int:
    """Return how many rows of a clock that never decreases repeat the time before."""
    steps = np.diff(values)
    rises = bool(np.isfinite(values).all() and (steps >= 0.0).all() and (steps > 0.0).any())
    return int((steps == 0.0).sum()) if rises else 0


def like_a_clock(column: FileColumn) -> bool:
    """Return whether a column increases evenly, and its unit does not exclude a time.

    It may repeat a time in a few rows, as where a device is read faster than its clock counts.
    """
    may_be = column.kind in (None, "label", "time") and column.quantity != "counter"
    values = column.values
    if 0 < repeats(values) <= _MOST_REPEATS * values.size:
        values = np.unique(values)
    return may_be and increases(values) and is_even(values)


def _is_t(column: FileColumn) -> bool:
    """Return whether a tension by its name may be a time, such as Simulink's `tout`."""
    return column.words.matched.get("quantity") == "t"


def _which(found: Sequence[FileColumn], why: str) -> Proposed:
    questions = {"source": f"which one is the clock: {', '.join(c.shown for c in found)}?"}
    return Proposed(
        TIME, {"source": QUESTION}, "open", (why,), questions, (), tuple(c.source for c in found)
    )


def _with_unit(column: FileColumn, columns: Sequence[FileColumn], *, named: bool) -> Proposed:
    why = column.reasons
    if repeats(column.values):
        why.append("it repeats in some rows")
        column = replace(column, values=np.unique(column.values))
    if not increases(column.values):
        why.append("it stops or decreases somewhere; ingest will refuse it and name the row")
        entry, questions = with_unit(column, TIME)
        return Proposed(TIME, entry, "open" if questions else "likely", tuple(why), questions)
    why.append("it increases from row to row" + (", evenly" if is_even(column.values) else ""))
    entry = {"source": column.source}
    unit, sentence, others = _unit(column, _rows_per_stroke(columns, column))
    questions = {"unit": sentence} if unit == QUESTION else {}
    if unit:
        entry["unit"] = unit
    if sentence and not questions:
        why.append(sentence)
    if abs(float(column.values[0])) > 0.5 * interval(column):
        entry["offset"] = "first"
        why.append(f"it begins at {column.values[0]:.6g}, which becomes 0")
    certainty: Certainty = "sure" if named and column.kind == "time" else "likely"
    return Proposed(TIME, entry, "open" if questions else certainty, tuple(why), questions, others)


def _unit(column: FileColumn, rows: float) -> tuple[str, str, tuple[str, ...]]:
    """Return the unit for the map, the reason or the question, and alternative units.

    The unit is empty if ingest finds it in the file. A stated unit has to result in a plausible
    sample rate and stroke duration (of `rows` rows); without one, exactly one unit has to, among
    which a slow logger counts if its strokes are plausible.
    """
    step = interval(column)
    if column.kind == "time":
        seconds = _seconds(step, column.unit)
        slow = seconds >= _USUAL_S[1] and seconds * rows > _STROKE_S[1]
        if seconds >= _FASTEST_S and seconds * rows >= _STROKE_S[0] and not slow:
            return "" if column.own_unit else column.unit, "", ()
        stated = f"its stated unit {column.unit} means {_rate(seconds)} and "
        stated += f"{seconds * column.values.size:.3g} s in total"
        return QUESTION, f"{stated}; {_listed(step)}", ()
    likely = []
    for unit in _UNITS:
        interval_s = _seconds(step, unit)
        slow = unit == "s" and _USUAL_S[1] < interval_s <= _SLOWEST_S
        if _USUAL_S[0] <= interval_s <= _USUAL_S[1] or (slow and interval_s * rows <= _STROKE_S[1]):
            likely.append(unit)
    first = float(column.values[0])
    since_1970 = [u for u in _UNITS if _EPOCH_S[0] <= _seconds(first, u) <= _EPOCH_S[1]]
    likely = [unit for unit in likely if unit in since_1970] or likely
    counts = step == 1.0 and bool((column.values == np.round(column.values)).all())
    if len(likely) != 1 or counts:
        or_count = "; if it counts samples, rate_Hz in place of source and unit" if counts else ""
        return QUESTION, f"no unit is stated; {_listed(step)}{or_count}", ()
    (unit,) = likely
    others = [f"{u}: {_rate(_seconds(step, u))}" for u in (*_UNITS, "min") if u != unit]
    return unit, f"no unit is stated; {unit} means {_rate(_seconds(step, unit))}", tuple(others)


def _seconds(step: float, unit: str) -> float:
    return step * conversion(unit, "s")[0]


def _listed(step: float) -> str:
    return ", ".join(f"{unit} means {_rate(_seconds(step, unit))}" for unit in _UNITS)


def _rate(interval_s: float) -> str:
    return f"{1.0 / interval_s:.4g} Hz"


def _rows_per_stroke(columns: Sequence[FileColumn], clock: FileColumn) -> float:
    """Return the rows per stroke, as the median over the channels that move."""
    rows = []
    for column in columns:
        values = column.values[np.isfinite(column.values)]
        if column is clock or values.size < 2 or np.ptp(values) == 0.0:
            continue
        reversals = turning_points(np.ascontiguousarray(values), 0.5 * float(np.ptp(values)))
        rows.append(values.size / max(reversals.size - 1, 1))
    return float(np.median(rows)) if rows else float(clock.values.size)
