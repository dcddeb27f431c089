"""Worker processes on this machine, each with one task at a time, so that a death has a task."""

import json
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from threading import local

from tsas_cli.support.errors import InputError
from tsas_cli.support.worker_process import WorkerProcess
from tsas_cli.sweeping.outcome import ONE_THREAD, TaskOutcome, run_task, worker_death

TRIES = 2  # of a task whose worker dies


def in_processes(
    work: str, texts: Sequence[str], workers: int
) -> Iterator[tuple[int, TaskOutcome]]:
    """Yield the number and the outcome of each task, in the order of completion.

    `work` is the function to call, `module:function`, in at most `workers` processes. A task whose
    worker dies is repeated once by a new one. If the loop over the outcomes ends early, the workers
    are killed.

    InputError: no further process can be started.
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
        while any(future.running() for future in numbers):  # it may be about to start a worker
            crew.kill()
            time.sleep(0.05)
        pool.shutdown()
        crew.kill()


class _Crew:
    """One worker per thread, replaced if it dies."""

    def __init__(self, work: str) -> None:
        self.work, self.stopped = work, False
        self.own, self.started = local(), list[WorkerProcess]()

    def run(self, text: str) -> TaskOutcome:
        """Return the outcome of a task from this thread's worker."""
        message = ""
        for _ in range(TRIES):
            if self.stopped:
                break
            worker = getattr(self.own, "worker", None) or self._start()
            try:
                done = worker.call(f"{run_task.__module__}:{run_task.__name__}", self.work, text)
            except EOFError as death:
                message, self.own.worker = str(death), None
            else:
                outcome: TaskOutcome = json.loads(done)
                return outcome
        return worker_death(TRIES, message)

    def kill(self) -> None:
        """Kill every worker."""
        for worker in self.started:
            worker.kill()

    def _start(self) -> WorkerProcess:
        try:
            self.own.worker = worker = WorkerProcess(heard=True, **ONE_THREAD)
        except OSError as error:
            raise InputError(
                f"no process can be started ({error.strerror})",
                where="--workers",
                remedy="use fewer workers, or raise the limits of `ulimit -a`",
            ) from error
        self.started.append(worker)
        return worker
