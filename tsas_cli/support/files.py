"""Atomic outputs: a file or folder appears under its name only when it is complete."""

import errno
import hashlib
import json
import math
import os
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext, suppress
from contextvars import ContextVar
from functools import partial
from pathlib import Path
from typing import Any

from tsas_cli.support import limits
from tsas_cli.support.errors import InputError
from tsas_cli.support.replacing import (
    SUMS,
    exists,
    refuse_address,
    refuse_file,
    refuse_folder,
    refuse_kind,
)
from tsas_cli.support.temporaries import place_file, place_folder, temporary_for
from tsas_cli.support.wording import listed

Raw = dict[str, Any]  # a table of TOML, JSON or MATLAB, before a schema has read it
_FULL = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EFBIG})
_NO_ROOM = _FULL | {errno.EROFS}
_EXTRA_OUTPUT: ContextVar[Callable[[Path], None] | None] = ContextVar("extra_output", default=None)


def sha256_of(path: Path) -> str:
    """Return the SHA-256 of a file as hexadecimal text."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def new_folder(
    path: Path, *, stage: str, inputs: Iterable[object], force: bool = False
) -> AbstractContextManager[Path]:
    """Give a temporary folder that becomes `path` when the block ends without an error.

    `stage` writes it, as its JSON names it; with `force` an earlier output of the same stage is
    replaced. The folder may not be, contain or lie inside one of the call's `inputs`.

    InputError: `path` exists and is not an empty folder, and `force` is not set; or, with `force`,
    it is no earlier output of the same stage, an input, or the current folder; or it is not
    writable.
    """
    refuse = partial(refuse_folder, path, stage=stage, inputs=tuple(inputs), force=force)
    return _new(path, refuse, folder=True, force=force)


@contextmanager
def stage_folder(
    path: Path, *, stage: str, inputs: Iterable[object], force: bool = False
) -> Iterator[Path]:
    """Yield a new folder as `new_folder` does, and write `SHA256SUMS` of its files at the end."""
    with new_folder(path, stage=stage, inputs=inputs, force=force) as folder:
        write, own = _EXTRA_OUTPUT.get(), _EXTRA_OUTPUT.set(None)  # not for nested outputs
        try:
            yield folder
            if write is not None:
                write(folder)
        finally:
            _EXTRA_OUTPUT.reset(own)
        write_sums(folder)


def folder_if(
    path: Path | None, *, stage: str, inputs: Iterable[object], force: bool = False
) -> AbstractContextManager[Path | None]:
    """Give a new folder as `stage_folder` does, or None without a path."""
    if path is None:
        return nullcontext()
    return stage_folder(path, stage=stage, inputs=inputs, force=force)


@contextmanager
def extra_output(write: Callable[[Path], None] | None) -> Iterator[None]:
    """Let `write` add files to the folder of the stage in the block, before it gets its name."""
    before = _EXTRA_OUTPUT.set(write)
    try:
        yield
    finally:
        _EXTRA_OUTPUT.reset(before)


def new_file(
    path: Path, *, mark: bytes, inputs: Iterable[object], force: bool = False
) -> AbstractContextManager[Path]:
    """Give a temporary file name that becomes `path` when the block ends without an error.

    With `force` an earlier output of the same command is replaced, which has `mark` in its first
    4 KiB; an empty mark allows any file, since the path belongs to the program. The file may not
    be one of the call's `inputs` or lie inside one.

    InputError: `path` exists and `force` is not set; or, with `force`, it is no earlier output or
    an input; or it is a folder or not writable.
    """
    refuse = partial(refuse_file, path, mark=mark, inputs=tuple(inputs), force=force)
    return _new(path, refuse, folder=False, force=force)


@contextmanager
def _new(path: Path, refuse: Callable[[], None], *, folder: bool, force: bool) -> Iterator[Path]:
    """Yield the temporary path of a new file or folder, unless `refuse` refuses it."""
    with ExitStack() as stack:
        with _written(path):
            limits.text_name(path.absolute())
            refuse_address(path)
            refuse_kind(path, folder=folder)
            refuse()
            stack.callback(_remove_empty, [p for p in path.parents if not p.exists()])
            path.parent.mkdir(parents=True, exist_ok=True)
            temporary = stack.enter_context(temporary_for(path))
            temporary.mkdir() if folder else temporary.touch()
        with _written(path, only=_NO_ROOM), _named(temporary, path):
            yield temporary
        with _written(path):
            refuse()  # another process may have written it meanwhile
            (place_folder if folder else place_file)(temporary, path, replace=force)


def _remove_empty(folders: Iterable[Path]) -> None:
    """Remove folders that hold nothing, up to the first that holds something."""
    with suppress(OSError):
        for folder in folders:
            folder.rmdir()


def own_file(path: Path) -> AbstractContextManager[Path]:
    """Give what `new_file` does, for a file whose path belongs to the program: it is replaced.

    InputError: it is a folder, or not writable.
    """
    return new_file(path, mark=b"", inputs=(), force=True)


def in_subfolders(folder: object, names: Collection[str]) -> str:
    """Return which subfolders hold one of some files, as a remedy; "" where none does."""
    inside = sorted(folder.glob("*")) if isinstance(folder, Path) else []
    found = [sub.name for sub in inside if any((sub / name).is_file() for name in names)]
    more = [f"{len(found) - 3} more"] if len(found) > 3 else []
    return f"name one of its subfolders: {listed([*found[:3], *more])}" if found else ""


def write_sums(folder: Path) -> None:
    """Write the checksums of the files in a folder, in the format of `sha256sum --check`."""
    sums = folder / SUMS
    files = sorted(path for path in folder.rglob("*") if path.is_file() and path != sums)
    sums.write_text(sums_text(folder, files), encoding="utf-8")


def sums_text(folder: Path, files: Iterable[Path]) -> str:
    """Return a line of checksum and relative path for each of these files of a folder."""
    lines = [f"{sha256_of(path)}  {path.relative_to(folder).as_posix()}\n" for path in files]
    return "".join(lines)


def write_json(path: Path, content: Any) -> None:
    """Write JSON with a stable layout; numbers that are not finite become null."""
    path.write_text(json_text(content), encoding="utf-8")


def json_text(content: Any) -> str:
    """Return content as JSON text; NumPy values become plain ones, numbers not finite null."""
    return json.dumps(_finite(content), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def read_json(path: Path, *, lines: bool = False) -> Any:
    """Return the content of a JSON file; `lines` of JSON are one list.

    InputError: the file is missing or unreadable, is not JSON, has a duplicate key, or exceeds a
    limit.
    """

    def load() -> Any:
        limits.fits(path, limits.JSON_EXPANDS * path.stat().st_size)
        text = limits.text_of(path, limits.JSON_BYTES)
        if lines:
            text = "[" + ",\n".join(line for line in text.split("\n") if line.strip()) + "]"
        return json.loads(text, object_pairs_hook=_without_duplicates)

    return parsed(load, "JSON", path)


def parsed(load: Callable[[], Any], kind: str, path: object) -> Any:
    """Return what a parser loads from a file; the errors of both become `InputError`."""
    try:
        content = load()
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", where=path) from error
    except RecursionError as error:
        raise limits.too_deep(path) from error
    except ValueError as error:  # of the syntax, of text, or of an integer with too many digits
        raise InputError(f"is not {kind} ({limits.reason(error)})", where=path) from error
    limits.depth(content, path)
    return content


def _without_duplicates(members: list[tuple[str, Any]]) -> Raw:
    content = dict(members)
    if len(content) < len(members):
        names = [name for name, _ in members]
        duplicate = next(name for name in names if names.count(name) > 1)
        raise ValueError(f"duplicate key {duplicate[:80]!r}")
    return content


def state_of(path: Path) -> tuple[int, ...]:
    """Return inode, size and modification time of a file, to detect a change."""
    state = path.stat()
    return state.st_ino, state.st_size, state.st_mtime_ns


def check_unchanged(path: Path, before: tuple[int, ...]) -> None:
    """Refuse a file that has changed since its `state_of` was taken."""
    if state_of(path) != before:
        raise InputError(
            "changed while it was read",
            where=path,
            expected="a finished recording",
            remedy="wait until no program writes to it, or copy it first",
        )


def _finite(content: Any) -> Any:
    if isinstance(content, dict):
        return {str(key): _finite(value) for key, value in content.items()}
    if isinstance(content, list | tuple):
        return [_finite(value) for value in content]
    if hasattr(content, "tolist"):  # numpy arrays and scalars
        return _finite(content.tolist())
    if isinstance(content, float):
        return content if math.isfinite(content) else None
    return content


@contextmanager
def _written(path: Path, *, only: Collection[int] = ()) -> Iterator[None]:
    """Convert errors of writing an output to `InputError`; `only` those with these numbers."""
    try:
        yield
    except OSError as error:
        if only and error.errno not in only:
            raise
        exists_now = isinstance(error, FileExistsError) and os.path.lexists(path)
        raise (exists(path) if exists_now else unwritable(path, error)) from error


@contextmanager
def _named(temporary: Path, path: Path) -> Iterator[None]:
    """Replace the temporary path in errors by the final path."""
    try:
        yield
    except InputError as error:
        error.where = error.where.replace(str(temporary), str(path))
        raise


def unwritable(path: Path, error: OSError) -> InputError:
    """Return the error for an output that the system refuses."""
    return InputError(
        f"cannot be written ({error.strerror})",
        where=path,
        remedy="make room, or choose an --out elsewhere"
        if error.errno in _FULL
        else "choose an --out in a folder that you may write to",
    )
