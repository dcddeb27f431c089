"""HDF5 files of any program, and the variables of those of MATLAB 7.3, as plain Python values."""

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from tsas_cli.recordings.guards import Expanded
from tsas_cli.recordings.readers.offered import Column, Offered, columns_in
from tsas_cli.recordings.readers.table import ReadOptions, optional
from tsas_cli.support import limits
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import Raw


def offered(path: Path, _: ReadOptions) -> Iterator[Offered]:
    """Yield the datasets of numbers by their paths, `group/name`; units from attributes.

    Links are not followed, but hard ones.
    """
    h5py = optional("h5py", extra="hdf5")
    with h5py.File(path, "r") as file:
        columns: list[Column] = []
        expanded = Expanded.of(path)

        def visit(name: str, item: Any) -> None:
            if isinstance(item, h5py.Dataset) and item.shape is not None:
                if item.is_virtual or item.external:
                    raise _elsewhere(f"the data of {name[: limits.NAME]} are in another file", path)
                columns.extend(columns_in(name, item, _unit(item), load))

        @cache  # a matrix holds several columns
        def load(item: Any) -> Any:
            expanded.add(item.size * item.dtype.itemsize, what=f"{item.name} of {item.shape}")
            expanded.fits()
            return item[()]

        file.visititems(visit)
        said = (f"{k} = {v}" for k, v in file.attrs.items() if isinstance(v, str | np.number))
        yield Offered(columns, tuple(said))


def _unit(item: Any) -> str:
    stated = next((item.attrs[key] for key in ("unit", "units") if key in item.attrs), "")
    return stated.decode(errors="replace") if isinstance(stated, bytes) else str(stated)


def variables(path: Path) -> Raw:
    """Return the variables of a file: structs as dictionaries, struct arrays and cells as lists.

    OSError: the file is damaged.
    """
    h5py = optional("h5py", extra="mat")
    with h5py.File(path, "r") as file:
        return _Reader(path, file, h5py).members(file, deep=0, but="#")


class _Reader:
    """Reader of one file, which counts its unpacked size."""

    def __init__(self, path: Path, file: Any, h5py: Any) -> None:
        self.path, self.file, self.h5py = path, file, h5py
        self.expanded = Expanded.of(path)
        self.seen: set[int] = set()  # structs and cells, by their address in the file

    def members(self, group: Any, *, deep: int, but: str = "\0") -> Raw:
        """Return the members of a group, except names that begin with `but`."""
        self._enter(group, deep)
        names = [name for name in group if not name.startswith(but)]
        limits.columns(names, self.path)
        for name in names:
            if not isinstance(group.get(name, getlink=True), self.h5py.HardLink):
                raise _linked(name, self.path)
        return {name: self._value(group[name], deep + 1) for name in names}

    def _value(self, item: Any, deep: int) -> Any:
        if isinstance(item, self.h5py.Group):
            members = self.members(item, deep=deep)
            if not _is_struct_array(item):
                return members
            each = zip(*members.values(), strict=True)
            return [dict(zip(members, values, strict=True)) for values in each]
        if not isinstance(item, self.h5py.Dataset):
            return None  # a named type is no variable
        if item.is_virtual or item.external:
            raise _linked(item.name, self.path)
        if item.attrs.get("MATLAB_empty", 0) or item.shape is None:
            return "" if _class(item) == "char" else np.empty(0)
        self.expanded.add(item.size * item.dtype.itemsize, what=f"{item.name} of {item.shape}")
        self.expanded.fits()
        if self.h5py.check_ref_dtype(item.dtype) is self.h5py.Reference:
            self._enter(item, deep)
            return [self._value(self.file[ref], deep + 1) for ref in item[()].T.ravel()]
        values = np.asarray(item[()]).T  # MATLAB stores columns first
        if _class(item) == "char":
            return "".join(chr(code) for code in values.ravel())
        return values.item() if values.size == 1 else values

    def _enter(self, item: Any, deep: int) -> None:
        """Refuse an item that is referred to more than once, or nested too deep."""
        address = self.h5py.h5o.get_info(item.id).addr
        if address in self.seen:
            raise InputError(
                f"more than one reference to {str(item.name)[: limits.NAME]}",
                where=self.path,
                expected="one reference to each struct and cell",
            )
        self.seen.add(address)
        if deep > limits.DEPTH:
            raise limits.too_deep(self.path)


def _linked(name: str, path: Path) -> InputError:
    return _elsewhere(f"{name[: limits.NAME]} is a link, or its data are in another file", path)


def _elsewhere(what: str, path: Path) -> InputError:
    return InputError(
        what,
        where=path,
        expected="a file that holds its data itself",
        remedy="copy the data into one file",
    )


def _class(item: Any) -> str:
    return bytes(item.attrs.get("MATLAB_class", b"")).decode(errors="replace")


def _is_struct_array(group: Any) -> bool:
    """Return whether a struct has more than one element: its members are then bare references."""
    members = [group[name] for name in group]
    return bool(members) and all(
        not hasattr(m, "keys") and m.dtype.kind == "O" and not _class(m) for m in members
    )
