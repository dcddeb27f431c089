"""Arrays of NumPy: the first byte chooses between `.npy` and `.npz`."""

import io

import numpy as np

from tests.fuzz.foreign import Offering, files_of, whole_file
from tests.recordings.readers.test_offered import DATES, FORCE, TIME, npz

MOST_BYTES = 6000
SHARE = 0.12
WORDS = (b"\x93NUMPY", b"'descr': '|O'", b"'shape': (9999999999,)", b"<f8", b"PK\x01\x02")
_npy, _npz = (whole_file(Offering("numpy_file"), f"a.{suffix}") for suffix in ("npy", "npz"))


def one(data):
    (_npz if data[:1] > b"\x7f" else _npy)(data[1:])


def seeds():
    records = np.array(list(zip(TIME, TIME, strict=True)), [("t", "f8"), ("f", "f4")])
    for array in (np.c_[TIME, FORCE], records, DATES):
        stream = io.BytesIO()
        np.save(stream, array)
        yield b"\0" + stream.getvalue()
    packed = files_of("a.npz", npz, lambda path: np.savez_compressed(path, t=TIME))
    yield from (b"\xff" + content for content in packed())
