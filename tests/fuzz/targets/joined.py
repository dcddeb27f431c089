"""Lists of files that make one run."""

from collections.abc import Iterable

from tests.fuzz.documents import toml_document
from tests.fuzz.rules import Scratch, answer
from tsas_cli.recordings.readers import joined, names, read  # noqa: F401 # instrumented
from tsas_cli.recordings.readers.table import ReadOptions

SHARE = 1
MOST_BYTES = 1000
WORDS = (b'"a.csv"', b'"../a.csv"', b'"a.join"', b"offset_s", b"read", b"1e999", b"time")
mutate = toml_document
_scratch = Scratch()
_scratch.file("a.csv", b"t,x\n0,1\n0.5,2\n")
_scratch.file("b.csv", b"0;1\n1;3\n")


def one(data: bytes) -> None:
    """All of it is the list."""
    path = _scratch.file("a.join", data)
    listed = answer(names, path, ReadOptions())
    for options in (ReadOptions(), ReadOptions(resample=True)):
        if listed is not None:
            answer(read, path, options, list(range(1, len(listed) + 1))[:20])


def seeds() -> Iterable[bytes]:
    """Two files, with an offset and options for reading."""
    first = b'[a]\nfile = "a.csv"\ntime = "t"\nunit = "s"\n'
    yield first
    second = b'[b]\nfile = "b.csv"\ntime = 1\nunit = "ms"\noffset_s = -0.1\n'
    yield first + second + b"read.skip_lines = 0\n"
