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


def zigzag(number: int) -> bytes:
    return varint((number << 1) ^ (number >> 63))


def binary(text: bytes) -> bytes:
    return varint(len(text)) + text


def listed(kind: int, items: Sequence[bytes]) -> bytes:
    short = len(items) < 15
    return (
        bytes([(len(items) if short else 15) << 4 | kind])
        + (b"" if short else varint(len(items)))
        + b"".join(items)
    )


def fields(*members: tuple[int, int, bytes]) -> bytes:
    """Return a Thrift struct of (id, type, encoded value), ids rising."""
    out, last = b"", 0
    for number, kind, value in members:
        out += bytes([(number - last) << 4 | kind]) + value
        last = number
    return out + b"\0"


def page(kind: int, content: bytes, header: bytes, *, unpacked: int | None = None) -> bytes:
    """Return a page behind its header; `unpacked` is the size that it claims."""
    at = {0: 5, 2: 7}[kind]
    return (
        fields(
            (1, I32, zigzag(kind)),
            (2, I32, zigzag(len(content) if unpacked is None else unpacked)),
            (3, I32, zigzag(len(content))),
            (at, STRUCT, header),
        )
        + content
    )


def repeated(value: bytes, rows: int) -> tuple[bytes, bytes]:
    """Return a dictionary of one value, and pages that say it so often."""
    dictionary = page(2, value, fields((1, I32, zigzag(1)), (2, I32, zigzag(PLAIN))))
    data = b""
    while rows:
        now = min(rows, MOST)
        rows -= now
        header = fields(
            (1, I32, zigzag(now)),
            (2, I32, zigzag(DICTIONARY)),
            (3, I32, zigzag(3)),
            (4, I32, zigzag(3)),
        )
        data += page(0, b"\x01" + varint(now << 1) + b"\0", header)
    return dictionary, data


def footer(schema: Sequence[bytes], rows: int, groups: Sequence[bytes]) -> bytes:
    """Return the end of a file."""
    meta = fields(
        (1, I32, zigzag(2)),
        (2, LIST, listed(STRUCT, schema)),
        (3, I64, zigzag(rows)),
        (4, LIST, listed(STRUCT, groups)),
    )
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
        size = len(dictionary) + len(data)
        meta = fields(
            (1, I32, zigzag(kind)),
            (2, LIST, listed(I32, [zigzag(PLAIN), zigzag(DICTIONARY)])),
            (3, LIST, listed(BINARY, [binary(name.encode())])),
            (4, I32, zigzag(0)),
            (5, I64, zigzag(said)),
            (6, I64, zigzag(size)),
            (7, I64, zigzag(size)),
            (9, I64, zigzag(len(out) + len(dictionary))),
            (11, I64, zigzag(len(out))),
        )
        chunks.append(fields((2, I64, zigzag(len(out))), (3, STRUCT, meta)))
        schema.append(
            fields((1, I32, zigzag(kind)), (3, I32, zigzag(0)), (4, BINARY, binary(name.encode())))
        )
        out += dictionary + data
    root = fields((4, BINARY, binary(b"schema")), (5, I32, zigzag(len(schema))))
    group = fields(
        (1, LIST, listed(STRUCT, chunks)), (2, I64, zigzag(len(out))), (3, I64, zigzag(said))
    )
    path.write_bytes(bytes(out) + footer([root, *schema], said, [group]))
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
    group = fields((3, I32, zigzag(0)), (4, BINARY, binary(b"g")), (5, I32, zigzag(1)))
    leaf = fields((1, I32, zigzag(DOUBLE)), (3, I32, zigzag(0)), (4, BINARY, binary(b"time_s")))
    (folder / "a.parquet").write_bytes(b"PAR1" + footer([*([group] * 200_000), leaf], 0, []))
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
