"""From the columns of a file to the canonical columns of a recording."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import numpy.typing as npt

from tsas_cli.errors import InputError
from tsas_cli.recordings.columns import BY_NAME, TIME
from tsas_cli.recordings.ingest_map import ColumnMap, IngestMap
from tsas_cli.recordings.readers.table import Floats, Table
from tsas_cli.recordings.units import conversion


def canonical_columns(
    table: Table, mapping: IngestMap, path: Path, map_path: Path
) -> dict[str, Floats]:
    """Return the canonical columns in their units, and the extra columns as they are.

    Raises
    ------
    InputError
        A unit is missing or does not fit, columns differ in length, a value is infinite, the time
        is not strictly increasing, or fewer than two samples are there.
    """
    rows = _rows(table, path)
    columns = {
        name: _converted(name, column, table, rows, f"{map_path}, columns.{name}")
        for name, column in mapping.columns.items()
    }
    for source in mapping.read.extra:
        name = source if isinstance(source, str) else f"column_{source}"
        if name in columns or not name.isprintable():
            raise InputError(f"extra column {name!r} cannot keep this name", where=path)
        columns[name] = table.columns[source]
    if mapping.read.drop_repeated_rows:
        kept = _differs_from_row_before(columns)
        columns = {name: values[kept] for name, values in columns.items()}
    _check_values(columns, table.first_row, path)
    return columns


def _rows(table: Table, path: Path) -> int:
    lengths = {source: values.size for source, values in table.columns.items()}
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"{source} has {n}" for source, n in lengths.items())
        raise InputError(f"columns differ in length: {listed}", where=path, expected="one length")
    rows = max(lengths.values())
    if rows < 2:
        raise InputError(f"{rows} rows", where=path, expected="at least two samples")
    return rows


def _converted(name: str, column: ColumnMap, table: Table, rows: int, where: str) -> Floats:
    values, unit = _raw(column, table, rows)
    if not unit:
        raise InputError(
            f"the file does not say the unit of {column.source}",
            where=where,
            remedy='say it in the map: unit = "…"',
        )
    slope, intercept = conversion(
        unit,
        BY_NAME[name].unit,
        factor=column.factor,
        factor_unit=column.factor_unit,
        pulley_radius_mm=column.pulley_radius_mm,
        where=where,
    )
    values = values * (column.sign * slope) + column.sign * intercept
    return values - _offset(values, column.offset)


def _raw(column: ColumnMap, table: Table, rows: int) -> tuple[Floats, str | None]:
    """Return the values as they are in the file, and their unit."""
    if column.rate_Hz is not None:
        return np.arange(rows) / column.rate_Hz, "s"
    return table.columns[column.source], column.unit or table.units.get(column.source)


def _offset(values: Floats, offset: float | str) -> float:
    if not isinstance(offset, str):
        return offset
    there = values[np.isfinite(values)]
    return float(there[0]) if there.size else 0.0


def _differs_from_row_before(
    columns: Mapping[str, Floats],
) -> npt.NDArray[np.bool_]:
    differs = np.zeros(columns[TIME].size, dtype=np.bool_)
    differs[0] = True
    for values in columns.values():
        both_gaps = np.isnan(values[1:]) & np.isnan(values[:-1])
        differs[1:] |= (values[1:] != values[:-1]) & ~both_gaps
    return differs


def _check_values(columns: Mapping[str, Floats], first_row: int, path: Path) -> None:
    for name, values in columns.items():
        if name in BY_NAME and np.isinf(values).any():
            row = first_row + int(np.isinf(values).argmax())
            raise InputError(f"{name} is infinite", where=f"{path}, row {row}", expected="a number")
    time_s = columns[TIME]
    if np.isnan(time_s).any():
        row = first_row + int(np.isnan(time_s).argmax())
        raise InputError("the time is empty", where=f"{path}, row {row}", expected="a time")
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
