"""Lists of files that make one run."""

from tests.fuzz.documents import toml_document as mutate
from tests.fuzz.rules import Scratch, read_all
from tsas_cli.recordings.readers import joined  # noqa: F401 # instrumented
from tsas_cli.recordings.readers.table import ReadOptions

__all__ = ["WORDS", "mutate", "one", "seeds"]
SHARE = 1
MOST_BYTES = 1000
WORDS = (b'"a.csv"', b'"../a.csv"', b'"a.join"', b"offset_s", b"read", b"1e999", b"time")
_scratch = Scratch()
_scratch.file("a.csv", b"t,x\n0,1\n0.5,2\n")
_scratch.file("b.csv", b"0;1\n1;3\n")


def one(data):
    path = _scratch.file("a.join", data)
    for options in (ReadOptions(), ReadOptions(resample=True)):
        read_all(path, options)


def seeds():
    first = b'[a]\nfile = "a.csv"\ntime = "t"\nunit = "s"\n'
    yield first
    second = b'[b]\nfile = "b.csv"\ntime = 1\nunit = "ms"\noffset_s = -0.1\n'
    yield first + second + b"read.skip_lines = 0\n"
