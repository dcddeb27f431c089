"""Whole or absent: outputs appear under their name only when they are complete."""

import hashlib
import json
import math
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from tsas_cli.errors import InputError


def sha256_of(path: Path) -> str:
    """Return the SHA-256 of a file as hexadecimal text."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


@contextmanager
def new_folder(path: Path, *, force: bool = False) -> Iterator[Path]:
    """Yield a temporary folder that becomes `path` when the block ends without an error.

    Raises
    ------
    InputError
        `path` exists and is not an empty folder, and `force` is not set; with `force`, where it
        holds something else than an earlier output, or the current folder; it cannot be written.
    """
    try:
        if path.is_file():
            raise InputError("is a file", where=path, expected="a folder's name")
        _refuse_existing(path, force=force)
        _refuse_current(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        temporary = Path(tempfile.mkdtemp(prefix=f".{path.name}.", dir=path.parent))
    except OSError as error:
        raise _unwritable(path, error) from error
    try:
        yield temporary
        temporary.chmod(0o755)
        _refuse_foreign(path, _files_in(temporary))
        _replace_folder(temporary, path)
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


@contextmanager
def folder_if(path: Path | None, *, force: bool = False) -> Iterator[Path | None]:
    """Yield a new folder as `new_folder` does, or None where no path says where to write.

    Raises
    ------
    InputError
        As `new_folder` raises it.
    """
    if path is None:
        yield None
        return
    with new_folder(path, force=force) as folder:
        yield folder


@contextmanager
def new_file(path: Path, *, force: bool = False) -> Iterator[Path]:
    """Yield a temporary file name that becomes `path` when the block ends without an error.

    Raises
    ------
    InputError
        `path` exists and `force` is not set, it is a folder, or it cannot be written.
    """
    try:
        if path.is_dir():
            raise InputError("is a folder", where=path, expected="a file's name")
        _refuse_existing(path, force=force)
        path.parent.mkdir(parents=True, exist_ok=True)
        descriptor, name = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
        os.close(descriptor)
    except OSError as error:
        raise _unwritable(path, error) from error
    temporary = Path(name)
    try:
        yield temporary
        temporary.chmod(0o644)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def write_json(path: Path, content: Any) -> None:
    """Write JSON with stable layout; a number that is not finite becomes null."""
    path.write_text(json_text(content), encoding="utf-8")


def json_text(content: Any) -> str:
    """Return content as JSON text; numpy values become plain ones, not-finite ones null."""
    return json.dumps(_finite(content), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def read_json(path: Path) -> Any:
    """Read JSON.

    Raises
    ------
    InputError
        The file is missing, cannot be read, or is not JSON.
    """
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", where=path) from error
    except (ValueError, RecursionError) as error:
        raise InputError(f"is not JSON ({error})", where=path) from error


def nested_too_deeply(path: Path) -> InputError:
    """Return the error for JSON that is read and then cannot be followed to its depth."""
    return InputError("is nested too deeply", where=path, expected="at most some hundred levels")


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


def _refuse_existing(path: Path, *, force: bool) -> None:
    empty_folder = path.is_dir() and not any(path.iterdir())
    if os.path.lexists(path) and not empty_folder and not force:
        raise InputError(
            "already exists",
            where=path,
            expected="a name that is free",
            remedy="choose another --out, or replace it with --force",
        )


def _refuse_current(path: Path) -> None:
    """Keep `--out . --force` from deleting the folder that somebody works in."""
    if Path.cwd().is_relative_to(path.resolve()):
        raise InputError(
            "is the current folder, or holds it",
            where=path,
            remedy="choose an --out that is a folder of its own",
        )


def _refuse_foreign(path: Path, files: set[str]) -> None:
    """Keep `--out DATASET --force` from replacing recordings by what was made of them."""
    if path.is_dir() and any(path.iterdir()) and not files & _files_in(path):
        raise InputError(
            "holds something else than an earlier output",
            where=path,
            expected=f"a folder with {', '.join(sorted(files))}",
            remedy="choose another --out",
        )


def _files_in(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir() if path.is_file()}


def _replace_folder(temporary: Path, path: Path) -> None:
    """Put `temporary` in the place of `path`; the old one goes only when the new one is there."""
    if not os.path.lexists(path):
        temporary.rename(path)
        return
    old = Path(tempfile.mkdtemp(prefix=f".{path.name}.old.", dir=path.parent))
    path.rename(old / "old")
    temporary.rename(path)
    shutil.rmtree(old, ignore_errors=True)


def _unwritable(path: Path, error: OSError) -> InputError:
    return InputError(
        f"cannot be written ({error.strerror})",
        where=path,
        remedy="choose an --out in a folder that you may write to",
    )
