"""Parquet files that lie, or that decode to far more than they are; written byte by byte."""

import struct
from collections.abc import Iterable, Sequence
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from tests.hostile.case import Case, around, columns, ingesting

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
    footer = fields(
        (1, I32, zigzag(2)),
        (2, LIST, listed(STRUCT, [root, *schema])),
        (3, I64, zigzag(said)),
        (4, LIST, listed(STRUCT, [group])),
    )
    path.write_bytes(bytes(out) + footer + struct.pack("<I", len(footer)) + b"PAR1")
    return path


CANONICAL = ("time_s", "x_in_mm", "f_in_N")


def check(folder: Path, file: Path) -> list[object]:
    return ["check", around(folder, file)]


def claims(folder: Path) -> list[object]:
    return check(folder, parquet(folder / "a.parquet", CANONICAL, rows=3, claimed=BILLION))


def decodes(folder: Path) -> list[object]:
    return check(folder, parquet(folder / "a.parquet", CANONICAL, rows=3 * BILLION))


def claims_most(folder: Path) -> list[object]:
    return check(folder, parquet(folder / "a.parquet", CANONICAL, rows=3, claimed=2**62))


def claims_below_zero(folder: Path) -> list[object]:
    return check(folder, parquet(folder / "a.parquet", CANONICAL, rows=3, claimed=-5))


def decodes_in_secret(folder: Path) -> list[object]:
    return check(folder, parquet(folder / "a.parquet", CANONICAL, rows=MOST, claimed=3))


def ingested(folder: Path) -> list[object]:
    return ingesting(parquet(folder / "a.parquet", "txf", rows=3 * BILLION))


def ingested_claim(folder: Path) -> list[object]:
    return ingesting(parquet(folder / "a.parquet", "txf", rows=3, claimed=BILLION))


def guessed(folder: Path) -> list[object]:
    return ["ingest", parquet(folder / "a.parquet", "txf", rows=3 * BILLION), "--guess"]


def reference(folder: Path) -> list[object]:
    path = parquet(folder / "r.parquet", ("time_s", "f_out_ref_N"), rows=3 * BILLION)
    return ["track", "--reference", path, "--out", folder / "out"]


def text_note(folder: Path) -> list[object]:
    """An extra column that repeats a text of 1 MB, beside honest ones."""
    long = ["x" * 1_000_000]
    note = pa.DictionaryArray.from_arrays(pa.array([0] * 400, pa.int32()), pa.array(long))
    path = folder / "a.parquet"
    pq.write_table(
        pa.table({**columns(), **{f"note{i}": note for i in range(40)}}), path, store_schema=False
    )
    return check(folder, path)


def text_force(folder: Path) -> list[object]:
    long = struct.pack("<I", 1_000_000) + b"x" * 1_000_000
    path = parquet(folder / "a.parquet", ("t", "x", "f"), rows=100_000, kind=TEXT, value=long)
    return ingesting(path)


def text_time(folder: Path) -> list[object]:
    long = struct.pack("<I", 1_000_000) + b"x" * 1_000_000
    path = parquet(folder / "a.parquet", CANONICAL, rows=100_000, kind=TEXT, value=long)
    return check(folder, path)


def many_columns(folder: Path) -> list[object]:
    names = [*CANONICAL, *(f"c{i}" for i in range(10_500))]
    return check(folder, parquet(folder / "a.parquet", names, rows=3))


def nested(folder: Path) -> list[object]:
    kind = pa.float64()
    for _ in range(60):
        kind = pa.list_(kind)
    value: object = 1.0
    for _ in range(60):
        value = [value]
    path = folder / "a.parquet"
    table = {**columns(3), "deep": pa.array([value] * 3, kind)}
    pq.write_table(pa.table(table), path)
    return check(folder, path)


def nested_deep(folder: Path) -> list[object]:
    """A schema of groups in groups in groups."""
    group = fields((3, I32, zigzag(0)), (4, BINARY, binary(b"g")), (5, I32, zigzag(1)))
    leaf = fields((1, I32, zigzag(DOUBLE)), (3, I32, zigzag(0)), (4, BINARY, binary(b"time_s")))
    footer = fields(
        (1, I32, zigzag(2)),
        (2, LIST, listed(STRUCT, [*([group] * 200_000), leaf])),
        (3, I64, zigzag(0)),
        (4, LIST, listed(STRUCT, [])),
    )
    path = folder / "a.parquet"
    path.write_bytes(b"PAR1" + footer + struct.pack("<I", len(footer)) + b"PAR1")
    return check(folder, path)


def with_pickle(folder: Path) -> list[object]:
    """A column whose type is a pickled Python object, as old versions of Arrow took it."""
    import pickle

    class Evil:
        def __reduce__(self) -> tuple[object, ...]:
            return (Path.touch, (folder / "touched",))

    plain = columns()
    meta = {
        b"ARROW:extension:name": b"arrow.py_extension_type",
        b"ARROW:extension:metadata": pickle.dumps(Evil()),
    }
    schema = pa.schema([pa.field(n, pa.float64(), metadata=meta) for n in plain])
    path = folder / "a.parquet"
    pq.write_table(pa.table(plain, schema=schema), path)
    return check(folder, path)


CASES = (
    Case(
        "a footer that claims a billion rows",
        claims,
        "1000000000 rows, 8 GB or more from a file of 324 bytes",
    ),
    Case("a footer that claims 2^62 rows", claims_most, "at most 5000 times its size"),
    Case("a footer that claims fewer than no rows", claims_below_zero, "cannot be read as Parquet"),
    Case("run lengths of three billion rows", decodes, "at most 5000 times its size"),
    Case("run lengths of two billion rows in three", decodes_in_secret),
    Case("run lengths, ingested", ingested, "at most 5000 times its size"),
    Case(
        "a footer that claims a billion rows, ingested",
        ingested_claim,
        "at most 5000 times its size",
    ),
    Case("run lengths, guessed", guessed, "holds no column of numbers (3000000000 rows"),
    Case("run lengths, as a reference to track", reference, "at most 5000 times its size"),
    Case("an extra column of long texts", text_note),
    Case("forces that are long texts", text_force, "at most 5000 times its size"),
    Case("a time that is long texts", text_time, "column time_s holds binary"),
    Case(
        "too many columns",
        many_columns,
        "holds 10503 columns; expected at most 10000",
    ),
    Case("lists in lists", nested, "cannot be read as Parquet"),
    Case("groups in groups, 200,000 deep", nested_deep, "cannot be read as Parquet"),
    Case("a pickled type", with_pickle),
)
