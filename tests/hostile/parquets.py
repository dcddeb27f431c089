"""Parquet files that lie, or that decode to far more than they are; written byte by byte."""

import pickle
import struct
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from tests.hostile.case import Evil, Make, around, cases, columns, ingesting

DOUBLE, TEXT = 5, 6
PLAIN, DICTIONARY = 0, 8
I32, I64, BINARY, LIST, STRUCT = 5, 6, 8, 9, 12  # of Thrift's compact protocol
BILLION = 10**9
MOST = 2**31 - 1  # values that one page can hold


def varint(number: int) -> bytes:
    out = bytearray()
    while number > 0x7F:
        out.append(number & 0x7F | 0x80)
        number >>= 7
    out.append(number)
    return bytes(out)


Value = tuple[int, bytes]  # of Thrift: its type and how it is written


def i32(number: int) -> Value:
    return I32, varint((number << 1) ^ (number >> 63))


def i64(number: int) -> Value:
    return I64, i32(number)[1]


def text(value: str) -> Value:
    return BINARY, varint(len(value)) + value.encode()


def array(items: Sequence[Value]) -> Value:
    kind = items[0][0] if items else STRUCT
    short = len(items) < 15
    size = bytes([(len(items) if short else 15) << 4 | kind])
    return LIST, size + (b"" if short else varint(len(items))) + b"".join(v for _, v in items)


def group(fields: dict[int, Value]) -> Value:
    """Return a struct of fields whose numbers rise."""
    out, last = b"", 0
    for number, (kind, value) in fields.items():
        out += bytes([(number - last) << 4 | kind]) + value
        last = number
    return STRUCT, out + b"\0"


def page(kind: int, content: bytes, header: Value) -> bytes:
    """Return a page of data (0) or of a dictionary (2) behind its header."""
    size = i32(len(content))
    return group({1: i32(kind), 2: size, 3: size, {0: 5, 2: 7}[kind]: header})[1] + content


def repeated(value: bytes, rows: int) -> tuple[bytes, bytes]:
    """Return a dictionary of one value, and pages that say it so often."""
    dictionary = page(2, value, group({1: i32(1), 2: i32(PLAIN)}))
    data = b""
    while rows:
        now = min(rows, MOST)
        rows -= now
        header = group({1: i32(now), 2: i32(DICTIONARY), 3: i32(3), 4: i32(3)})
        data += page(0, b"\x01" + varint(now << 1) + b"\0", header)
    return dictionary, data


def footer(schema: Sequence[Value], rows: int, groups: Sequence[Value]) -> bytes:
    """Return the end of a file."""
    _, meta = group({1: i32(2), 2: array(schema), 3: i64(rows), 4: array(groups)})
    return meta + struct.pack("<I", len(meta)) + b"PAR1"


def parquet(
    path: Path,
    names: Iterable[str],
    *,
    rows: int,
    claimed: int | None = None,
    kind: int = DOUBLE,
    value: bytes = struct.pack("<d", 1.5),
) -> Path:
    """Write columns of one value, `rows` times; the footer says that there are `claimed` rows."""
    said = rows if claimed is None else claimed
    out, chunks, schema = bytearray(b"PAR1"), [], []
    for name in names:
        dictionary, data = repeated(value, rows)
        begin, size = i64(len(out)), i64(len(dictionary) + len(data))
        meta = {1: i32(kind), 2: array([i32(PLAIN), i32(DICTIONARY)]), 3: array([text(name)])}
        meta |= {4: i32(0), 5: i64(said), 6: size, 7: size}
        meta |= {9: i64(len(out) + len(dictionary)), 11: begin}
        chunks.append(group({2: begin, 3: group(meta)}))
        schema.append(group({1: i32(kind), 3: i32(0), 4: text(name)}))
        out += dictionary + data
    root = group({4: text("schema"), 5: i32(len(schema))})
    rows_of_all = group({1: array(chunks), 2: i64(len(out)), 3: i64(said)})
    path.write_bytes(bytes(out) + footer([root, *schema], said, [rows_of_all]))
    return path


