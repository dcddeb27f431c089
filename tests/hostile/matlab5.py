"""MATLAB 5 files that expand, lie or carry objects; written element by element."""

import pickle
import struct
import zlib
from pathlib import Path

import numpy as np
from scipy.io import savemat

from tests.hostile.case import Case, guessing, ingesting

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


def mat(path: Path, *elements: bytes) -> Path:
    path.write_bytes(b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM" + b"".join(elements))
    return path


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


def zip_bomb(folder: Path) -> list[object]:
    """A gigabyte of zeros in a megabyte, three times."""
    size = 1 << 30
    return ingesting(mat(folder / "a.mat", *[bomb(size, size + 64)] * 3))


def lying_zip(folder: Path) -> list[object]:
    """What is packed says that it is small, and is not."""
    return ingesting(mat(folder / "a.mat", bomb(1 << 30, 100)))


def claims_cells(folder: Path) -> list[object]:
    body = head(CELL, (2**31 - 1, 1), b"x")
    return ingesting(mat(folder / "a.mat", element(MATRIX, body)))


def claims_structs(folder: Path) -> list[object]:
    body = head(STRUCT, (2**30, 1), b"x") + element(INT32, struct.pack("<i", 8))
    body += element(INT8, b"abcdefgh")
    return ingesting(mat(folder / "a.mat", element(MATRIX, body)))


def claims_rows(folder: Path) -> list[object]:
    body = head(NUMBERS, (2**31 - 1, 1), b"x") + struct.pack("<II", DOUBLE, 2**32 - 8)
    return ingesting(mat(folder / "a.mat", element(MATRIX, body)))


def version_4(folder: Path) -> list[object]:
    path = folder / "a.mat"
    path.write_bytes(struct.pack("<5i", 0, 2**31 - 1, 2, 0, 2) + b"x\0" + bytes(80))
    return ingesting(path)


class Evil:
    """What leaves a mark where it is unpickled."""

    def __init__(self, mark: Path) -> None:
        self.mark = mark

    def __reduce__(self) -> tuple[object, ...]:
        return (Path.touch, (self.mark,))


def with_pickle(folder: Path) -> list[object]:
    """Numbers that are the bytes of a pickle, beside honest ones."""
    path = folder / "a.mat"
    evil = np.frombuffer(pickle.dumps(Evil(folder / "touched")), np.uint8)
    savemat(path, {"t": np.arange(5.0), "x": np.arange(5.0), "f": np.arange(5.0), "evil": evil})
    return ingesting(path)


def opaque(folder: Path) -> list[object]:
    body = element(UINT32, struct.pack("<II", OPAQUE, 0))
    for word in (b"x", b"java", b"java.lang.Runtime"):
        body += element(INT8, word)
    body += element(MATRIX, head(NUMBERS, (1, 1), b"") + element(DOUBLE, bytes(8)))
    return ingesting(mat(folder / "a.mat", element(MATRIX, body)))


def of_objects(folder: Path) -> list[object]:
    path = folder / "a.mat"
    savemat(path, {"t": np.arange(5.0), "x": np.array([1, "a", 2.5], object), "f": np.arange(5.0)})
    return ingesting(path)


def npz(folder: Path) -> list[object]:
    """NumPy's format is not read at all, so nothing in it is unpickled."""
    path = folder / "a.npz"
    np.savez(path, x=np.array([Evil(folder / "touched")], object))
    return guessing(path)


def npz_as_mat(folder: Path) -> list[object]:
    path = folder / "a.mat"
    with path.open("wb") as stream:
        np.savez(stream, x=np.array([Evil(folder / "touched")], object))
    return guessing(path)


def sparse(folder: Path) -> list[object]:
    """A sparse matrix of 10^18 cells, of which one is there."""
    body = head(SPARSE, (10**9, 10**9), b"x") + element(INT32, bytes(4)) + element(INT32, bytes(8))
    body += element(DOUBLE, bytes(8))
    return ingesting(mat(folder / "a.mat", element(MATRIX, body)))


def many(folder: Path) -> list[object]:
    body = element(MATRIX, head(NUMBERS, (1, 1), b"v") + element(DOUBLE, bytes(8)))
    return ingesting(mat(folder / "a.mat", *[body] * 100_000))


CASES = (
    Case("a zip bomb", zip_bomb, "at most 500 times its size"),
    Case("a zip bomb that says it is small", lying_zip, "at most 500 times its size"),
    Case("a claim of two billion cells", claims_cells, "needs more memory than is free"),
    Case("a claim of a billion structs", claims_structs, "needs more memory than is free"),
    Case("a claim of two billion rows", claims_rows, "needs more memory than is free"),
    Case("a claim of two billion rows in version 4", version_4, "needs more memory than is free"),
    Case("the bytes of a pickle", with_pickle),
    Case("a Java object", opaque, "column t is missing"),
    Case("an array of objects", of_objects, "column x is missing"),
    Case("npz", npz, "holds no column of numbers"),
    Case("npz called mat", npz_as_mat, "cannot be read as a MATLAB file"),
    Case("a sparse matrix of 10^18 cells", sparse, "cannot be read as a MATLAB file"),
    Case("a hundred thousand variables of one name", many, "Duplicate variable name"),
)
