"""Feather files, as Arrow and pandas write them."""

from pyarrow.feather import read_table, write_feather

from tests.fuzz.foreign import Offering, files_of, whole_file
from tests.recordings.readers.test_offered import as_feather

MOST_BYTES = 6000
SHARE = 0.12
WORDS = (b"ARROW1", b"unit", b"\xff\xff\xff\xff", b"\x10\x00\x00\x00")
one = whole_file(Offering("feather"), "a.feather")


def unpacked(path):
    as_feather(path)
    table = read_table(path, memory_map=False)
    column = table.column("w").dictionary_encode()
    write_feather(table.append_column("d", column), path, compression="uncompressed")


seeds = files_of("a.feather", as_feather, unpacked)
