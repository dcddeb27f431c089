"""Sheets of Excel and OpenDocument files, converted to text tables."""

import re
import zipfile
from datetime import date, datetime, time, timedelta
from pathlib import Path
from typing import Any

from tsas_cli.recordings.guards import Expanded, foreign
from tsas_cli.recordings.readers.table import ReadOptions, optional
from tsas_cli.support.errors import InputError, nearest

_NUMBER = re.compile(r"[+-]?\d*[.,]?\d+([eE][+-]?\d+)?")  # as text
_FAULTS = ("#N/A", "#DIV/0!", "#VALUE!", "#REF!", "#NUM!", "#NAME?", "#NULL!")  # of a formula


def tables(path: Path) -> list[str]:
    """Return the names of the sheets with a row of numbers, the longest first.

    InputError: the file is damaged, or python-calamine is not installed.
    """
    sheets = _sheets(path)
    found = [name for name in sheets if _has_numbers(sheets[name])]
    return sorted(found, key=lambda name: -len(sheets[name]))


def convert(path: Path, folder: Path, options: ReadOptions) -> Path:
    """Write a sheet as text with tabs into a folder; return its path. Rows keep their numbers.

    InputError: as from `tables`; or there are several sheets of numbers and the map names none, or
    there is none of that name.
    """
    sheets = _sheets(path)
    found = [name for name in sheets if _has_numbers(sheets[name])]
    chosen = options.table or next(iter(found), None)
    if chosen not in sheets:
        what = f"no sheet {options.table}" if options.table else "no sheet holds numbers"
        raise InputError(what, where=path, remedy=nearest(options.table or "", sheets))
    if options.table is None and len(found) > 1:
        raise InputError(
            f"holds {len(found)} sheets of numbers: {', '.join(found)}",
            where=path,
            expected="one",
            remedy='name it in the map: table = "…" under [read]',
        )
    made = folder / "sheet.tsv"
    with made.open("w", encoding="utf-8") as file:
        for row in sheets[chosen]:
            line = "\t".join(map(_text, row))
            file.write(f"{line if line.strip() else ''}\n")
    return made


def _sheets(path: Path) -> dict[str, list[list[Any]]]:
    """Return the rows of each sheet, from its first row."""
    calamine = optional("python_calamine", extra="excel")
    with foreign(path, "a spreadsheet"):
        if zipfile.is_zipfile(path):
            with zipfile.ZipFile(path) as archive:
                expanded = Expanded.of(path)
                for member in archive.infolist():
                    expanded.add(member.file_size, what=member.filename)
        with calamine.CalamineWorkbook.from_path(path) as book:
            return {
                name: book.get_sheet_by_name(name).to_python(skip_empty_area=False)
                for name in book.sheet_names
            }


def _has_numbers(rows: list[list[Any]]) -> bool:
    numbers = (float, int, date, time, timedelta)
    return any(
        sum(isinstance(c, numbers) or bool(_NUMBER.fullmatch(str(c))) for c in row) > 1
        for row in rows
    )


def _text(cell: Any) -> str:
    if isinstance(cell, timedelta):
        return repr(cell.total_seconds())
    if isinstance(cell, datetime | date | time):
        return cell.isoformat()
    if isinstance(cell, bool | int | float):
        return repr(float(cell))
    return "nan" if cell in _FAULTS else " ".join(str(cell).split())
