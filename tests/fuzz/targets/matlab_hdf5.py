"""MATLAB files of version 7.3, which are HDF5."""

import numpy as np

from tests.fuzz.foreign import Offering, files_of, whole_file
from tests.recordings.readers.matlab_files import save_73
from tests.recordings.readers.test_matlab import F, T, plain_73, two_channels_73
from tsas_cli.recordings.readers import hdf5  # noqa: F401 # instrumented

MOST_BYTES = 16000
SHARE = 0.12
WORDS = (b"TREE", b"HEAP", b"SNOD", b"GCOL", b"OHDR", b"MATLAB_class", b"\xff" * 8, b"MATLAB_empty")
one = whole_file(Offering("matlab"), "a.mat")


def packed(path):
    def build(file):  # type: ignore[no-untyped-def]
        data = np.c_[T, F]
        item = file.create_dataset("m", data=data, chunks=True, compression="gzip", shuffle=True)
        item.attrs["MATLAB_class"] = np.bytes_("double")

    save_73(path, build)


seeds = files_of("a.mat", plain_73, two_channels_73, packed)
