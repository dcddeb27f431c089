"""Foreign formats are read in a process of their own, since their libraries crash on damaged files.

The process is kept for the next file, but not after one that was refused; it ends with this one.
A file that crashes it, or asks for more time or memory than a whole file of its size does, costs
that process and is one line here.
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

LEAST_S, BYTES_PER_S = 60.0, 1e6  # that a file of any size may take, and more for large ones
LEAST_BYTES, BYTES_PER_BYTE = 2 << 30, 20  # of memory, likewise
_START = "import sys; sys.path[:] = {path!r}; from {module} import serve; serve()"


class _Process:
    """The process, started when it is needed."""

    def __init__(self) -> None:
        self.lock, self.owner = Lock(), 0
        self.refused: Path | None = None  # what may have left the library's memory in disorder
        self.running: subprocess.Popen[bytes] | None = None
        atexit.register(self.end)

    def ask(self, request: Any, seconds: float) -> Any:
        """Return the answer to a request.

        Raises
        ------
        TimeoutError
            There is none after so many seconds.
        EOFError
            The process has died.
        """
        with self.lock:
            process = self._running()
            late = Timer(seconds, process.kill)
            late.start()
            try:
                return _asked(process, request)
            except BaseException as error:
                was_late = late.finished.is_set()
                self.end()
                if isinstance(error, OSError | EOFError | pickle.UnpicklingError):
                    raise (TimeoutError if was_late else EOFError) from error
                raise
            finally:
                late.cancel()

    def end(self) -> None:
        """End the process, where this one has started it."""
        process, self.running, self.refused = self.running, None, None
        if process is not None and self.owner == os.getpid():
            process.kill()
            process.communicate()

    def _running(self) -> subprocess.Popen[bytes]:
        if self.running is None or self.owner != os.getpid():  # a fork has its own
            start = _START.format(path=sys.path, module=__name__)
            self.running, self.owner = _started(start), os.getpid()
        return self.running


def _asked(process: subprocess.Popen[bytes], request: Any) -> Any:
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
    """Return what a module's function says about a file, called in the other process.

    Raises
    ------
    InputError
        The function raises it, or the process dies of the file or has to be ended.
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
        answer = _PROCESS.ask(request, seconds)
    except TimeoutError as error:
        late = TimeoutError(f"not done after {seconds:.0f} s")
        raise damaged(path, kind, late) from error
    except EOFError as error:
        raise damaged(path, kind, EOFError("the library for this format crashed")) from error
    if isinstance(answer, Exception):
        _PROCESS.refused = path
        raise answer
    return answer


def serve() -> None:
    """Answer requests on standard input, until there are no more."""
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # what libraries print is no answer
    while True:
        try:
            request = pickle.load(sys.stdin.buffer)  # noqa: S301 # from the process that started this
        except EOFError:
            return
        module, function, arguments, seconds, memory, folder = request
        os.chdir(folder)
        called = getattr(import_module(module), function)
        _end_after(seconds + 5.0)  # in case that nobody is left to do it
        _limit(memory)
        pickle.dump(_answer(called, arguments), answers)
        answers.flush()
        _end_after(0.0)  # which means never


def _answer(called: Any, arguments: tuple[Any, ...]) -> Any:
    try:
        return called(*arguments)
    except (InputError, OSError) as error:
        return error
    except Exception:  # noqa: BLE001 # a defect, whose own type may not travel
        return RuntimeError(traceback.format_exc())


def _end_after(seconds: float) -> None:
    if sys.platform != "win32":
        signal.setitimer(signal.ITIMER_REAL, seconds)


def _limit(memory: int) -> None:
    """Let this process take so much memory more, and leave no dump when it crashes."""
    if sys.platform != "linux":
        return
    import resource

    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    _, most = resource.getrlimit(resource.RLIMIT_AS)
    wanted = pages * resource.getpagesize() + memory
    limit = wanted if most == resource.RLIM_INFINITY else min(wanted, most)
    resource.setrlimit(resource.RLIMIT_AS, (limit, most))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
