"""MATLAB 7.3: HDF5 with MATLAB's classes as attributes, made into plain Python values."""

from pathlib import Path
from typing import Any

import numpy as np

from tsas_cli.recordings.readers.optional import optional


def variables(path: Path) -> dict[str, Any]:
    """Return the variables of a file: structs as dictionaries, struct arrays and cells as lists.

    Raises
    ------
    InputError
        h5py is not installed.
    OSError
        The file is damaged.
    """
    h5py = optional("h5py", extra="mat")
    with h5py.File(path, "r") as file:
        return {name: _value(file[name], file) for name in file if not name.startswith("#")}


def _value(item: Any, file: Any) -> Any:
    if hasattr(item, "keys"):
        members = {name: _value(item[name], file) for name in item}
        return _records(members) if _is_struct_array(item) else members
    if item.attrs.get("MATLAB_empty", 0):
        return "" if _class(item) == "char" else np.empty(0)
    if item.dtype.kind == "O":  # references, of a cell or of a struct array's member
        return [_value(file[reference], file) for reference in item[()].T.ravel()]
    values = np.asarray(item[()]).T  # MATLAB writes columns first
    if _class(item) == "char":
        return "".join(chr(code) for code in values.ravel())
    return values.item() if values.size == 1 else values


def _class(item: Any) -> str:
    return bytes(item.attrs.get("MATLAB_class", b"")).decode(errors="replace")


def _is_struct_array(group: Any) -> bool:
    """Say whether a struct has more than one element: then its members are bare references."""
    members = [group[name] for name in group]
    return bool(members) and all(
        not hasattr(m, "keys") and m.dtype.kind == "O" and not _class(m) for m in members
    )


def _records(members: dict[str, list[Any]]) -> list[dict[str, Any]]:
    names = list(members)
    return [dict(zip(names, values, strict=True)) for values in zip(*members.values(), strict=True)]
