"""What must hold for any input: it is taken, or refused in a line that can be printed."""

import atexit
import os
import shutil
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import gettempdir, mkdtemp
from typing import Any, TypeVar

from tsas_cli.recordings.readers import names, read
from tsas_cli.recordings.readers.table import ReadOptions
from tsas_cli.support import worker_process
from tsas_cli.support.errors import InputError

Kind = TypeVar("Kind")
PLAIN = ReadOptions()
_WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
_CHANGES = {  # and which of its arguments is the folder that its path is relative to
    "os.mkdir": 2,
    "os.rename": 2,
    "os.remove": 1,
    "os.rmdir": 1,
    "os.link": 2,
    "os.symlink": 2,
    "os.chmod": 2,
}
_STARTS = {"subprocess.Popen", "os.system", "os.exec", "os.posix_spawn", "socket.connect"}
_READERS = worker_process.__name__  # the process in which foreign formats are read


class Broken(Exception):  # noqa: N818 # as it reads
    """A rule does not hold."""


def answer(call: Callable[..., Any], *arguments: Any, **keywords: Any) -> Any:
    """Return what a call gives, or None where it refuses its input; the refusal is one line."""
    try:
        return call(*arguments, **keywords)
    except InputError as error:
        line = error.line()
        if not line.isprintable() or not line.strip():
            raise Broken(f"an error that cannot be printed: {line!r}") from error
        line.encode()
        return None


class Scratch:
    """A folder for one file at a time; it goes with the process, or with the search."""

    def __init__(self) -> None:
        self.folder = Path(mkdtemp(prefix="tsas-fuzz-"))
        atexit.register(shutil.rmtree, self.folder, ignore_errors=True)

    def file(self, name: str, content: bytes) -> Path:
        """Write a file and return its path."""
        path = self.folder / name
        path.write_bytes(content)
        return path


def read_all(path: Path, options: ReadOptions = PLAIN) -> None:
    """Ask for the names of the columns, and for up to 20 of them at once."""
    listed = answer(names, path, options)
    if listed is not None:
        answer(read, path, options, list(range(1, len(listed) + 1))[:20])


def chosen(data: bytes, kinds: Sequence[Kind]) -> tuple[Kind, bytes]:
    """Return the kind that the first byte chooses, and what stands behind it."""
    return kinds[data[0] % len(kinds) if data else 0], data[1:]


class Watch:
    """Says what is changed outside of the folders for temporary files, and what is started."""

    def __init__(self) -> None:
        self.on = False
        self.seen: list[str] = []
        self.inside = (os.path.realpath(gettempdir()) + os.sep, os.devnull + os.sep)
        sys.addaudithook(self._event)

    def _event(self, event: str, arguments: tuple[Any, ...]) -> None:
        if not self.on:
            return
        if event == "open":
            path, _, flags = arguments
            if flags is not None and flags & _WRITES and isinstance(path, str | bytes):
                self._path(event, path)
        elif event in _CHANGES:
            self._path(event, arguments[0], arguments[_CHANGES[event]])
        elif event in _STARTS and _READERS not in str(arguments[1]):
            self.seen.append(f"{event} {arguments[0]!r}")

    def _path(self, event: str, path: Any, folder: int = -1) -> None:
        base = f"/proc/self/fd/{folder}" if folder >= 0 else ""  # Linux, as the search itself
        if not (os.path.realpath(Path(base, os.fsdecode(path))) + os.sep).startswith(self.inside):
            self.seen.append(f"{event} {path!r}")

    @contextmanager
    def during(self) -> Iterator[None]:
        """Watch while the block runs; it is `Broken` where something was changed or started."""
        self.on, self.seen = True, []
        try:
            yield
        finally:
            self.on = False
        if self.seen:
            raise Broken(f"reading does more than read: {'; '.join(self.seen)}")
