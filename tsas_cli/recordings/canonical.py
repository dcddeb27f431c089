"""Canonical columns of a recording, converted from the columns of a file."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt

from tsas_cli.recordings.columns import BY_NAME, TIME
from tsas_cli.recordings.ingest_map import ColumnMap, IngestMap
from tsas_cli.recordings.readers.table import ColumnTable
from tsas_cli.recordings.units import conversion
from tsas_cli.support.arrays import Floats, Mask
from tsas_cli.support.errors import InputError
from tsas_cli.support.wording import count_of


@dataclass(frozen=True)
class PrecedingRows:
    """State that the preceding parts of a file hand to the next part.

    `read` counts the preceding rows, `kept` those that are written; `offsets` are the zeros of
    columns with `offset = "first"`, `last` is the last row. Both are empty before the first part.
    """

    read: int = 0
    kept: int = 0
    offsets: Mapping[str, float] = field(default_factory=dict)
    last: Mapping[str, float] = field(default_factory=dict)


def canonical_columns(
    table: ColumnTable,
    mapping: IngestMap,
    path: Path,
    map_path: Path,
    before: PrecedingRows | None = None,
) -> tuple[dict[str, Floats], PrecedingRows]:
    """Return the canonical columns in their units, shape (n,), the extra ones, and the next state.

    The table is a file, or a part of it; `before` is the state after the preceding part, None at
    the beginning of a file.

    InputError: a unit is missing or does not fit, columns differ in length, a value is infinite,
    the time is not strictly increasing, or there are fewer than two samples.
    """
    lengths = {source: values.size for source, values in table.columns.items()}
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"{source} has {n}" for source, n in lengths.items())
        raise InputError(f"columns differ in length: {listed}", where=path, expected="one length")
    rows = max(lengths.values())
    if rows < (1 if before else 2):
        raise InputError(count_of(rows, "row"), where=path, expected="at least two samples")
    before = before or PrecedingRows()
    columns, offsets = dict[str, Floats](), dict(before.offsets)
    if unitless := {n: c.source for n, c in mapping.columns.items() if not _unit(c, table)}:
        raise InputError(
            f"the file states no unit for {', '.join(map(str, unitless.values()))}",
            where=f"{map_path}, columns.{', '.join(unitless)}",
            remedy='set it in the map: unit = "…"',
        )
    for name, column in mapping.columns.items():
        where = f"{map_path}, columns.{name}"
        with np.errstate(over="ignore"):  # infinite values are refused below, with their row
            values = _converted(name, column, table, rows, where, first=before.read)
        if not isinstance(column.offset, str):
            offsets[name] = column.offset
        elif name not in offsets and np.isfinite(values).any():
            offsets[name] = float(values[np.isfinite(values)][0])
        columns[name] = values - offsets.get(name, 0.0)
    for source in mapping.read.extra:
        name = source if isinstance(source, str) else f"column_{source}"
        if name in columns or not name.isprintable():
            raise InputError(f"extra column {name!r} cannot keep this name", where=path)
        columns[name] = table.columns[source]
    numbers = table.row_numbers
    last = {name: float(values[-1]) for name, values in columns.items()}
    if mapping.read.drop_repeated_rows:
        kept = _differs_from_row_before(columns, before.last)
        columns = {name: values[kept] for name, values in columns.items()}
        numbers = numbers[kept]
    _check_values(columns, before.last.get(TIME), numbers, path)
    kept_rows = before.kept + columns[TIME].size
    return columns, PrecedingRows(before.read + rows, kept_rows, offsets, last)


def _converted(
    name: str, column: ColumnMap, table: ColumnTable, rows: int, where: str, *, first: int
) -> Floats:
    """Return a column in its canonical unit; `first` is the number of its first row, from 0."""
    values: Floats
    if column.rate_Hz is not None:
        values = np.arange(first, first + rows) / column.rate_Hz
    else:
        values = table.columns[column.source]
    unit = _unit(column, table)
    if column.source in table.typed and unit != table.units[column.source]:
        raise InputError(
            f"the map sets unit {unit} for {column.source}, whose data type implies its unit",
            where=where,
            expected=f"{table.units[column.source]}, or no unit",
        )
    slope, intercept = conversion(
        unit,
        BY_NAME[name].unit,
        factor=column.factor,
        factor_unit=column.factor_unit,
        pulley_radius_mm=column.pulley_radius_mm,
        where=where,
    )
    return values * (column.sign * slope) + column.sign * intercept


def _unit(column: ColumnMap, table: ColumnTable) -> str:
    """Return the unit of a column in its file, empty text without one."""
    if column.rate_Hz is not None:
        return "s"
    source = column.source
    named = BY_NAME[str(source)].unit if source in BY_NAME else ""  # the name ends with its unit
    return column.unit or table.units.get(source, "") or named


def _differs_from_row_before(columns: Mapping[str, Floats], last: Mapping[str, float]) -> Mask:
    """Return which rows differ from the preceding one but for time, shape (n,).

    `last` precedes the first.
    """
    differs = np.zeros(columns[TIME].size, dtype=np.bool_)
    differs[0] = not last
    for name, values in columns.items():
        if name == TIME:
            continue
        before = np.concatenate(([last.get(name, np.nan)], values[:-1]))
        differs |= (values != before) & ~(np.isnan(values) & np.isnan(before))
    return differs


def _check_values(
    columns: Mapping[str, Floats], last_s: float | None, numbers: npt.NDArray[np.int64], path: Path
) -> None:
    """Refuse infinite values and times that do not increase; `numbers` are those of the rows."""
    for name, values in columns.items():
        if name in BY_NAME and np.isinf(values).any():
            row = numbers[int(np.isinf(values).argmax())]
            raise InputError(f"{name} is infinite", where=f"{path}, row {row}", expected="a number")
    time_s = columns[TIME]
    if np.isnan(time_s).any():
        row = numbers[int(np.isnan(time_s).argmax())]
        raise InputError("the time is empty", where=f"{path}, row {row}", expected="a time")
    if last_s is None:
        numbers = numbers[1:]
    else:
        time_s = np.concatenate(([last_s], time_s))
    steps = np.diff(time_s)
    if (steps <= 0.0).any():
        i = int((steps <= 0.0).argmax())
        repeated = steps[i] == 0.0
        raise InputError(
            f"the time does not increase ({time_s[i]:.9g} s, then {time_s[i + 1]:.9g} s)",
            where=f"{path}, row {numbers[i]}",
            expected="strictly increasing time",
            remedy='set repeated_times = "first", "last" or "mean" under [read] of the map'
            if repeated
            else "correct the file",
        )
