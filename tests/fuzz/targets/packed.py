"""Packed text tables and lines of JSON: the first byte chooses the suffix."""

import bz2
import gzip
import io
import lzma
import zipfile
from collections.abc import Iterable

from tests.fuzz.rules import Scratch, answer
from tsas_cli.recordings.readers import json_table, names, packed, read  # noqa: F401 # instrumented
from tsas_cli.recordings.readers.table import ReadOptions

SUFFIXES = (".csv.gz", ".csv.bz2", ".csv.xz", ".zip", ".jsonl")
SHARE = 2
MOST_BYTES = 3000
WORDS = (b"PK\x03\x04", b"PK\x01\x02", b"\x1f\x8b\x08", b"BZh9", b"\xfd7zXZ", b"../", b'{"a":')
_scratch = Scratch()


def one(data: bytes) -> None:
    """The rest is the file."""
    suffix = SUFFIXES[data[0] % len(SUFFIXES)] if data else ".zip"
    path = _scratch.file(f"a{suffix}", data[1:])
    listed = answer(names, path, ReadOptions())
    if listed is not None:
        answer(read, path, ReadOptions(), list(range(1, len(listed) + 1))[:20])


def seeds() -> Iterable[bytes]:
    """One table in each of the forms."""
    text = b"t,f\n0,1\n0.5,2\n"
    yield b"\0" + gzip.compress(text, mtime=0)
    yield b"\1" + bz2.compress(text)
    yield b"\2" + lzma.compress(text)
    for method in (zipfile.ZIP_DEFLATED, zipfile.ZIP_LZMA):
        stream = io.BytesIO()
        with zipfile.ZipFile(stream, "w", method) as archive:
            archive.writestr(zipfile.ZipInfo("run/a.csv"), text, method)
            archive.writestr(zipfile.ZipInfo("readme.md"), text)
        yield b"\3" + stream.getvalue()
    yield b'\4{"t": 0, "f": {"x": 1.5}}\n\n{"t": 1, "f": {"x": null}}\n'