CANONICAL = ("time_s", "x_in_mm", "f_in_N")
LONG = struct.pack("<I", 1_000_000) + b"x" * 1_000_000  # a text of 1 MB


def checked(names: Iterable[str] = CANONICAL, **how: Any) -> Make:
    return lambda folder: check(parquet(folder / "a.parquet", names, **how))


def ingested(**how: Any) -> Make:
    return lambda folder: ingesting(parquet(folder / "a.parquet", "txf", **how))


def check(file: Path) -> list[object]:
    return ["check", around(file.parent, file)]


def guessed(folder: Path) -> list[object]:
    return ["ingest", parquet(folder / "a.parquet", "txf", rows=3 * BILLION), "--guess"]


def reference(folder: Path) -> list[object]:
    path = parquet(folder / "r.parquet", ("time_s", "f_out_ref_N"), rows=3 * BILLION)
    return ["track", "--reference", path, "--out", folder / "out"]


def written(table: Callable[[Path], pa.Table], **how: Any) -> Make:
    """Return a maker of a table that pyarrow writes."""

    def make(folder: Path) -> list[object]:
        pq.write_table(table(folder), folder / "a.parquet", **how)
        return check(folder / "a.parquet")

    return make


def text_note(_: Path) -> pa.Table:
    """Forty extra columns that repeat a text of 1 MB, beside honest ones."""
    long = pa.array(["x" * 1_000_000])
    note = pa.DictionaryArray.from_arrays(pa.array([0] * 400, pa.int32()), long)
    return pa.table(columns() | {f"note{i}": note for i in range(40)})


def nested(_: Path) -> pa.Table:
    kind, value = pa.float64(), 1.0
    for _ in range(60):
        kind, value = pa.list_(kind), [value]
    return pa.table(columns(3) | {"deep": pa.array([value] * 3, kind)})


def pickled(folder: Path) -> pa.Table:
    """A column whose type is a pickled Python object, as old versions of Arrow took it."""
    meta = {
        b"ARROW:extension:name": b"arrow.py_extension_type",
        b"ARROW:extension:metadata": pickle.dumps(Evil(folder)),
    }
    fields = [pa.field(n, pa.float64(), metadata=meta) for n in CANONICAL]
    return pa.table(columns(), schema=pa.schema(fields))


def nested_deep(folder: Path) -> list[object]:
    """A schema of groups in groups in groups."""
    deep = group({3: i32(0), 4: text("g"), 5: i32(1)})
    leaf = group({1: i32(DOUBLE), 3: i32(0), 4: text("time_s")})
    (folder / "a.parquet").write_bytes(b"PAR1" + footer([*([deep] * 200_000), leaf], 0, []))
    return check(folder / "a.parquet")


CASES = cases(
    {
        "1000000000 rows, 8 GB or more from a file of 324 bytes": {
            "a footer that claims a billion rows": checked(rows=3, claimed=BILLION),
        },
        "at most 5000 times its size": {
            "a footer that claims 2^62 rows": checked(rows=3, claimed=2**62),
            "run lengths of three billion rows": checked(rows=3 * BILLION),
            "run lengths, ingested": ingested(rows=3 * BILLION),
            "a footer that claims a billion rows, ingested": ingested(rows=3, claimed=BILLION),
            "run lengths, as a reference to track": reference,
            "forces that are long texts": ingested(rows=100_000, kind=TEXT, value=LONG),
        },
        "cannot be read as Parquet": {
            "a footer that claims fewer than no rows": checked(rows=3, claimed=-5),
            "lists in lists": written(nested),
            "groups in groups, 200,000 deep": nested_deep,
        },
        "holds no column of numbers (3000000000 rows": {"run lengths, guessed": guessed},
        "column time_s holds binary": {
            "a time that is long texts": checked(rows=100_000, kind=TEXT, value=LONG),
        },
        "holds 10503 columns; expected at most 10000": {
            "too many columns": checked([*CANONICAL, *(f"c{i}" for i in range(10_500))], rows=3),
        },
        "": {
            "run lengths of two billion rows in three": checked(rows=MOST, claimed=3),
            "an extra column of long texts": written(text_note, store_schema=False),
            "a pickled type": written(pickled),
        },
    }
)
