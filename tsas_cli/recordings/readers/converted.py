"""Files that are converted to another format before they are read; packed files."""

import atexit
import bz2
import gzip
import lzma
import shlex
import zipfile
import zlib
from collections.abc import Callable
from functools import cache
from pathlib import Path, PurePosixPath
from shutil import rmtree
from tempfile import mkdtemp
from typing import IO, Any

from tsas_cli.recordings import readers
from tsas_cli.recordings.guards import Expanded, foreign
from tsas_cli.recordings.readers.table import ReadOptions
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import state_of

_OPEN: dict[str, Any] = {".gz": gzip.open, ".bz2": bz2.open, ".xz": lzma.open}
PACKED = (*_OPEN, ".zip")
_KEPT = 3  # a file is asked for names and tables first, and may be converted twice
_made: dict[Any, Path] = {}


def is_packed(path: Path) -> bool:
    """Return whether the name of a file says that it is packed."""
    return path.suffix.lower() in PACKED


def converted(path: Path, options: ReadOptions, convert: Callable[..., Path]) -> Path:
    """Return the temporary file of a known format that `convert` makes of `path`.

    InputError: it is damaged, or holds no such file.
    OSError: a file cannot be read or written.
    """
    key = (path.absolute(), state_of(path), options.table, options.encoding)
    if key not in _made:
        while len(_made) >= _KEPT:
            rmtree(_made.pop(next(iter(_made))).parent, ignore_errors=True)
        folder = Path(mkdtemp(dir=_root()))
        try:
            _made[key] = convert(path, folder, options)
        except BaseException:
            rmtree(folder, ignore_errors=True)
            raise
    return _made[key]


@cache
def _root() -> Path:
    """Return the folder of all temporary files of this process."""
    root = Path(mkdtemp(prefix="tsas-"))
    atexit.register(rmtree, root, ignore_errors=True)
    return root


_PART = 1 << 20  # bytes at a time
_DAMAGED = (OSError, EOFError, ValueError, RuntimeError, zipfile.BadZipFile, lzma.LZMAError,
            zlib.error)  # fmt: skip


def convert(path: Path, folder: Path, _: ReadOptions) -> Path:
    """Unpack the file of a known suffix inside `path` into a folder; return its path.

    InputError: it is damaged, encrypted, holds no or several known files, or unpacks to more than a
    recording can hold.
    """
    packing = path.suffix.lower()
    with foreign(path, f"a {packing} file", _DAMAGED):
        if packing == ".zip":
            with zipfile.ZipFile(path) as archive:
                name = _member(archive, path)
                with archive.open(name) as stream:
                    return _written(stream, folder, name, path)
        with _OPEN[packing](path, "rb") as stream:
            return _written(stream, folder, path.stem, path)


def _member(archive: zipfile.ZipFile, path: Path) -> str:
    names = [item.filename for item in archive.infolist() if _is_known(item.filename)]
    if len(names) == 1:
        return names[0]
    if not names:
        raise InputError("holds no file that can be read", where=path, expected="one")
    made = path.with_suffix("")
    raise InputError(
        f"holds {len(names)} files that can be read",
        where=path,
        expected="one",
        remedy="unpack it and ingest the folder: "
        f"unzip {shlex.quote(str(path))} -d {shlex.quote(str(made))}",
    )


def _is_known(name: str) -> bool:
    inside = PurePosixPath(name)
    hidden = any(
        part.startswith((".", "__MACOSX")) and part not in {".", ".."} for part in inside.parts
    )
    return inside.suffix.lower() in {*readers.SUFFIXES} - {*PACKED} and not hidden


def _written(stream: IO[bytes], folder: Path, name: str, path: Path) -> Path:
    expanded = Expanded.of(path)
    target = folder / f"unpacked{PurePosixPath(name).suffix.lower()}"  # no other part of the name
    with target.open("wb") as file:
        while part := stream.read(_PART):
            expanded.grow(len(part), what="unpacked")
            file.write(part)
    return target
