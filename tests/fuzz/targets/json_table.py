"""JSON tables, whatever is in them."""

import json
from collections.abc import Iterable

from tests.fuzz.documents import after_a_byte, json_document
from tests.fuzz.rules import Scratch, answer
from tsas_cli.recordings.readers import json_table, names, read
from tsas_cli.recordings.readers.table import ReadOptions

TABLES = (None, "data", "log.rows", "", ".")
SHARE = 50
WORDS = (b'"columns"', b"null", b"NaN", b"Infinity", b"1e999", b"[[", b"[{", b"\\ud800")
mutate = after_a_byte(json_document)
_scratch = Scratch()


def one(data: bytes) -> None:
    """The first byte chooses the key of the table, the rest is the file."""
    options = ReadOptions(table=TABLES[data[0] % len(TABLES)] if data else None)
    path = _scratch.file("a.json", data[1:])
    answer(json_table.tables, path)
    listed = answer(names, path, options)
    if listed is None:
        return
    answer(read, path, options, [*dict.fromkeys(listed)][:20])
    answer(read, path, options, [*range(1, len(listed) + 1)][:20])


def seeds() -> Iterable[bytes]:
    """A table in each of the forms that are read."""
    rows = [[0.0, 1, None], [0.1, 2.5, -3]]
    yield b"\0" + json.dumps(rows).encode()
    yield b"\0" + json.dumps([{"t": 0, "x": 1.5}, {"t": 0.1, "y": None}]).encode()
    yield b"\1" + json.dumps({"rig": 3, "columns": ["t", "x", "y"], "data": rows}).encode()
    yield b"\2" + json.dumps({"log": {"unit": "mm", "rows": {"t": [0, 1], "x": [1, 2]}}}).encode()
