"""NumPy's files: the first byte chooses between `.npy` and `.npz`."""

import io
from collections.abc import Iterable

import numpy as np

from tests.fuzz.foreign import Offering, ask
from tests.fuzz.rules import Scratch
from tsas_cli.recordings.readers import numpy_file as _reader  # noqa: F401 # instrumented
from tsas_cli.recordings.readers.table import ReadOptions

MOST_BYTES = 6000
SHARE = 0.12
WORDS = (b"\x93NUMPY", b"'descr': '|O'", b"'shape': (9999999999,)", b"<f8", b"PK\x01\x02")
_scratch = Scratch()


def one(data: bytes) -> None:
    """The rest is the file."""
    name = "a.npz" if data[:1] > b"\x7f" else "a.npy"
    ask(Offering("numpy_file"), _scratch.file(name, data[1:]), ReadOptions())


def seeds() -> Iterable[bytes]:
    """A matrix, records and dates; several arrays, packed and not, one of them of objects."""
    t = np.arange(4) / 10
    records = np.array(list(zip(t, t, strict=True)), [("t", "f8"), ("f", "f4")])
    for array in (np.c_[t, t], records, t.astype("datetime64[s]")):
        stream = io.BytesIO()
        np.save(stream, array)
        yield b"\0" + stream.getvalue()
    for save in (np.savez, np.savez_compressed):
        stream = io.BytesIO()
        save(stream, t=t, m=np.c_[t, t], o=np.array([{}, 1], dtype=object))
        yield b"\xff" + stream.getvalue()
