"""HDF5 files (MATLAB 7.3) that lie, expand, lead elsewhere or go round in circles."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from tests.hostile.case import Case, ingesting

TRILLION = 10**12
T = np.arange(5.0)


def hdf5(build: Callable[[Any], None]) -> Callable[[Path], list[object]]:
    """Return a maker of a file that holds t and f honestly, and x as `build` makes it."""

    def make(folder: Path) -> list[object]:
        path = folder / "a.mat"
        with h5py.File(path, "w") as file:
            for name in "tf":
                numbers(file, name, T + 1)
            build(file)
        return ingesting(path)

    return make


def numbers(group: Any, name: str, values: object, **how: object) -> Any:
    item = group.create_dataset(name, data=values, **how)
    item.attrs["MATLAB_class"] = np.bytes_("double")
    return item


def zeros(file: Any) -> None:
    """8 GB of zeros, packed: HDF5 keeps one packed chunk of zeros; the others say the same."""
    rows = 1 << 30
    item = file.create_dataset("x", (rows, 1), "f8", chunks=(1 << 22, 1), compression="gzip")
    item[0] = 0.0
    chunk = item.id.read_direct_chunk((0, 0))[1]
    for at in range(0, rows, 1 << 22):
        item.id.write_direct_chunk((at, 0), chunk)


def never_written(file: Any) -> None:
    file.create_dataset("x", (TRILLION, 1), "f8", chunks=(1 << 20, 1))


def wide_values(file: Any) -> None:
    file.create_dataset("x", (1000, 1), np.dtype(("f8", (1_000_000,))), chunks=(1, 1))


def characters(file: Any) -> None:
    item = file.create_dataset("x", (1 << 31, 1), "u2", chunks=(1 << 20, 1))
    item.attrs["MATLAB_class"] = np.bytes_("char")


def external_link(file: Any) -> None:
    other = Path(file.filename).with_name("other.h5")
    with h5py.File(other, "w") as secret:
        numbers(secret, "x", T)
    file["x"] = h5py.ExternalLink("other.h5", "/x")


def external_storage(file: Any) -> None:
    secret = Path(file.filename).with_name("secret")
    secret.write_bytes(b"secret!!" * 5)
    numbers_from = file.create_dataset("x", (5,), "f8", external=[(str(secret), 0, 40)])
    numbers_from.attrs["MATLAB_class"] = np.bytes_("double")


def virtual(file: Any) -> None:
    other = Path(file.filename).with_name("other.h5")
    with h5py.File(other, "w") as secret:
        numbers(secret, "x", T)
    layout = h5py.VirtualLayout((5,), "f8")
    layout[:] = h5py.VirtualSource("other.h5", "x", (5,))
    file.create_virtual_dataset("x", layout)


def soft_link(file: Any) -> None:
    file["x"] = h5py.SoftLink("/nowhere/at/all")


def ring_of_soft_links(file: Any) -> None:
    file["x"], file["y"] = h5py.SoftLink("/y"), h5py.SoftLink("/x")


def group_in_itself(file: Any) -> None:
    group = file.create_group("x")
    group["x"] = group


def doubling_groups(file: Any) -> None:
    """Forty groups, each in the next one twice: 2^40 ways."""
    below = file.create_group("#refs#/g0")
    numbers(below, "v", T)
    for i in range(1, 40):
        group = file.create_group(f"#refs#/g{i}")
        group["a"] = group["b"] = below
        below = group
    file["x"] = below


def doubling_cells(file: Any) -> None:
    """Forty cells, each of which refers to the one before twice."""
    below = numbers(file.create_group("#refs#"), "c0", T)
    for i in range(1, 40):
        below = file["#refs#"].create_dataset(
            f"c{i}", data=np.array([[below.ref], [below.ref]], dtype=h5py.ref_dtype)
        )
    file["x"] = below


def cell_of_itself(file: Any) -> None:
    item = file.create_dataset("x", (1, 1), h5py.ref_dtype)
    item[0, 0] = item.ref


def names_as_references(file: Any) -> None:
    other = Path(file.filename).with_name("other.h5")
    with h5py.File(other, "w") as secret:
        numbers(secret, "x", T)
    file["#out"] = h5py.ExternalLink("other.h5", "/x")
    file.create_dataset("x", data=np.array([["#out"]], dtype=object), dtype=h5py.string_dtype())


def null_reference(file: Any) -> None:
    file.create_dataset("x", (1, 1), h5py.ref_dtype)


def many_cells(file: Any) -> None:
    file.create_dataset("x", (TRILLION, 1), h5py.ref_dtype, chunks=(1000, 1))


def deep_groups(file: Any) -> None:
    group = file.create_group("x")
    for _ in range(3000):
        group = group.create_group("x")


def named_type(file: Any) -> None:
    file["x"] = np.dtype("f8")


def no_space(file: Any) -> None:
    file["x"] = h5py.Empty("f8")


def opaque(file: Any) -> None:
    file["x"] = np.zeros(5, "V1000")


CASES = (
    Case("gzip'ed gigabytes of zeros", hdf5(zeros), "at most 500 times its size"),
    Case("a claim of 10^12 rows", hdf5(never_written), "at most 500 times its size"),
    Case("values of a million numbers each", hdf5(wide_values), "at most 500 times its size"),
    Case("characters without end", hdf5(characters), "at most 500 times its size"),
    Case("an external link", hdf5(external_link), "is a link, or its data are in another file"),
    Case("external storage", hdf5(external_storage), "is a link, or its data are in another file"),
    Case("a virtual dataset", hdf5(virtual), "is a link, or its data are in another file"),
    Case("a soft link to nowhere", hdf5(soft_link), "is a link, or its data are in another file"),
    Case(
        "a ring of soft links",
        hdf5(ring_of_soft_links),
        "is a link, or its data are in another file",
    ),
    Case("a group in itself", hdf5(group_in_itself), "more than one reference to"),
    Case("doubling groups", hdf5(doubling_groups), "more than one reference to"),
    Case("doubling cells", hdf5(doubling_cells), "more than one reference to"),
    Case("a cell of itself", hdf5(cell_of_itself), "more than one reference to"),
    Case("names in the place of references", hdf5(names_as_references), "column x is missing"),
    Case("a reference to nothing", hdf5(null_reference), "cannot be read as a MATLAB file"),
    Case("a cell of 10^12 elements", hdf5(many_cells), "at most 500 times its size"),
    Case("groups, 3000 deep", hdf5(deep_groups), "is nested too deep"),
    Case("a type in the place of a variable", hdf5(named_type), "column x is missing"),
    Case("a variable without a space", hdf5(no_space), "column x is missing"),
    Case("opaque values", hdf5(opaque), "column x is missing"),
)
