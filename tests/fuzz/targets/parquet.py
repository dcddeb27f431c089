"""Parquet files of any tool."""

import io

import pyarrow as pa
import pyarrow.parquet as pq

from tests.fuzz.rules import PLAIN, Scratch, answer, read_all
from tsas_cli.recordings.readers import names, read
from tsas_cli.recordings.readers import parquet as _reader  # noqa: F401 # to be instrumented

SHARE = 35
WORDS = (b"PAR1", b"\x15\x00", b"\x15\x02", b"\x15\x04\x19", b"unit", b"\xff\xff\xff\x7f")
MOST_BYTES = 6000
_scratch = Scratch()


def one(data):
    path = _scratch.file("a.parquet", data)
    read_all(path)
    for source in list(dict.fromkeys(answer(names, path, PLAIN) or ()))[:20]:
        answer(read, path, PLAIN, [source])


def seeds():
    mm = pa.field("x_in_mm", pa.float64(), metadata={"unit": "mm"})
    table = pa.table(
        {"time_s": [0.0, 0.1, 0.2], "x_in_mm": [1.0, None, 3.0], "f_in_N": [1, 2, 3]},
        schema=pa.schema([("time_s", pa.float64()), mm, ("f_in_N", pa.int32())]),
    )
    yield parquet(table, use_dictionary=False, compression="zstd", use_byte_stream_split=["time_s"])
    yield parquet(table, compression="snappy")
    yield parquet(table, compression="none", data_page_version="2.0", store_schema=False)
    other = pa.table(
        {
            "word": ["a", None],
            "many": [[1.0], []],
            "when": pa.array([0, 1], pa.timestamp("ms", "UTC")),
            "record": [{"a": 1}, None],
            "yes": [True, None],
            "half": pa.array([1.0, 2.0], pa.float32()),
        }
    )
    yield parquet(other, compression="none")


def parquet(table: pa.Table, **options: object) -> bytes:
    """Return a table as the bytes of a file."""
    stream = io.BytesIO()
    pq.write_table(table, stream, **options)
    return stream.getvalue()
