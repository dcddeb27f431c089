"""JSON Lines: one record or row a line, converted to a JSON table."""

from pathlib import Path

from tsas_cli.recordings.readers.table import ReadOptions
from tsas_cli.support import limits
from tsas_cli.support.errors import InputError


def convert(path: Path, folder: Path, options: ReadOptions, known: frozenset[str]) -> Path:
    """Write the lines as one JSON list into a folder; return its path.

    InputError: the file is not UTF-8.
    """
    del options, known
    made = folder / "lines.json"
    before = "["
    try:
        with path.open(encoding="utf-8-sig") as lines, made.open("w", encoding="utf-8") as file:
            for line in limits.lines(lines, path):
                if line.strip():
                    file.write(before + line.rstrip())
                    before = ",\n"
            file.write("]" if before != "[" else "[]")
    except UnicodeError as error:
        raise InputError("is not UTF-8", where=path, expected="JSON Lines") from error
    return made
