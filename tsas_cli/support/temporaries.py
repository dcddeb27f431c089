"""Where an output is made before it has its name, and what becomes of that after a kill.

Beside an output NAME there are, while it is made,

    .NAME.xxxxxxxx.tsas-lock   locked as long as its process lives; it says on which machine
    .NAME.xxxxxxxx.tsas-new    the output on its way; after an exchange, what it has replaced
    .NAME.xxxxxxxx.tsas-old    what it replaces, where two names cannot be exchanged

What a killed process leaves goes with the next output in that folder. The lock comes first and goes
last, so that nothing without one is ever touched.
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
TEMPORARY = re.compile(rf"\.[a-z0-9_]{{8}}({LOCK}|{NEW}|{OLD})$")  # how its name ends
_BOOT_ID = Path("/proc/sys/kernel/random/boot_id")
_AT_FDCWD, _RENAME_EXCHANGE = -100, 2  # of Linux


@contextmanager
def temporary_for(path: Path) -> Iterator[Path]:
    """Yield a free name beside `path`; whatever is under it when the block ends is removed.

    What killed processes have left in that folder goes first.

    Raises
    ------
    OSError
        The folder cannot be written.
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
    """Give a file its name.

    Raises
    ------
    FileExistsError
        There is something of that name, and `replace` is not set.
    """
    _to_disk(new)
    if replace:
        new.replace(path)
    else:
        try:
            path.hardlink_to(new)  # which never replaces, unlike a rename
        except FileExistsError:
            raise
        except OSError as error:  # a file system without links
            if os.path.lexists(path):
                raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST)) from error
            new.rename(path)
    _sync(path.parent)


def place_folder(new: Path, path: Path, *, replace: bool) -> None:
    """Give a folder its name; what it replaces goes when the new one is there.

    Raises
    ------
    FileExistsError
        There is something of that name that is no empty folder, and `replace` is not set.
    """
    _to_disk(new)
    old = new.with_name(new.name.removesuffix(NEW) + OLD)
    while not _renamed(new, path):
        if not replace and not is_empty_folder(path):
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST))
        if _exchanged(new, path):
            break
        remove(old)
        with suppress(FileNotFoundError):  # somebody else has just taken it away
            path.rename(old)
    _sync(path.parent)


def is_empty_folder(path: Path) -> bool:
    """Say whether there is a folder without anything in it."""
    return path.is_dir() and not any(path.iterdir())


def sweep(folder: Path) -> None:
    """Remove what killed processes have left in a folder, and give back what they took away.

    What belongs to a living process, to another machine, or to another person stays.
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
    """Return a new lock file for an output, and what holds it: its descriptor."""
    while True:
        descriptor, name = tempfile.mkstemp(prefix=f".{path.name}.", suffix=LOCK, dir=path.parent)
        lock = Path(name)
        try:
            _locked(descriptor)
            os.write(descriptor, _here())
            if lock.exists():  # else it was swept before it was locked
                return lock, descriptor
        except BaseException:
            lock.unlink(missing_ok=True)
            os.close(descriptor)
            raise
        os.close(descriptor)


def _locked(descriptor: int) -> bool:
    """Lock a file; False where another process has it, or the file system knows no locks."""
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


def _here() -> bytes:
    """Return what tells this machine: its name, and the id of its kernel's start."""
    boot = _BOOT_ID.read_text(encoding="ascii").strip() if _BOOT_ID.exists() else ""
    return f"tsas\n{platform.node()}\n{boot}\n".encode()


def _is_here(owner: bytes) -> bool:
    """Say whether a lock is of this machine; an empty one was killed before it said so."""
    said, here = (text.decode(errors="replace").split("\n") for text in (owner, _here()))
    same = any(a == b != "" for a, b in zip(said[1:], here[1:], strict=False))
    return not owner or (said[0] == here[0] and same)


def _beside(lock: Path, suffix: str) -> Path:
    return lock.with_name(lock.name.removesuffix(LOCK) + suffix)


def _remove_all(lock: Path) -> None:
    for suffix in (NEW, OLD):
        remove(_beside(lock, suffix))
    lock.unlink(missing_ok=True)


def remove(path: Path) -> None:
    """Remove a file, a link or a folder with all in it; nothing where there is none."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        path.unlink(missing_ok=True)


def _renamed(new: Path, path: Path) -> bool:
    """Rename a folder where its name is free or an empty folder has it."""
    try:
        new.rename(path)
    except OSError as error:
        if error.errno not in {errno.ENOTEMPTY, errno.EEXIST, errno.ENOTDIR}:
            raise
        return False
    return True


def _exchanged(a: Path, b: Path) -> bool:
    """Exchange two names in one step, so that a kill leaves one or the other; False where not.

    Not on macOS, nor on file systems that do not know it, such as NFS.
    """
    import ctypes

    try:
        rename = ctypes.CDLL(None, use_errno=True).renameat2
    except (AttributeError, OSError):
        return False
    names = os.fsencode(a), os.fsencode(b)
    return bool(rename(_AT_FDCWD, names[0], _AT_FDCWD, names[1], _RENAME_EXCHANGE) == 0)


def _to_disk(path: Path) -> None:
    """Have a file, or all that a folder holds, on the disk before it gets its name."""
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
        if error.errno not in {errno.EINVAL, errno.ENOTSUP}:  # a file system that cannot
            raise
    finally:
        os.close(descriptor)
