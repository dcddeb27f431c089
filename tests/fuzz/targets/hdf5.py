"""HDF5 files of any program."""

from pathlib import Path
from tempfile import TemporaryDirectory

import h5py
import numpy as np

from tests.fuzz.foreign import Offering, whole_file
from tsas_cli.recordings.readers import hdf5 as _reader  # noqa: F401 # instrumented

MOST_BYTES = 16000
SHARE = 0.12
WORDS = (b"TREE", b"HEAP", b"SNOD", b"GCOL", b"OHDR", b"units", b"\xff" * 8)
one = whole_file(Offering("hdf5"), "a.h5")


def seeds():
    t = np.arange(4) / 10
    with TemporaryDirectory() as name:
        path = Path(name) / "a.h5"
        with h5py.File(path, "w") as file:
            file["bench/t"] = t
            file["bench/t"].attrs["unit"] = "s"
            file["again"] = h5py.SoftLink("/bench")
        yield path.read_bytes()
        with h5py.File(path, "w") as file:
            file.create_dataset("m", data=np.c_[t, t], chunks=True, compression="gzip")
        yield path.read_bytes()
        with h5py.File(path, "w") as file:
            file["r"] = np.array(list(zip(t, t, strict=True)), [("t", "f8"), ("f", "f4")])
            file["w"] = ["a", "b"]
        yield path.read_bytes()
