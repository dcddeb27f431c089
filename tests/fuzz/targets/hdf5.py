"""HDF5 files of any program."""

from tests.fuzz.foreign import Offering, files_of, whole_file
from tests.recordings.readers.test_offered import hdf5

MOST_BYTES = 16000
SHARE = 0.12
WORDS = (b"TREE", b"HEAP", b"SNOD", b"GCOL", b"OHDR", b"units", b"\xff" * 8)
one = whole_file(Offering("hdf5"), "a.h5")
seeds = files_of("a.h5", hdf5)
