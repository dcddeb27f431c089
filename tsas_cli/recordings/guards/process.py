"""Foreign formats are read in a separate process, since their libraries crash on damaged files.

The process is reused for the next file, except after a refused one; it ends with this one. A file
that crashes it, or exceeds the time or memory of a file of its size, ends that process and raises
an error here.
"""

import atexit
import os
import pickle
import signal
import subprocess
import sys
import traceback
from importlib import import_module
from pathlib import Path
from threading import Lock, Timer
from typing import Any

from tsas_cli.recordings.guards.damaged import damaged
from tsas_cli.support.errors import InputError

LEAST_S, BYTES_PER_S = 60.0, 1e6  # time limit: least, and per size of the file
LEAST_BYTES, BYTES_PER_BYTE = 2 << 30, 20  # memory limit, likewise
_START = "import sys; sys.path[:] = {path!r}; from {module} import serve; serve()"


class _Process:
    """The reader process, started on first use."""

    def __init__(self) -> None:
        self.lock, self.owner = Lock(), 0
        self.refused: Path | None = None  # it may have corrupted the library's memory
        self.running: subprocess.Popen[bytes] | None = None
        atexit.register(self.end)

    def call(self, request: Any, seconds: float) -> Any:
        """Return the result of a request.

        Raises
        ------
        TimeoutError
            It is not done after so many seconds.
        EOFError
            The process has died.
        """
        with self.lock:
            process = self._running()
            late = Timer(seconds, process.kill)
            late.start()
            try:
                return _exchange(process, request)
            except BaseException as error:
                was_late = late.finished.is_set()
                self.end()
                if isinstance(error, OSError | EOFError | pickle.UnpicklingError):
                    raise (TimeoutError if was_late else EOFError) from error
                raise
            finally:
                late.cancel()

    def end(self) -> None:
        """End the process, if this one has started it."""
        process, self.running, self.refused = self.running, None, None
        if process is not None and self.owner == os.getpid():
            process.kill()
            process.communicate()

    def _running(self) -> subprocess.Popen[bytes]:
        if self.running is None or self.owner != os.getpid():  # a fork starts its own
            start = _START.format(path=sys.path, module=__name__)
            self.running, self.owner = _started(start), os.getpid()
        return self.running


def _exchange(process: subprocess.Popen[bytes], request: Any) -> Any:
    assert process.stdin is not None  # noqa: S101 # both are pipes
    assert process.stdout is not None  # noqa: S101
    pickle.dump(request, process.stdin)
    process.stdin.flush()
    return pickle.load(process.stdout)  # noqa: S301 # our own process wrote it


def _started(python: str) -> subprocess.Popen[bytes]:
    return subprocess.Popen(  # noqa: S603 # this program itself
        [sys.executable, "-c", python],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    )


_PROCESS = _Process()


def in_another_process(module: str, function: str, path: Path, *rest: Any, kind: str) -> Any:
    """Return the result of a module's function for a file, called in the other process.

    Raises
    ------
    InputError
        The function raises it, or the file crashes the process or exceeds a limit.
    OSError
        The function raises it.
    """
    size = path.stat().st_size
    if _PROCESS.refused not in (None, path):
        _PROCESS.end()
    seconds = LEAST_S + size / BYTES_PER_S
    memory = LEAST_BYTES + BYTES_PER_BYTE * size
    try:
        request = (module, function, (path, *rest), seconds, memory, Path.cwd())
        result = _PROCESS.call(request, seconds)
    except TimeoutError as error:
        late = TimeoutError(f"not done after {seconds:.0f} s")
        raise damaged(path, kind, late) from error
    except EOFError as error:
        raise damaged(path, kind, EOFError("the library for this format crashed")) from error
    if isinstance(result, Exception):
        _PROCESS.refused = path
        raise result
    return result


def serve() -> None:
    """Process requests on standard input until its end."""
    results = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # output of libraries is no result
    while True:
        try:
            request = pickle.load(sys.stdin.buffer)  # noqa: S301 # from the process that started this
        except EOFError:
            return
        module, function, arguments, seconds, memory, folder = request
        os.chdir(folder)
        called = getattr(import_module(module), function)
        _end_after(seconds + 5.0)  # in case the parent process is dead
        _limit(memory)
        pickle.dump(_result(called, arguments), results)
        results.flush()
        _end_after(0.0)  # cancels the timer


def _result(called: Any, arguments: tuple[Any, ...]) -> Any:
    try:
        return called(*arguments)
    except (InputError, OSError) as error:
        return error
    except Exception:  # noqa: BLE001 # a defect, whose type may not be picklable
        return RuntimeError(traceback.format_exc())


def _end_after(seconds: float) -> None:
    if sys.platform != "win32":
        signal.setitimer(signal.ITIMER_REAL, seconds)


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
