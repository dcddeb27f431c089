"""Feather files, as Arrow and pandas write them."""

import io

import numpy as np
import pyarrow as pa
from pyarrow import feather as files

from tests.fuzz.foreign import Offering, whole_file
from tsas_cli.recordings.readers import feather as _reader  # noqa: F401 # instrumented

MOST_BYTES = 6000
SHARE = 0.12
WORDS = (b"ARROW1", b"unit", b"\xff\xff\xff\xff", b"\x10\x00\x00\x00")
one = whole_file(Offering("feather"), "a.feather")


def seeds():
    table = pa.table(
        {
            "t": np.arange(4) / 10,
            "f": pa.array([1, None, 3, 4]),
            "when": np.arange(4).astype("datetime64[ms]"),
            "w": pa.array(["a", "b", "a", None]).dictionary_encode(),
        }
    )
    for compression in ("uncompressed", "lz4", "zstd"):
        stream = io.BytesIO()
        files.write_feather(table, stream, compression=compression)
        yield stream.getvalue()
