"""MATLAB files: version 5 and earlier, and the HDF5 of version 7.3."""

import struct
import warnings
import zlib
from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from scipy.io import loadmat
from scipy.io.matlab import MatReadWarning

from tsas_cli.recordings.guards import Expanded, foreign
from tsas_cli.recordings.readers.offered import Column, Offered, columns_in
from tsas_cli.recordings.readers.table import ReadOptions, floats
from tsas_cli.recordings.readers.timebase import TIME
from tsas_cli.support import limits
from tsas_cli.support.arrays import Floats
from tsas_cli.support.errors import InputError, nearest
from tsas_cli.support.files import Raw

_HEADER, _TAG = 128, 8
_ORDERS = {b"IM": "<", b"MI": ">"}
_PACKED = 15
_MOST_PACKED = 1032  # bytes per compressed byte, at most
_PART = 1 << 12
_HDF5 = b"\x89HDF\r\n\x1a\n"


def offered(path: Path, options: ReadOptions) -> Iterator[Offered]:
    """Yield the columns of a MATLAB file.

    A vector is a column with its name, those of a matrix are as in `columns_in`, and a member of a
    struct is `name.member`. The X/Y struct of a dSPACE ControlDesk export is read as such. With
    `table` in the map, names are relative to that variable.

    InputError: the file is damaged, or there are several captures.
    """
    content = _content(path)
    for name in options.table.split(".") if options.table else ():
        structs = [key for key, value in content.items() if isinstance(value, dict)]
        if name not in structs:
            raise InputError(f"no struct {name}", where=path, remedy=nearest(name, structs))
        content = content[name]
    found = {"": content} if _is_capture(content) else captures(content)
    if len(found) > 1:
        raise InputError(
            f"holds {len(found)} captures: {', '.join(found)}",
            where=path,
            expected="one",
            remedy='name it in the map: table = "…" under [read]',
        )
    for capture in found.values():
        yield channels_of(capture, path)
        return
    columns = list({column.name: column for column in _columns(content)}.values())
    header = tuple(f"{k} = {v}" for k, v in content.items() if isinstance(v, str | int | float))
    yield Offered(columns, header)


def tables(path: Path) -> list[str]:
    """Return the names of the captures, if there are several."""
    with foreign(path, "a MATLAB file"):
        found = captures(_content(path))
    return list(found) if len(found) > 1 else []


def _content(path: Path) -> Raw:
    """Return the variables as plain dictionaries, lists, text and arrays."""
    with path.open("rb") as stream:
        head = stream.read(520)
    if _HDF5 in (head[:8], head[512:]):
        from tsas_cli.recordings.readers.hdf5 import variables

        return variables(path)
    check_unpacked(path)
    with warnings.catch_warnings():
        warnings.simplefilter("error", MatReadWarning)  # duplicate variables
        content = loadmat(path, simplify_cells=True)
    return {name: value for name, value in content.items() if not name.startswith("__")}


def _columns(content: Raw, prefix: str = "") -> Iterator[Column]:
    for name, value in content.items():
        if isinstance(value, dict):
            yield from _columns(value, f"{prefix}{name}.")
        elif isinstance(value, np.ndarray) and value.size:
            yield from columns_in(f"{prefix}{name}", value)


def check_unpacked(path: Path) -> None:
    """Refuse a file that unpacks to more than a recording can hold, or exceeds the memory.

    The declared size of a variable may be false, so a file that could be large is first unpacked in
    parts to count its bytes.
    """
    expanded = Expanded.of(path)
    if expanded.of_file * _MOST_PACKED <= limits.HARMLESS:
        return
    with path.open("rb") as stream:
        order = _ORDERS.get(stream.read(_HEADER)[-2:], "")
        for kind, size in _elements(stream, order):
            is_packed = kind == _PACKED
            expanded.add(0 if is_packed else size, what="unpacked")
            for part in _parts(stream, size) if is_packed else ():
                expanded.grow(part, what="unpacked")
    expanded.fits()


def _elements(stream: BinaryIO, order: str) -> Iterator[tuple[int, int]]:
    """Yield kind and size of each variable, with the stream at its beginning."""
    end = _HEADER
    stream.seek(end)
    while order and len(tag := stream.read(_TAG)) == _TAG:
        kind, size = struct.unpack(f"{order}II", tag)
        end += _TAG + size
        yield kind, size
        stream.seek(end)


def _parts(stream: BinaryIO, size: int) -> Iterator[int]:
    """Yield the unpacked sizes of the parts of the next `size` bytes."""
    packed = zlib.decompressobj()
    while size > 0 and (content := stream.read(min(size, _PART))):
        size -= len(content)
        while content:
            try:
                yield len(packed.decompress(content, _MOST_PACKED * _PART))
            except zlib.error:  # the reader reports it
                return
            content = packed.unconsumed_tail


def captures(content: Mapping[str, Any]) -> dict[str, Mapping[str, Any]]:
    """Return the captures among the variables, by name."""
    return {name: value for name, value in content.items() if _is_capture(value)}


def channels_of(capture: Mapping[str, Any], path: Path) -> Offered:
    """Return the channels of a capture, with their clocks in s.

    InputError: a channel, when it is loaded, differs in length from its clock.
    """
    clocks = [floats(np.ravel(clock["Data"]), TIME, path) for clock in _records(capture["X"])]
    channels = [
        Column(
            str(channel.get("Name", "")).strip('"'),
            partial(np.ravel, channel["Data"]),
            str(channel.get("Unit", "")),
            partial(_clock, channel.get("XIndex", 1), clocks),
        )
        for channel in _records(capture["Y"])
    ]
    description = str(capture.get("Description", ""))
    return Offered(channels, (description,) if description else ())


def _is_capture(value: Any) -> bool:
    if not isinstance(value, Mapping) or not {"X", "Y"} <= set(value):
        return False
    records = [*_records(value["X"]), *_records(value["Y"])]
    return all(isinstance(record, Mapping) and "Data" in record for record in records)


def _records(value: Any) -> list[Any]:
    """Return a struct array as a list; an array of one element is read as a struct."""
    return list(value) if isinstance(value, list | np.ndarray) else [value]


def _clock(number: Any, clocks: list[Floats]) -> Floats:
    """Return the clock of a number, from 1; an empty one if there is none."""
    known = np.ndim(number) == 0 and 1 <= number <= len(clocks)
    return clocks[int(number) - 1] if known else np.empty(0)
