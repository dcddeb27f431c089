"""Workbooks: the first byte chooses the suffix."""

from collections.abc import Iterable
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.fuzz.rules import Scratch, answer
from tests.recordings.readers.workbooks import DATE, save_xlsx
from tsas_cli.recordings.readers import names, read, spreadsheet, tables  # noqa: F401 # instrumented
from tsas_cli.recordings.readers.table import ReadOptions

SUFFIXES = (".xlsx", ".xls", ".xlsb", ".ods")
SHARE = 0.1
MOST_BYTES = 6000
WORDS = (b"<row ", b"<c r=", b"<v>", b"PK\x01\x02", b"\xd0\xcf\x11\xe0", b"inlineStr")
_scratch = Scratch()


def one(data: bytes) -> None:
    """The rest is the file."""
    path = _scratch.file(f"a{SUFFIXES[data[0] % 4] if data else '.xlsx'}", data[1:])
    for table in (None, *(answer(tables, path) or [])[:2]):
        options = ReadOptions(table=table)
        listed = answer(names, path, options)
        if listed is not None:
            answer(read, path, options, list(range(1, len(listed) + 1))[:20])


def seeds() -> Iterable[bytes]:
    """Numbers, dates, faults and text on one sheet, and on two."""
    rows = [
        ["t", "f", "when"],
        ["s", "N", None],
        *[[i, 1.5, (45000.5 + i, DATE)] for i in range(3)],
    ]
    with TemporaryDirectory() as name:
        for sheets in ({"Log": rows}, {"Log": rows, "Notes": [["a", "#N/A"], [1, 2]]}):
            yield b"\0" + save_xlsx(Path(name) / "a.xlsx", sheets).read_bytes()
