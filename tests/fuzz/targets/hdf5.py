"""HDF5 files of any program."""

from collections.abc import Iterable
from pathlib import Path
from tempfile import TemporaryDirectory

import h5py
import numpy as np

from tests.fuzz.foreign import Offering, ask
from tests.fuzz.rules import Scratch
from tsas_cli.recordings.readers import hdf5 as _reader  # noqa: F401 # instrumented
from tsas_cli.recordings.readers.table import ReadOptions

MOST_BYTES = 16000
SHARE = 0.12
WORDS = (b"TREE", b"HEAP", b"SNOD", b"GCOL", b"OHDR", b"units", b"\xff" * 8)
_scratch = Scratch()


def one(data: bytes) -> None:
    """All of it is the file."""
    ask(Offering("hdf5"), _scratch.file("a.h5", data), ReadOptions())


def seeds() -> Iterable[bytes]:
    """Vectors in a group with units and a link; a packed matrix; records and text."""
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
