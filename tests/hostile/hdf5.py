"""HDF5 files (MATLAB 7.3) that lie, expand, lead elsewhere or go round in circles."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from tests.hostile.case import Make, cases, ingesting

TRILLION = 10**12
T = np.arange(5.0)


def hdf5(build: Callable[[Any], object]) -> Make:
    """Return a maker of a file that holds t and f honestly, and x as `build` makes it."""

    def make(folder: Path) -> list[object]:
        path = folder / "a.mat"
        with h5py.File(path, "w") as file:
            for name in "tf":
                numbers(file, name, T + 1)
            build(file)
        return ingesting(path)

    return make


def x(*what: Any, **how: Any) -> Make:
    """Return a maker of a file whose x is this dataset."""
    return hdf5(lambda file: file.create_dataset("x", *what, **how))


def numbers(group: Any, name: str, values: object) -> Any:
    item = group.create_dataset(name, data=values)
    item.attrs["MATLAB_class"] = np.bytes_("double")
    return item


def secret(file: Any) -> str:
    """Write x into another file, and return its name."""
    with h5py.File(Path(file.filename).with_name("other.h5"), "w") as other:
        numbers(other, "x", T)
    return "other.h5"


def zeros(file: Any) -> None:
    """8 GB of zeros, packed: HDF5 keeps one packed chunk of zeros; the others say the same."""
    rows = 1 << 30
    item = file.create_dataset("x", (rows, 1), "f8", chunks=(1 << 22, 1), compression="gzip")
    item[0] = 0.0
    chunk = item.id.read_direct_chunk((0, 0))[1]
    for at in range(0, rows, 1 << 22):
        item.id.write_direct_chunk((at, 0), chunk)


def characters(file: Any) -> None:
    item = file.create_dataset("x", (1 << 31, 1), "u2", chunks=(1 << 20, 1))
    item.attrs["MATLAB_class"] = np.bytes_("char")


def external_link(file: Any) -> None:
    file["x"] = h5py.ExternalLink(secret(file), "/x")


def external_storage(file: Any) -> None:
    path = Path(file.filename).with_name("secret")
    path.write_bytes(b"secret!!" * 5)
    item = file.create_dataset("x", (5,), "f8", external=[(str(path), 0, 40)])
    item.attrs["MATLAB_class"] = np.bytes_("double")


def virtual(file: Any) -> None:
    layout = h5py.VirtualLayout((5,), "f8")
    layout[:] = h5py.VirtualSource(secret(file), "x", (5,))
    file.create_virtual_dataset("x", layout)


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
    file["#out"] = h5py.ExternalLink(secret(file), "/x")
    file.create_dataset("x", data=np.array([["#out"]], dtype=object), dtype=h5py.string_dtype())


def deep_groups(file: Any) -> None:
    group = file.create_group("x")
    for _ in range(3000):
        group = group.create_group("x")


CASES = cases(
    {
        "at most 500 times its size": {
            "gzip'ed gigabytes of zeros": hdf5(zeros),
            "a claim of 10^12 rows": x((TRILLION, 1), "f8", chunks=(1 << 20, 1)),
            "values of a million numbers each": x(
                (1000, 1), np.dtype(("f8", (1_000_000,))), chunks=(1, 1)
            ),
            "characters without end": hdf5(characters),
            "a cell of 10^12 elements": x((TRILLION, 1), h5py.ref_dtype, chunks=(1000, 1)),
        },
        "is a link, or its data are in another file": {
            "an external link": hdf5(external_link),
            "external storage": hdf5(external_storage),
            "a virtual dataset": hdf5(virtual),
            "a soft link to nowhere": hdf5(lambda file: file.update(x=h5py.SoftLink("/no/where"))),
            "a ring of soft links": hdf5(ring_of_soft_links),
        },
        "more than one reference to": {
            "a group in itself": hdf5(group_in_itself),
            "doubling groups": hdf5(doubling_groups),
            "doubling cells": hdf5(doubling_cells),
            "a cell of itself": hdf5(cell_of_itself),
        },
        "column x is missing": {
            "names in the place of references": hdf5(names_as_references),
            "a type in the place of a variable": hdf5(lambda file: file.update(x=np.dtype("f8"))),
            "a variable without a space": x(data=h5py.Empty("f8")),
            "opaque values": x(data=np.zeros(5, "V1000")),
        },
        "cannot be read as a MATLAB file": {"a reference to nothing": x((1, 1), h5py.ref_dtype)},
        "is nested too deep": {"groups, 3000 deep": hdf5(deep_groups)},
    }
)
