"""Worker processes on this machine, each with one task at a time, so that a death has a task."""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import suppress
from threading import local
from typing import IO

from tsas_cli.support.errors import InputError
from tsas_cli.sweeping.outcome import TaskOutcome, worker_death
from tsas_cli.sweeping.versions import ONE_THREAD

TRIES = 2  # of a task whose worker dies
STDERR_BYTES = 500  # last bytes of a dead worker's standard error


def in_processes(
    work: str, texts: Sequence[str], workers: int
) -> Iterator[tuple[int, TaskOutcome]]:
    """Yield the number and the outcome of each task, in the order of completion.

    A task whose worker dies is repeated once by a new one. If the loop over the outcomes ends
    early, the workers are killed.

    Parameters
    ----------
    work
        The function to call, `module:function`.
    texts
        The tasks.
    workers
        Largest number of processes.

    Raises
    ------
    InputError
        No further process can be started.
    """
    crew = _Crew(work)
    pool = ThreadPoolExecutor(max(1, min(workers, len(texts))))
    numbers = {pool.submit(crew.run, text): number for number, text in enumerate(texts)}
    try:
        for future in as_completed(numbers):
            yield numbers[future], future.result()
    finally:
        crew.stopped = True
        pool.shutdown(wait=False, cancel_futures=True)
        while any(
            future.running() for future in numbers
        ):  # a thread may be about to start a worker
            crew.kill()
            time.sleep(0.05)
        pool.shutdown()
        crew.kill()


class _Crew:
    """One worker per thread, replaced if it dies."""

    def __init__(self, work: str) -> None:
        self.work, self.stopped = work, False
        self.own, self.started = local(), list[_Worker]()

    def run(self, text: str) -> TaskOutcome:
        """Return the outcome of a task from this thread's worker."""
        message = ""
        for _ in range(TRIES):
            if self.stopped:
                break
            worker = getattr(self.own, "worker", None) or self._start()
            outcome = worker.run(text)
            if outcome is not None:
                return outcome
            message, self.own.worker = worker.ending(), None
        return worker_death(TRIES, message)

    def kill(self) -> None:
        """Kill every worker."""
        for worker in self.started:
            worker.kill()

    def _start(self) -> "_Worker":
        self.own.worker = worker = _started(self.work)
        self.started.append(worker)
        return worker


def _started(work: str) -> "_Worker":
    try:
        return _Worker(work)
    except OSError as error:
        raise InputError(
            f"no process can be started ({error.strerror})",
            where="--workers",
            remedy="use fewer workers, or raise the limits of `ulimit -a`",
        ) from error


class _Worker:
    """A process that runs one task after the other."""

    def __init__(self, work: str) -> None:
        self.stderr: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 # until the process ends
        try:
            self.process = subprocess.Popen(  # noqa: S603 # our own program
                [sys.executable, "-P", "-m", "tsas_cli.sweeping.worker", work],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self.stderr,
                text=True,
                encoding="utf-8",
                env=os.environ | ONE_THREAD,
                process_group=0,  # Ctrl-C is for the parent process
            )
        except OSError:
            self.stderr.close()
            raise

    def run(self, text: str) -> TaskOutcome | None:
        """Return the outcome of a task, or None if the process died."""
        assert self.process.stdin is not None  # noqa: S101 # they are pipes
        assert self.process.stdout is not None  # noqa: S101
        with suppress(BrokenPipeError):
            self.process.stdin.write(text + "\n")
            self.process.stdin.flush()
        line = self.process.stdout.readline()
        if not line.endswith("\n"):
            return None
        outcome: TaskOutcome = json.loads(line)
        return outcome

    def ending(self) -> str:
        """Return how the process ended, with the last line of its standard error."""
        code = self.process.wait()
        self.stderr.seek(0)
        last = self.stderr.read()[-STDERR_BYTES:].decode("utf-8", "replace").strip()
        self.kill()
        ended = f"ended by {signal.Signals(-code).name}" if code < 0 else f"ended with {code}"
        return ": ".join([ended, *last.splitlines()[-1:]])

    def kill(self) -> None:
        """Kill the process and close its pipes."""
        self.process.kill()
        self.process.wait()
        for stream in (self.process.stdin, self.process.stdout, self.stderr):
            if stream is not None:
                with suppress(BrokenPipeError, ValueError):
                    stream.close()
