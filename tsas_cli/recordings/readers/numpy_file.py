"""NumPy's own files, without objects: `.npy` and `.npz`."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from tsas_cli.recordings.guards import Expanded
from tsas_cli.recordings.readers.offered import Column, Offered, columns_in
from tsas_cli.recordings.readers.table import ReadOptions
from tsas_cli.support.errors import InputError


def offered(path: Path, _: ReadOptions) -> Iterator[Offered]:
    """Yield the vectors of a file by name; those of a matrix as in `columns_in`."""
    try:
        content = np.load(path, allow_pickle=False)
    except ValueError as error:
        if "allow_pickle" not in str(error):
            raise
        raise InputError(
            "cannot be read as a NumPy file of numbers",
            where=path,
            remedy="it may be incomplete or hold objects: write it with numpy.save or numpy.savez",
        ) from error
    if isinstance(content, np.ndarray):
        yield Offered(columns_in("", content))
        return
    with content:
        expanded = Expanded.of(path)
        for member in content.zip.infolist():
            expanded.add(member.file_size, what=member.filename)
        expanded.fits()
        yield Offered([c for name in content.files for c in _columns(name, content)])


def _columns(name: str, content: Any) -> list[Column]:
    try:
        return columns_in(name, content[name])
    except ValueError as error:
        if "allow_pickle" in str(error):  # objects would be unpickled: no column
            return []
        raise
