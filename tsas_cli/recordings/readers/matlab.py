"""MATLAB files: version 5 and earlier, and the HDF5 of version 7.3."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import loadmat
from scipy.io.matlab import MatReadWarning

from tsas_cli.recordings.guards.damaged import damaged
from tsas_cli.recordings.guards.matlab_packed import check_unpacked
from tsas_cli.recordings.readers.controldesk import captures, channels_of, find_capture
from tsas_cli.recordings.readers.offered import Column, Offered
from tsas_cli.recordings.readers.table import ReadOptions
from tsas_cli.support.arrays import Floats
from tsas_cli.support.errors import InputError, nearest
from tsas_cli.support.files import Raw
from tsas_cli.support.memory import out_of_memory

_HDF5 = b"\x89HDF\r\n\x1a\n"


@contextmanager
def offered(path: Path, options: ReadOptions) -> Iterator[Offered]:
    """Yield the columns of a MATLAB file.

    A vector is a column with its name, column j of a matrix is `name(:,j)`, and a member of a
    struct is `name.member`. The X/Y struct of a dSPACE ControlDesk export is read as such. With
    `table` in the map, names are relative to that variable.

    InputError: the file is damaged, or there are several captures.
    """
    content = _inside(_content(path), options.table, path)
    capture = find_capture(content, path)
    if capture is not None:
        yield channels_of(capture, path)
        return
    columns = [Column(name, partial(np.asarray, v)) for name, v in dict(_vectors(content)).items()]
    header = tuple(f"{k} = {v}" for k, v in content.items() if isinstance(v, str | int | float))
    yield Offered(columns, header)


def tables(path: Path) -> list[str]:
    """Return the names of the captures, if there are several."""
    found = captures(_content(path))
    return list(found) if len(found) > 1 else []


def _content(path: Path) -> Raw:
    try:
        return _variables(path)
    except InputError:
        raise
    except MemoryError as error:
        raise out_of_memory(path) from error
    except Exception as error:  # a damaged file raises any of a dozen types
        raise damaged(path, "a MATLAB file", error) from error


def _variables(path: Path) -> Raw:
    """Return the variables as plain dictionaries, lists, text and arrays."""
    with path.open("rb") as stream:
        head = stream.read(520)
    if _HDF5 in (head[:8], head[512:]):
        from tsas_cli.recordings.readers.matlab_hdf5 import variables

        return variables(path)
    check_unpacked(path)
    with warnings.catch_warnings():
        warnings.simplefilter("error", MatReadWarning)  # duplicate variables
        content = loadmat(path, simplify_cells=True)
    return {name: value for name, value in content.items() if not name.startswith("__")}


def _inside(content: Raw, table: str | None, path: Path) -> Raw:
    for name in table.split(".") if table else ():
        structs = [key for key, value in content.items() if isinstance(value, dict)]
        if name not in structs:
            raise InputError(f"no struct {name}", where=path, remedy=nearest(name, structs))
        content = content[name]
    return content


def _vectors(content: Raw, prefix: str = "") -> Iterator[tuple[str, Floats]]:
    """Yield every numeric vector with its name in a map."""
    for name, value in content.items():
        if isinstance(value, dict):
            yield from _vectors(value, f"{prefix}{name}.")
        elif _is_matrix(value):
            if 1 in value.shape or value.ndim == 1:
                yield f"{prefix}{name}", value.ravel()
            else:
                for j in range(value.shape[1]):
                    yield f"{prefix}{name}(:,{j + 1})", value[:, j]


def _is_matrix(value: Any) -> bool:
    is_array = isinstance(value, np.ndarray) and value.ndim in {1, 2} and value.size > 0
    return is_array and value.dtype.kind in "fiub"
