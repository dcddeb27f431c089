"""NumPy's files: the first byte chooses between `.npy` and `.npz`."""

import io

import numpy as np

from tests.fuzz.foreign import Offering, whole_file
from tsas_cli.recordings.readers import numpy_file as _reader  # noqa: F401 # instrumented

MOST_BYTES = 6000
SHARE = 0.12
WORDS = (b"\x93NUMPY", b"'descr': '|O'", b"'shape': (9999999999,)", b"<f8", b"PK\x01\x02")
_npy, _npz = (whole_file(Offering("numpy_file"), f"a.{suffix}") for suffix in ("npy", "npz"))


def one(data):
    (_npz if data[:1] > b"\x7f" else _npy)(data[1:])


def seeds():
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
