"""What is no file of its format, or only the beginning of one, is one line that names the file."""

import gzip
import lzma

import numpy as np
import pytest

from tests.refusals import refusal
from tsas_cli.recordings.readers import names
from tsas_cli.recordings.readers.table import ReadOptions

NOTHING = b"nothing that a reader knows"
TEXT = b"t,f\n0,1\n0.5,2\n"


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        *(
            (f"a.{suffix}", NOTHING, "cannot be read as")
            for suffix in ("mcap", "bag", "db3", "h5", "npz", "npy", "feather")
        ),
        *(
            (f"a.{suffix}", b"PK\x03\x04 nothing", "cannot be read as a spreadsheet")
            for suffix in ("xlsx", "xls", "ods")
        ),
        ("a.tdms", NOTHING, "holds no channel of numbers"),
        ("a.lvm", TEXT, "has no"),
        ("a.csv.gz", NOTHING, "cannot be read as a .gz file"),
        ("a.csv.xz", lzma.compress(TEXT)[:-20], "cannot be read as a .xz file"),
        ("a.zip", b"PK nothing", "cannot be read as a .zip file"),
        ("a.gz", gzip.compress(TEXT, mtime=0), "unknown file format (no suffix) inside"),
        ("a.csv.gz", gzip.compress(b"", mtime=0), "is empty"),
    ],
)
def test_damage_is_one_line(tmp_path, name, content, message):
    (tmp_path / name).write_bytes(content)
    line = refusal(names, tmp_path / name, ReadOptions())
    assert str(tmp_path / name) in line
    assert message in line


def test_no_advice_to_unpickle_is_passed_on(tmp_path):
    np.save(tmp_path / "a.npy", np.array([{}, {}]), allow_pickle=True)
    (tmp_path / "a.npz").write_bytes(TEXT)
    for name in ("a.npy", "a.npz"):
        assert "allow_pickle" not in refusal(names, tmp_path / name, ReadOptions())
