"""JSON tables, whatever is in them."""

import json

from tests.fuzz.documents import after_a_byte, json_document
from tests.fuzz.rules import Scratch, answer, chosen, read_all
from tsas_cli.recordings.readers import json_table, names, read
from tsas_cli.recordings.readers.table import ReadOptions

TABLES = (None, "data", "log.rows", "", ".")
SHARE = 50
WORDS = (b'"columns"', b"null", b"NaN", b"Infinity", b"1e999", b"[[", b"[{", b"\\ud800")
mutate = after_a_byte(json_document)
_scratch = Scratch()


def one(data):
    """The first byte chooses the key of the table, the rest is the file."""
    table, file = chosen(data, TABLES)
    path, options = _scratch.file("a.json", file), ReadOptions(table=table)
    answer(json_table.tables, path)
    read_all(path, options)
    listed = answer(names, path, options)
    if listed is not None:
        answer(read, path, options, [*dict.fromkeys(listed)][:20])


def seeds():
    rows = [[0.0, 1, None], [0.1, 2.5, -3]]
    yield b"\0" + json.dumps(rows).encode()
    yield b"\0" + json.dumps([{"t": 0, "x": 1.5}, {"t": 0.1, "y": None}]).encode()
    yield b"\1" + json.dumps({"rig": 3, "columns": ["t", "x", "y"], "data": rows}).encode()
    yield b"\2" + json.dumps({"log": {"unit": "mm", "rows": {"t": [0, 1], "x": [1, 2]}}}).encode()
