"""Worker processes on this machine, each with one task at a time, to know which one died."""

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
from tsas_cli.sweeping.answer import Answer, death
from tsas_cli.sweeping.versions import ONE_THREAD

TRIES = 2  # of a task whose worker dies
LAST_WORDS = 500  # bytes of what a dead worker said


def in_processes(work: str, texts: Sequence[str], workers: int) -> Iterator[tuple[int, Answer]]:
    """Yield the number and the answer of each task as they come.

    A task whose worker dies is tried once more by a new one. When the loop over the answers ends
    early, the workers are killed.

    Parameters
    ----------
    work
        The function that answers, `module:function`.
    texts
        The tasks.
    workers
        How many processes at most.

    Raises
    ------
    InputError
        The machine starts no more of them.
    """
    crew = _Crew(work)
    pool = ThreadPoolExecutor(max(1, min(workers, len(texts))))
    numbers = {pool.submit(crew.answer, text): number for number, text in enumerate(texts)}
    try:
        for future in as_completed(numbers):
            yield numbers[future], future.result()
    finally:
        crew.stopped = True
        pool.shutdown(wait=False, cancel_futures=True)
        while any(future.running() for future in numbers):  # one may be about to begin a worker
            crew.kill()
            time.sleep(0.05)
        pool.shutdown()
        crew.kill()


class _Crew:
    """The worker of each thread, and another one when that dies."""

    def __init__(self, work: str) -> None:
        self.work, self.stopped = work, False
        self.own, self.begun = local(), list[_Worker]()

    def answer(self, text: str) -> Answer:
        """Return the answer of this thread's worker to a task."""
        said = ""
        for _ in range(TRIES):
            if self.stopped:
                break
            worker = getattr(self.own, "worker", None) or self._begin()
            answer = worker.ask(text)
            if answer is not None:
                return answer
            said, self.own.worker = worker.ending(), None
        return death(TRIES, said)

    def kill(self) -> None:
        """Kill every worker."""
        for worker in self.begun:
            worker.kill()

    def _begin(self) -> "_Worker":
        self.own.worker = worker = _begun(self.work)
        self.begun.append(worker)
        return worker


def _begun(work: str) -> "_Worker":
    try:
        return _Worker(work)
    except OSError as error:
        raise InputError(
            f"no process can be started ({error.strerror})",
            where="--workers",
            remedy="take fewer, or raise what `ulimit -a` tells",
        ) from error


class _Worker:
    """A process that answers one task after the other."""

    def __init__(self, work: str) -> None:
        self.said: IO[bytes] = tempfile.TemporaryFile()  # noqa: SIM115 # until the process ends
        try:
            self.process = subprocess.Popen(  # noqa: S603 # our own program
                [sys.executable, "-P", "-m", "tsas_cli.sweeping.worker", work],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self.said,
                text=True,
                encoding="utf-8",
                env=os.environ | ONE_THREAD,
                process_group=0,  # Ctrl-C is for who hands out the tasks
            )
        except OSError:
            self.said.close()
            raise

    def ask(self, text: str) -> Answer | None:
        """Return the answer to a task, or None where the process died."""
        assert self.process.stdin is not None  # noqa: S101 # they are pipes
        assert self.process.stdout is not None  # noqa: S101
        with suppress(BrokenPipeError):
            self.process.stdin.write(text + "\n")
            self.process.stdin.flush()
        line = self.process.stdout.readline()
        if not line.endswith("\n"):
            return None
        answer: Answer = json.loads(line)
        return answer

    def ending(self) -> str:
        """Return how the process has ended, with its last words."""
        code = self.process.wait()
        self.said.seek(0)
        last = self.said.read()[-LAST_WORDS:].decode("utf-8", "replace").strip()
        self.kill()
        ended = f"ended by {signal.Signals(-code).name}" if code < 0 else f"ended with {code}"
        return ": ".join([ended, *last.splitlines()[-1:]])

    def kill(self) -> None:
        """End the process, whatever it does."""
        self.process.kill()
        self.process.wait()
        for stream in (self.process.stdin, self.process.stdout, self.said):
            if stream is not None:
                with suppress(BrokenPipeError, ValueError):
                    stream.close()
