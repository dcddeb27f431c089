"""MATLAB files of version 5, with the captures of ControlDesk."""

import random
import struct
import zlib
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from scipy.io import savemat

from tests.fuzz.foreign import Offering, whole_file
from tests.recordings.readers.matlab_files import controldesk
from tsas_cli.recordings.readers import matlab as _reader  # noqa: F401 # instrumented

SHARE = 0.12
WORDS = tuple(struct.pack("<I", kind) for kind in (*range(1, 19), 0x10001, 0x40006))
_HEAD, _TAG, _COMPRESSED = 128, 8, 15
one = whole_file(Offering("matlab"), "a.mat")


def mutate(data, most, seed):
    """Change bytes, of compressed parts what is inside."""
    from atheris import Mutate

    chance = random.Random(seed)  # noqa: S311 # not a secret
    parts = _opened(data)
    if parts is None or chance.random() < 0.2:
        return bytes(Mutate(data, most))
    which = chance.randrange(len(parts))
    parts[which] = bytes(Mutate(parts[which], most))
    return (data[:_HEAD] + b"".join(map(_closed, parts)))[:most]


def _opened(data: bytes) -> list[bytes] | None:
    """Return what is inside the compressed parts, where a file is made of nothing else."""
    parts, at = [], _HEAD
    while at + _TAG <= len(data):
        kind, size = struct.unpack_from("<II", data, at)
        if kind != _COMPRESSED:
            return None
        try:
            parts.append(zlib.decompressobj().decompress(data[at + _TAG :][:size], 1 << 16))
        except zlib.error:
            return None
        at += _TAG + size
    return parts or None


def _closed(part: bytes) -> bytes:
    content = zlib.compress(part)
    return struct.pack("<II", _COMPRESSED, len(content)) + content


def seeds():
    time_s = np.arange(4) / 10
    plain = {
        "t": time_s,
        "i": np.arange(4, dtype=np.int16),
        "m": np.c_[time_s, time_s],
        "s": {"a": time_s, "b": {"c": 3.0}},
        "w": "50 mm",
    }
    cells = np.array(["a", time_s], dtype=object)
    channels = [("force", time_s, "N", 1), ("speed", time_s[:2], "rpm", 2)]
    with TemporaryDirectory() as name:
        path = Path(name) / "a.mat"
        for content in (
            plain,
            {"c": cells, "z": np.array([1 + 2j]), "e": np.empty(0), "b": time_s > 0},
            {"rec": controldesk([time_s, time_s[:2]], channels)},
            {"rec": controldesk([time_s], channels[:1])},
        ):
            for compressed in (False, True):
                savemat(path, content, do_compression=compressed)
                yield path.read_bytes()
        savemat(path, {"t": time_s, "m": np.c_[time_s, time_s]}, format="4")
        yield path.read_bytes()
