"""MATLAB files of version 5, with the captures of ControlDesk."""

import random
import struct
import zlib
from functools import partial

import numpy as np
from scipy.io import savemat

from tests.fuzz.foreign import Offering, files_of, whole_file
from tests.recordings.readers.matlab_files import controldesk
from tests.recordings.readers.test_matlab import T, one_channel_5, plain_5

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
    cells = {"c": np.array(["a", T], dtype=object), "z": np.array([1 + 2j]), "e": np.empty(0)}
    rasters = {"rec": controldesk([T, T[:2]], [("force", T, "N", 1), ("speed", T[:2], "rpm", 2)])}
    others = [
        partial(savemat, mdict=content, do_compression=packed)
        for content in (cells, rasters)
        for packed in (False, True)
    ]
    others += [
        partial(savemat, mdict={"t": T, "s": {"a": T}, "w": "50 mm"}, do_compression=True),
        partial(savemat, mdict={"t": T, "m": np.c_[T, T]}, format="4"),
    ]
    yield from files_of("a.mat", plain_5, one_channel_5, *others)()
