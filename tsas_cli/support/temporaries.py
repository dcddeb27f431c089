"""Temporary paths of outputs, and the removal of those that killed processes leave.

While an output NAME is written, its folder also holds

    .NAME.xxxxxxxx.tsas-lock   locked while its process lives; it names the machine
    .NAME.xxxxxxxx.tsas-new    the unfinished output; after an exchange, the replaced one
    .NAME.xxxxxxxx.tsas-old    the replaced output, if two names cannot be exchanged

The next output in the folder removes those of killed processes. The lock is created first and
removed last, so that nothing without a lock is ever touched.
"""

import errno
import fcntl
import os
import platform
import re
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

LOCK, NEW, OLD = ".tsas-lock", ".tsas-new", ".tsas-old"
_LOCK_NAME = re.compile(rf"\.(?P<name>.+)\.[a-z0-9_]{{8}}{LOCK}", re.DOTALL)
TEMPORARY = re.compile(rf"\.[a-z0-9_]{{8}}({LOCK}|{NEW}|{OLD})$")  # suffix of temporary names
_BOOT_ID = Path("/proc/sys/kernel/random/boot_id")
_AT_FDCWD, _RENAME_EXCHANGE = -100, 2  # constants of Linux


@contextmanager
def temporary_for(path: Path) -> Iterator[Path]:
    """Yield an unused name beside `path`, which is removed when the block ends.

    Temporary files of killed processes in that folder are removed first.

    OSError: the folder is not writable.
    """
    sweep(path.parent)
    lock, descriptor = _own_lock(path)
    try:
        yield _beside(lock, NEW)
    finally:
        with suppress(OSError):
            _remove_all(lock)
        os.close(descriptor)


def place_file(new: Path, path: Path, *, replace: bool) -> None:
    """Rename a file to its final name.

    FileExistsError: the name exists, and `replace` is not set.
    """
    _to_disk(new)
    if replace:
        new.replace(path)
    else:
        try:
            path.hardlink_to(new)  # never replaces, unlike a rename
        except FileExistsError:
            raise
        except OSError as error:  # a file system without hard links
            if os.path.lexists(path):
                raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST)) from error
            new.rename(path)
    _sync(path.parent)


def place_folder(new: Path, path: Path, *, replace: bool) -> None:
    """Rename a folder to its final name; the replaced one is removed afterwards.

    FileExistsError: the name exists and is no empty folder, and `replace` is not set.
    """
    _to_disk(new)
    old = new.with_name(new.name.removesuffix(NEW) + OLD)
    while not _renamed(new, path):
        if not replace and not is_empty_folder(path):
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST))
        if _exchanged(new, path):
            break
        remove(old)
        with suppress(FileNotFoundError):  # another process has just removed it
            path.rename(old)
    _sync(path.parent)


def is_empty_folder(path: Path) -> bool:
    """Return whether a path is an empty folder."""
    return path.is_dir() and not any(path.iterdir())


def sweep(folder: Path) -> None:
    """Remove temporary files of killed processes in a folder, and restore what they had renamed.

    Those of living processes, other machines and other users are kept.
    """
    with suppress(OSError):
        for lock in folder.iterdir():
            if found := _LOCK_NAME.fullmatch(lock.name):
                with suppress(OSError):
                    _sweep(lock, folder / found["name"])


def _sweep(lock: Path, path: Path) -> None:
    descriptor = os.open(lock, os.O_RDWR | os.O_NOFOLLOW | os.O_CLOEXEC)
    try:
        if not _is_here(os.read(descriptor, 4096)) or not _locked(descriptor):
            return
        old = _beside(lock, OLD)
        if lock.exists() and os.path.lexists(old) and not os.path.lexists(path):
            old.rename(path)  # killed between the two renames of `place_folder`
        _remove_all(lock)
    finally:
        os.close(descriptor)


def _own_lock(path: Path) -> tuple[Path, int]:
    """Return a new, locked lock file for an output, and its descriptor."""
    while True:
        descriptor, name = tempfile.mkstemp(prefix=f".{path.name}.", suffix=LOCK, dir=path.parent)
        lock = Path(name)
        try:
            _locked(descriptor)
            os.write(descriptor, _here())
            if lock.exists():  # else another process removed it before it was locked
                return lock, descriptor
        except BaseException:
            lock.unlink(missing_ok=True)
            os.close(descriptor)
            raise
        os.close(descriptor)


def _locked(descriptor: int) -> bool:
    """Lock a file; return False if another process holds it or the file system has no locks."""
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


def _here() -> bytes:
    """Return the identity of this machine: its name and its boot id."""
    boot = _BOOT_ID.read_text(encoding="ascii").strip() if _BOOT_ID.exists() else ""
    return f"tsas\n{platform.node()}\n{boot}\n".encode()


def _is_here(owner: bytes) -> bool:
    """Return whether a lock is of this machine; an empty lock is of a killed process here."""
    owner_lines, here = (text.decode(errors="replace").split("\n") for text in (owner, _here()))
    same = any(a == b != "" for a, b in zip(owner_lines[1:], here[1:], strict=False))
    return not owner or (owner_lines[0] == here[0] and same)


def _beside(lock: Path, suffix: str) -> Path:
    return lock.with_name(lock.name.removesuffix(LOCK) + suffix)


def _remove_all(lock: Path) -> None:
    for suffix in (NEW, OLD):
        remove(_beside(lock, suffix))
    lock.unlink(missing_ok=True)


def remove(path: Path) -> None:
    """Remove a file, a link or a folder with its content, if it exists."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _renamed(new: Path, path: Path) -> bool:
    """Rename a folder; return False if the name exists and is no empty folder."""
    try:
        new.rename(path)
    except OSError as error:
        if error.errno not in {errno.ENOTEMPTY, errno.EEXIST, errno.ENOTDIR}:
            raise
        return False
    return True


def _exchanged(a: Path, b: Path) -> bool:
    """Exchange two names atomically; return False if that is not supported.

    It is not on macOS, nor on some file systems, such as NFS.
    """
    import ctypes

    try:
        rename = ctypes.CDLL(None, use_errno=True).renameat2
    except (AttributeError, OSError):
        return False
    names = os.fsencode(a), os.fsencode(b)
    return bool(rename(_AT_FDCWD, names[0], _AT_FDCWD, names[1], _RENAME_EXCHANGE) == 0)


def _to_disk(path: Path) -> None:
    """Flush a file, or all files of a folder, to disk."""
    for folder, _, files in os.walk(path, topdown=False):
        for name in files:
            _sync(Path(folder, name))
        _sync(Path(folder))
    if not path.is_dir():
        _sync(path)


def _sync(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
    try:
        os.fsync(descriptor)
    except OSError as error:
        if error.errno not in {errno.EINVAL, errno.ENOTSUP}:  # not supported by the file system
            raise
    finally:
        os.close(descriptor)
