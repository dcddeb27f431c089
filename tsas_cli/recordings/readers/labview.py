"""LabVIEW measurement files (`.lvm`), converted to text tables."""

from collections.abc import Iterator
from pathlib import Path

from tsas_cli.recordings.readers.layout import encoding_of
from tsas_cli.recordings.readers.table import ReadOptions
from tsas_cli.support import limits
from tsas_cli.support.errors import InputError

_END = "***End_of_Header***"
_SEPARATORS = {"Tab": "\t", "Comma": ","}


def convert(path: Path, folder: Path, options: ReadOptions) -> Path:
    """Write the samples with names and units as text with tabs into a folder; return its path.

    InputError: it is no such file, or its segments have different channels.
    """
    made = folder / "samples.tsv"
    with (
        path.open(encoding=encoding_of(path), errors="replace") as lines,
        made.open("w", encoding=options.encoding) as file,
    ):
        for cells in _rows(limits.lines(lines, path), path):
            file.write("\t".join(cells) + "\n")
    return made


def _rows(lines: Iterator[str], path: Path) -> Iterator[list[str]]:
    """Yield names, units and samples. A segment begins with a header of its own."""
    head: dict[str, list[str]] = {}
    names: list[str] = []
    above, samples = True, 0
    for row, line in enumerate(lines, start=1):
        separator = _SEPARATORS.get(head.get("Separator", ["Tab"])[0], "\t")
        cells = [cell.strip() for cell in line.rstrip("\r\n").split(separator)]
        if cells[0] == "Channels":
            above, samples = True, 0
        if above and cells[0] == "X_Value":
            above, here = False, cells[: -1 if cells[-1] == "Comment" else None]
            if not names:
                names = here
                yield names
                time = "s" if head.get("X_Dimension", ["Time"])[0] == "Time" else ""
                stated = iter(head.get("Y_Unit_Label", []))
                yield [time if name == "X_Value" else next(stated, "") for name in names]
            elif here != names:
                raise InputError(
                    "its segments have different channels",
                    where=f"{path}, row {row}",
                    expected=", ".join(names),
                    remedy="save each segment to a file of its own",
                )
        elif above and any(cells[1:]):
            head[cells[0]] = [cell for cell in cells[1:] if cell]
        elif not above and any(cells):
            if head.get("Decimal_Separator") == [","]:
                cells = [cell.replace(",", ".") for cell in cells]
            if head.get("X_Columns") == ["No"]:
                cells[0] = repr(_interval(head, path) * samples)
            samples += 1
            yield cells[: len(names)]
    if not names:
        raise InputError(f"has no {_END} with a row X_Value below", where=path, expected="LVM")


def _interval(head: dict[str, list[str]], path: Path) -> float:
    """Return the interval of a segment without times."""
    try:
        return float(head["Delta_X"][0].replace(",", "."))
    except (KeyError, IndexError, ValueError) as error:
        raise InputError("states neither times nor Delta_X", where=path) from error
