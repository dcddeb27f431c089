"""From the columns of a file to the canonical columns of a recording."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt

from tsas_cli.recordings.columns import BY_NAME, TIME
from tsas_cli.recordings.ingest_map import ColumnMap, IngestMap
from tsas_cli.recordings.readers.table import Floats, Table
from tsas_cli.recordings.units import conversion
from tsas_cli.support.errors import InputError


@dataclass(frozen=True)
class Before:
    """What the parts of a file before one mean for it.

    `read` counts the rows before, `kept` those of them that stay; `offsets` are the zeros of
    columns that begin at their first sample, `last` is the row before. Both stand empty before the
    first part.
    """

    read: int = 0
    kept: int = 0
    offsets: Mapping[str, float] = field(default_factory=dict)
    last: Mapping[str, float] = field(default_factory=dict)


def canonical_columns(
    table: Table, mapping: IngestMap, path: Path, map_path: Path, before: Before | None = None
) -> tuple[dict[str, Floats], Before]:
    """Return the canonical columns in their units, and the extra columns as they are.

    Parameters
    ----------
    table
        A file, or a part of it.
    before
        What came with the part before this one; None at the beginning of a file.

    Returns
    -------
    columns, before
        The columns by name, shape (n,), and what the next part has to know.

    Raises
    ------
    InputError
        A unit is missing or does not fit, columns differ in length, a value is infinite, the time
        is not strictly increasing, or fewer than two samples are there.
    """
    rows = _rows(table, path, fewest=1 if before else 2)
    before = before or Before()
    columns, offsets = dict[str, Floats](), dict(before.offsets)
    for name, column in mapping.columns.items():
        where = f"{map_path}, columns.{name}"
        with np.errstate(over="ignore"):  # what is infinite is refused below, with its row
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
    last = {name: float(values[-1]) for name, values in columns.items()}
    if mapping.read.drop_repeated_rows:
        kept = _differs_from_row_before(columns, before.last)
        columns = {name: values[kept] for name, values in columns.items()}
    first_row = table.first_row - before.read + before.kept
    _check_values(columns, before.last.get(TIME), first_row, path)
    kept_rows = before.kept + columns[TIME].size
    return columns, Before(before.read + rows, kept_rows, offsets, last)


def _rows(table: Table, path: Path, *, fewest: int) -> int:
    lengths = {source: values.size for source, values in table.columns.items()}
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"{source} has {n}" for source, n in lengths.items())
        raise InputError(f"columns differ in length: {listed}", where=path, expected="one length")
    rows = max(lengths.values())
    if rows < fewest:
        raise InputError(f"{rows} rows", where=path, expected="at least two samples")
    return rows


def _converted(
    name: str, column: ColumnMap, table: Table, rows: int, where: str, *, first: int
) -> Floats:
    """Return a column in its canonical unit; `first` is the number of its first row, from 0."""
    values, unit = _raw(column, table, rows, first)
    if not unit:
        raise InputError(
            f"the file does not say the unit of {column.source}",
            where=where,
            remedy='say it in the map: unit = "…"',
        )
    if column.source in table.typed and unit != table.units[column.source]:
        raise InputError(
            f"the map says {unit} of {column.source}, whose type has a unit of its own",
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


def _raw(column: ColumnMap, table: Table, rows: int, first: int) -> tuple[Floats, str | None]:
    """Return the values as they are in the file, and their unit."""
    if column.rate_Hz is not None:
        return np.arange(first, first + rows) / column.rate_Hz, "s"
    return table.columns[column.source], column.unit or table.units.get(column.source)


def _differs_from_row_before(
    columns: Mapping[str, Floats], last: Mapping[str, float]
) -> npt.NDArray[np.bool_]:
    """Return which rows differ from the one before; `last` is that before the first one, if any."""
    differs = np.zeros(columns[TIME].size, dtype=np.bool_)
    differs[0] = not last
    for name, values in columns.items():
        if last:
            differs[0] |= _differ(values[:1], np.array([last[name]]))[0]
        differs[1:] |= _differ(values[1:], values[:-1])
    return differs


def _differ(values: Floats, others: Floats) -> npt.NDArray[np.bool_]:
    differ: npt.NDArray[np.bool_] = (values != others) & ~(np.isnan(values) & np.isnan(others))
    return differ


def _check_values(
    columns: Mapping[str, Floats], last_s: float | None, first_row: int, path: Path
) -> None:
    for name, values in columns.items():
        if name in BY_NAME and np.isinf(values).any():
            row = first_row + int(np.isinf(values).argmax())
            raise InputError(f"{name} is infinite", where=f"{path}, row {row}", expected="a number")
    time_s = columns[TIME]
    if np.isnan(time_s).any():
        row = first_row + int(np.isnan(time_s).argmax())
        raise InputError("the time is empty", where=f"{path}, row {row}", expected="a time")
    if last_s is not None:
        time_s, first_row = np.concatenate(([last_s], time_s)), first_row - 1
    stands = np.diff(time_s) <= 0
    if stands.any():
        i = int(stands.argmax())
        raise InputError(
            f"the time does not increase ({time_s[i]:.9g} s, then {time_s[i + 1]:.9g} s)",
            where=f"{path}, row {first_row + i + 1}",
            expected="strictly increasing time",
            remedy="mend the file; rows that only repeat go with drop_repeated_rows = true "
            "under [read] of the map",
        )
