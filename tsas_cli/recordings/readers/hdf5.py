"""HDF5 files of any program; those of MATLAB have a reader of their own."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from tsas_cli.recordings.guards import Expanded
from tsas_cli.recordings.readers.offered import Column, Offered, columns_in
from tsas_cli.recordings.readers.table import ReadOptions, optional
from tsas_cli.support import limits
from tsas_cli.support.errors import InputError


@contextmanager
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
                    raise InputError(
                        f"the data of {name[: limits.NAME]} are in another file",
                        where=path,
                        expected="a file that holds its data itself",
                        remedy="copy the data into one file",
                    )
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
