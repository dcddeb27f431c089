"""A Python process that calls functions for this one, and whose death harms nothing else."""

import os
import pickle
import signal
import subprocess
import sys
import tempfile
from contextlib import suppress
from pathlib import Path
from pkgutil import resolve_name
from typing import IO, Any

STDERR_BYTES = 500  # last bytes of a dead process's standard error
_START = "import sys; sys.path[:] = {path!r}; from {module} import serve; serve()"


class WorkerProcess:
    """A process with one call at a time; it ends with this one."""

    def __init__(self, *, heard: bool, **environment: str) -> None:
        """Start it, with more environment variables; if `heard`, its last words are kept.

        OSError: no process can be started.
        """
        # Until the process ends.
        self.stderr: IO[bytes] = (
            tempfile.TemporaryFile() if heard else Path(os.devnull).open("r+b")  # noqa: SIM115
        )
        try:
            self.process = subprocess.Popen(  # noqa: S603 # our own program
                [sys.executable, "-c", _START.format(path=sys.path, module=__name__)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self.stderr,
                env=os.environ | environment,
                process_group=0,  # Ctrl-C is for the parent process
            )
        except OSError:
            self.stderr.close()
            raise

    def call(self, work: str, *arguments: Any) -> Any:
        """Return the result of a function, `module:function`.

        EOFError: the process has died: how, and the last line of its standard error.
        """
        assert self.process.stdin is not None  # noqa: S101 # both are pipes
        assert self.process.stdout is not None  # noqa: S101
        try:
            pickle.dump((work, arguments), self.process.stdin)
            self.process.stdin.flush()
            return pickle.load(self.process.stdout)  # noqa: S301 # our own process wrote it
        except (OSError, EOFError, pickle.UnpicklingError) as error:
            code = self.process.wait()
            self.stderr.seek(0)
            last = self.stderr.read()[-STDERR_BYTES:].decode("utf-8", "replace").strip()
            self.kill()
            ended = f"ended by {signal.Signals(-code).name}" if code < 0 else f"ended with {code}"
            raise EOFError(": ".join([ended, *last.splitlines()[-1:]])) from error

    def kill(self) -> None:
        """Kill the process and close its pipes."""
        self.process.kill()
        self.process.wait()
        for stream in (self.process.stdin, self.process.stdout, self.stderr):
            if stream is not None:
                with suppress(BrokenPipeError, ValueError):
                    stream.close()


def serve() -> None:
    """Call what standard input asks for, until its end."""
    results = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # output of libraries is no result
    while True:
        try:
            work, arguments = pickle.load(sys.stdin.buffer)  # noqa: S301 # from the process that started this
        except EOFError:
            return
        pickle.dump(resolve_name(work)(*arguments), results)
        results.flush()
