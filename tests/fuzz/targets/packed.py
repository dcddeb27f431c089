"""Packed text tables and lines of JSON: the first byte chooses the suffix."""

import bz2
import gzip
import io
import lzma
import zipfile

from tests.fuzz.rules import Scratch, chosen, read_all
from tsas_cli.recordings.readers import converted, json_table  # noqa: F401 # instrumented

SUFFIXES = (".csv.gz", ".csv.bz2", ".csv.xz", ".zip", ".jsonl")
SHARE = 2
MOST_BYTES = 3000
WORDS = (b"PK\x03\x04", b"PK\x01\x02", b"\x1f\x8b\x08", b"BZh9", b"\xfd7zXZ", b"../", b'{"a":')
_scratch = Scratch()


def one(data):
    suffix, file = chosen(data, SUFFIXES)
    read_all(_scratch.file(f"a{suffix}", file))


def seeds():
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
