"""Workbooks: the first byte chooses the suffix."""

from pathlib import Path
from tempfile import TemporaryDirectory

from tests.fuzz.rules import Scratch, answer, chosen, read_all
from tests.recordings.readers.workbooks import DATE, save_xlsx
from tsas_cli.recordings.readers import spreadsheet, tables  # noqa: F401 # instrumented
from tsas_cli.recordings.readers.table import ReadOptions

SUFFIXES = (".xlsx", ".xls", ".xlsb", ".ods")
SHARE = 0.1
MOST_BYTES = 6000
WORDS = (b"<row ", b"<c r=", b"<v>", b"PK\x01\x02", b"\xd0\xcf\x11\xe0", b"inlineStr")
_scratch = Scratch()


def one(data):
    suffix, file = chosen(data, SUFFIXES)
    path = _scratch.file(f"a{suffix}", file)
    for table in (None, *(answer(tables, path) or [])[:2]):
        read_all(path, ReadOptions(table=table))


def seeds():
    numbers = [[i, 1.5, (45000.5 + i, DATE)] for i in range(3)]
    rows = [["t", "f", "when"], ["s", "N", None], *numbers]
    with TemporaryDirectory() as name:
        for sheets in ({"Log": rows}, {"Log": rows, "Notes": [["a", "#N/A"], [1, 2]]}):
            yield b"\0" + save_xlsx(Path(name) / "a.xlsx", sheets).read_bytes()
