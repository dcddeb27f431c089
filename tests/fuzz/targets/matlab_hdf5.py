"""MATLAB files of version 7.3, which are HDF5."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from tests.fuzz.foreign import Offering, whole_file
from tests.recordings.readers import matlab_files as made
from tsas_cli.recordings.readers import hdf5, matlab  # noqa: F401 # instrumented

MOST_BYTES = 16000
SHARE = 0.12
WORDS = (b"TREE", b"HEAP", b"SNOD", b"GCOL", b"OHDR", b"MATLAB_class", b"\xff" * 8, b"MATLAB_empty")
one = whole_file(Offering("matlab"), "a.mat")


def seeds():
    time_s = np.arange(4) / 10

    def plain(file):  # type: ignore[no-untyped-def]
        made.numbers(file, "t", time_s)
        made.numbers(made.struct(file, "s"), "m", np.c_[time_s, time_s])
        made.text(file, "w", "50 mm")

    def capture(file):  # type: ignore[no-untyped-def]
        group = made.struct(file, "rec")
        made.numbers(made.struct(group, "X"), "Data", time_s)
        channels = [{"Name": name, "Data": time_s, "Unit": "N"} for name in ("f", "g")]
        made.struct_array(file, group, "Y", channels)

    def packed(file):  # type: ignore[no-untyped-def]
        data = np.c_[time_s, time_s]
        item = file.create_dataset("m", data=data, chunks=True, compression="gzip", shuffle=True)
        item.attrs["MATLAB_class"] = np.bytes_("double")

    with TemporaryDirectory() as name:
        path = Path(name) / "a.mat"
        for build in (plain, capture, packed):
            made.save_73(path, build)
            yield path.read_bytes()
