"""MATLAB 5 files that expand, lie or carry objects; written element by element."""

import pickle
import struct
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy.io import savemat

from tests.hostile.case import Evil, Make, cases, guessing, ingesting

INT8, INT32, UINT32, DOUBLE, MATRIX, PACKED = 1, 5, 6, 9, 14, 15
CELL, STRUCT, OBJECT, NUMBERS, OPAQUE, SPARSE = 1, 2, 3, 6, 17, 5


def element(kind: int, content: bytes, *, claimed: int | None = None) -> bytes:
    size = len(content) if claimed is None else claimed
    return struct.pack("<II", kind, size) + content + b"\0" * (-len(content) % 8)


def head(kind: int, shape: tuple[int, int], name: bytes) -> bytes:
    return (
        element(UINT32, struct.pack("<II", kind, 0))
        + element(INT32, struct.pack("<ii", *shape))
        + element(INT8, name)
    )


def packed(stream: bytes) -> bytes:
    return struct.pack("<II", PACKED, len(stream)) + stream


def mat(*elements: bytes | Callable[[], bytes]) -> Make:
    """Return a maker of a file of these elements; what is large is made when it is written."""

    def make(folder: Path) -> list[object]:
        path = folder / "a.mat"
        made = [each() if callable(each) else each for each in elements]
        path.write_bytes(b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM" + b"".join(made))
        return ingesting(path)

    return make


def variable(kind: int, shape: tuple[int, int], *content: bytes, name: bytes = b"x") -> bytes:
    return element(MATRIX, head(kind, shape, name) + b"".join(content))


def saved(folder: Path, **variables: object) -> list[object]:
    path = folder / "a.mat"
    savemat(path, {name: np.arange(5.0) for name in "txf"} | variables)
    return ingesting(path)


def bomb(size: int, claimed: int) -> bytes:
    """Return a packed variable of zeros that says that it is `claimed` bytes long.

    One packed part of zeros stands in it again and again.
    """
    begun = zlib.compressobj(9)
    first = begun.compress(
        struct.pack("<II", MATRIX, claimed)
        + head(NUMBERS, (size // 8, 1), b"x")
        + struct.pack("<II", DOUBLE, size)
    ) + begun.flush(zlib.Z_FULL_FLUSH)
    part = begun.compress(bytes(1 << 24)) + begun.flush(zlib.Z_FULL_FLUSH)
    return packed(first + part * (size >> 24) + begun.flush())


def version_4(folder: Path) -> list[object]:
    path = folder / "a.mat"
    path.write_bytes(struct.pack("<5i", 0, 2**31 - 1, 2, 0, 2) + b"x\0" + bytes(80))
    return ingesting(path)


def with_pickle(folder: Path) -> list[object]:
    """Numbers that are the bytes of a pickle, beside honest ones."""
    return saved(folder, evil=np.frombuffer(pickle.dumps(Evil(folder)), np.uint8))


def opaque() -> bytes:
    words = b"".join(element(INT8, word) for word in (b"x", b"java", b"java.lang.Runtime"))
    value = variable(NUMBERS, (1, 1), element(DOUBLE, bytes(8)), name=b"")
    return element(MATRIX, element(UINT32, struct.pack("<II", OPAQUE, 0)) + words + value)


def npz(name: str) -> Make:
    """NumPy's format is not read by pickle, whatever its name."""

    def make(folder: Path) -> list[object]:
        with (folder / name).open("wb") as stream:
            np.savez(stream, x=np.array([Evil(folder)], object))
        return guessing(folder / name)

    return make


CASES = cases(
    {
        "at most 500 times its size": {
            # A gigabyte of zeros in a megabyte; what is packed says that it is small, or not.
            "a zip bomb": mat(lambda: bomb(1 << 30, (1 << 30) + 64) * 3),
            "a zip bomb that says it is small": mat(lambda: bomb(1 << 30, 100)),
        },
        "needs more memory than is free": {
            "a claim of two billion cells": mat(variable(CELL, (2**31 - 1, 1))),
            "a claim of a billion structs": mat(
                variable(
                    STRUCT,
                    (2**30, 1),
                    element(INT32, struct.pack("<i", 8)),
                    element(INT8, b"abcdefgh"),
                )
            ),
            "a claim of two billion rows": mat(
                variable(NUMBERS, (2**31 - 1, 1), struct.pack("<II", DOUBLE, 2**32 - 8))
            ),
            "a claim of two billion rows in version 4": version_4,
        },
        "": {"the bytes of a pickle": with_pickle},
        "column t is missing": {"a Java object": mat(opaque())},
        "column x is missing": {
            "an array of objects": lambda folder: saved(folder, x=np.array([1, "a", 2.5], object)),
        },
        "holds no column of numbers": {"npz": npz("a.npz")},
        "cannot be read as a MATLAB file": {
            "npz called mat": npz("a.mat"),
            "a sparse matrix of 10^18 cells, one of them there": mat(
                variable(
                    SPARSE,
                    (10**9, 10**9),
                    element(INT32, bytes(4)),
                    element(INT32, bytes(8)),
                    element(DOUBLE, bytes(8)),
                )
            ),
        },
        "Duplicate variable name": {
            "a hundred thousand variables of one name": mat(
                *[variable(NUMBERS, (1, 1), element(DOUBLE, bytes(8)), name=b"v")] * 100_000
            ),
        },
    }
)
