"""Text tables, whatever is in them; what two ways of reading a table both take, they read alike."""

import numpy as np
import pyarrow as pa

from tests.fuzz.rules import Broken, Scratch, answer
from tsas_cli.recordings.readers import delimited, names, read
from tsas_cli.recordings.readers.layout import detect
from tsas_cli.recordings.readers.table import ReadOptions

SHARE = 20
WORDS = (b"time_s", b"[mm]", b"1e308", b"-1.5", b"nan", b"NULL", b"\r\n", b"\xef\xbb\xbf", b"1,5")
OPTIONS = tuple(
    ReadOptions.model_validate(said)
    for said in (
        {},
        {"encoding": "cp1252"},
        {"encoding": "utf-16"},
        {"delimiter": ";", "decimal": ","},
        {"delimiter": " "},
        {"delimiter": "\t", "units_row": True},
        {"skip_lines": 2, "units_row": False},
        {"delimiter": ",", "decimal": "."},
    )
)
_scratch = Scratch()


def one(data):
    """The first byte chooses the options, the rest is the file."""
    options = OPTIONS[data[0] % len(OPTIONS)] if data else OPTIONS[0]
    path = _scratch.file("a.csv", data[1:])
    listed = answer(names, path, options)
    if listed is None:
        return
    every = list(range(1, len(listed) + 1))[:20]
    table = answer(read, path, options, every)
    if table is None:
        for source in every:
            answer(read, path, options, [source])
        return
    if {values.dtype for values in table.columns.values()} - {np.dtype(np.float64)}:
        raise Broken("a column is not float64")
    _both_ways(path, options, every)


def _both_ways(path, options, every):  # type: ignore[no-untyped-def]
    layout = detect(path, options)
    at = {source: source - 1 for source in every}
    try:
        table = delimited._fast(path, options, layout, at).read_all()
    except pa.ArrowException:
        return
    rows = answer(lambda: list(delimited._line_by_line(path, options, layout, at)))
    fast = {source: table.column(str(i)).to_numpy() for source, i in at.items()}
    slow = None if rows is None else dict(zip(at, np.reshape(rows, (-1, len(at))).T, strict=True))
    for source in every:
        if slow is not None and not np.array_equal(fast[source], slow[source], equal_nan=True):
            raise Broken(f"column {source} is {fast[source]} or {slow[source]}")


def seeds():
    yield b"\0time_s,x [mm],f (N)\n0,1.5,2\n0.1,,NaN\n0.2,1e3,-4\n"
    yield b"\0# rig 3\n# time;x\n0;1\n1;2\n"
    yield "\1Zeit;Weg\ns;µm\n0,0;1,5\n0,1;2,5\n".encode("cp1252")
    yield b"\2" + "t\tx\n0\t1\n1\t2\n".encode("utf-16")
    yield b"\3t;x\n0,5;1\n1;-2,5e3\n"
    yield b"\4  t   x\n 0.0  1\n 1.0  2\n"
    yield b'\5t\tx\ns\tmm\n"0"\t1\n1\t2\n'
    yield b"\6made by\nlogger\n0,1\n1,2\n"
    yield b'\7"a,b",c\n1,2\n3,4\n'
