"""Guards against damaged and hostile files: one error for them, limits of size, memory and time.

Foreign formats are read in a separate process, since their libraries crash on damaged files. The
process is reused for the next file, except after a refused one; it ends with this one. A file that
crashes it, or exceeds the time or memory of a file of its size, ends that process and raises an
error here.
"""

import atexit
import os
import signal
import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from threading import Lock, Timer
from typing import Any

from tsas_cli.support import limits
from tsas_cli.support.errors import InputError
from tsas_cli.support.limits import out_of_memory
from tsas_cli.support.worker_process import WorkerProcess

LEAST_S, BYTES_PER_S = 60.0, 1e6  # time limit: least, and per size of the file
LEAST_BYTES, BYTES_PER_BYTE = 2 << 30, 20  # memory limit, likewise


class EncryptedError(InputError):
    """The file, or a column of it, is encrypted."""


def damaged(path: object, kind: str, error: Exception) -> InputError:
    """Return the error for a file that the library for its format refuses."""
    if "crypt" in str(error):  # of pyarrow, at an encrypted file or column, and of zipfile
        return EncryptedError(
            "holds encrypted data",
            where=path,
            expected="data that can be read",
            remedy="decrypt it, and write the file again without encryption",
        )
    reason = str(error).splitlines()[0] if str(error) else type(error).__name__
    return InputError(
        f"cannot be read as {kind} ({reason})",
        where=path,
        remedy="the file may be incomplete: copy or export it again",
    )


@contextmanager
def foreign(
    path: object, kind: str, errors: tuple[type[Exception], ...] = (Exception,)
) -> Iterator[None]:
    """Convert the errors of the library for a format to `InputError`.

    A damaged file raises any of a dozen types, unless `errors` are known.
    """
    try:
        yield
    except InputError:
        raise
    except MemoryError as error:
        raise out_of_memory(path) from error
    except errors as error:
        if isinstance(error, OSError) and error.errno is not None:  # not of the content
            raise InputError(f"cannot be read ({error.strerror})", where=path) from error
        raise damaged(path, kind, error) from error


@dataclass
class Expanded:
    """Unpacked bytes and items (variables, cells, blocks) of one file so far."""

    path: object
    of_file: int
    most: int = limits.EXPANSION
    bytes: int = 0
    items: int = 0

    @classmethod
    def of(cls, path: Path) -> "Expanded":
        """Return the empty count of a file."""
        return cls(path, path.stat().st_size)

    def add(self, more: int, *, what: str = "") -> None:
        """Count one item of so many bytes.

        InputError: the file expands to more than a recording of its size can hold.
        """
        self.items += 1
        if self.items > min(limits.ITEMS, max(1000, self.of_file // 8)):
            raise InputError(
                f"holds more than {self.items - 1} variables, or refers to one repeatedly",
                where=self.path,
                expected="a recording",
                remedy="export the channels that you need",
            )
        self.grow(more, what=what)

    def grow(self, more: int, *, what: str = "") -> None:
        """Count more bytes of the same item."""
        self.bytes += more
        if self.bytes > max(limits.HARMLESS, self.most * self.of_file):
            claimed = f"{what}, {limits.size(self.bytes)}" if what else limits.size(self.bytes)
            raise InputError(
                f"{claimed} or more from a file of {limits.size(self.of_file)}",
                where=self.path,
                expected=f"at most {self.most} times its size",
                remedy="it may be damaged; else export it without compression, or as CSV",
            )

    def fits(self) -> None:
        """Refuse a file that is loaded whole and exceeds the memory."""
        limits.fits(self.path, limits.COPIES * self.bytes)


class _Process:
    """The reader process, started on first use."""

    def __init__(self) -> None:
        self.lock, self.owner = Lock(), 0
        self.refused: Path | None = None  # it may have corrupted the library's memory
        self.running: WorkerProcess | None = None
        atexit.register(self.end)

    def call(self, seconds: float, *request: Any) -> Any:
        """Return the result of `limited`.

        TimeoutError: it is not done after so many seconds.
        EOFError: the process has died.
        """
        with self.lock:
            if self.running is None or self.owner != os.getpid():  # a fork starts its own
                self.running, self.owner = WorkerProcess(heard=False), os.getpid()
            late = Timer(seconds, self.running.process.kill)
            late.start()
            try:
                return self.running.call(f"{__name__}:limited", seconds, *request)
            except BaseException as error:
                was_late = late.finished.is_set()
                self.end()
                if was_late and isinstance(error, EOFError):
                    raise TimeoutError from error
                raise
            finally:
                late.cancel()

    def end(self) -> None:
        """End the process, if this one has started it."""
        process, self.running, self.refused = self.running, None, None
        if process is not None and self.owner == os.getpid():
            process.kill()


_PROCESS = _Process()


def in_another_process(module: str, function: str, path: Path, *rest: Any, kind: str) -> Any:
    """Return the result of a module's function for a file, called in the other process.

    InputError: the function raises it, or the file crashes the process or exceeds a limit.
    OSError: the function raises it.
    """
    size = path.stat().st_size
    if _PROCESS.refused not in (None, path):
        _PROCESS.end()
    seconds = LEAST_S + size / BYTES_PER_S
    memory = LEAST_BYTES + BYTES_PER_BYTE * size
    try:
        result = _PROCESS.call(seconds, memory, Path.cwd(), module, function, path, *rest)
    except TimeoutError as error:
        late = TimeoutError(f"not done after {seconds:.0f} s")
        raise damaged(path, kind, late) from error
    except EOFError as error:
        raise damaged(path, kind, EOFError("the library for this format crashed")) from error
    if isinstance(result, Exception):
        _PROCESS.refused = path
        raise result
    return result


def limited(
    seconds: float, memory: int, folder: Path, module: str, function: str, *arguments: Any
) -> Any:
    """Return the result of a function, or its error; called in the other process."""
    os.chdir(folder)
    called = getattr(import_module(module), function)
    signal.setitimer(signal.ITIMER_REAL, seconds + 5.0)  # in case the parent process is dead
    _limit(memory)
    try:
        return called(*arguments)
    except (InputError, OSError) as error:
        return error
    except Exception:  # noqa: BLE001 # a defect, whose type may not be picklable
        return RuntimeError(traceback.format_exc())
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)


def _limit(memory: int) -> None:
    """Limit further memory of this process [bytes], and disable core dumps."""
    if sys.platform != "linux":
        return
    import resource

    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    _, most = resource.getrlimit(resource.RLIMIT_AS)
    wanted = pages * resource.getpagesize() + memory
    limit = wanted if most == resource.RLIM_INFINITY else min(wanted, most)
    resource.setrlimit(resource.RLIMIT_AS, (limit, most))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
