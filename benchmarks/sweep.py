"""What `tsas sweep` costs over plain processes, with tasks of about one second, and two workers.

A task simulates the shipped runs with the dynamic model on 300 nodes, with a friction of its own.
Plain processes are a pool of `multiprocessing` that makes the same calls and writes the same files.
All are done in turn, several times, and the fastest counts: other work on the machine only adds.
"""

import json
import os
import resource
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from importlib.util import find_spec
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import tsas_cli as tsas
from benchmarks.row import Row
from tests.sweeping.clusters import cluster
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model, data_sheet
from tsas_cli.support.steps import Steps
from tsas_cli.sweeping.outcome import ONE_THREAD

DATASET = Path(__file__).parents[1] / "datasets" / "paper-groups"
OPTIONS: dict[str, Any] = {"dynamics": "lugre", "nodes": 300}
TASKS = int(os.environ.get("TSAS_SWEEP_TASKS", "10"))  # for each worker
ROUNDS = int(os.environ.get("TSAS_SWEEP_ROUNDS", "3"))
WORKER = ONE_THREAD | {"DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED": "False"}  # as docs/sweep.md
Fastest = dict[str, float]


class Clock(Steps):
    """Notes when each task is done."""

    def __init__(self) -> None:
        self.times_s: list[float] = []

    def __call__(self) -> None:
        """Take note of the time."""
        self.times_s.append(time.perf_counter())


def frictions(tasks: int) -> list[float]:
    """Return the value of each task."""
    return [0.1 + 0.05 * k / tasks for k in range(tasks)]


def called(call: tuple[float, str]) -> None:
    """Simulate once, as a task does."""
    friction, out = call
    data = tsas.read(DATASET)
    told = Model((Estimate("friction_coefficient", friction, "1", "given"),))
    tsas.simulate(data, model=told.over(data_sheet(data.manifest)), out=out, **OPTIONS)


def plain(folder: Path, workers: int) -> None:
    """Make the calls from a pool of plain processes."""
    calls = [(f, str(folder / f"{f:.6f}")) for f in frictions(TASKS * workers)]
    with get_context("spawn").Pool(workers) as pool:
        for _ in pool.imap_unordered(called, calls):
            pass
        pool.close()
        pool.join()


def swept(folder: Path, workers: int, address: str | None = None) -> tuple[float, float, float]:
    """Sweep; return the time between the first and the last answer, in tasks meanwhile [s].

    The third is the processor's time of a task; the first of each worker do not count.
    """
    clock = Clock()
    plan = {
        "stage": "simulate",
        "datasets": str(DATASET),
        "options": OPTIONS,
        "vary": {"friction_coefficient": frictions(TASKS * workers)},
    }
    took = {"workers": workers} if address is None else {"cluster": address}
    result = tsas.sweep(plan, out=folder, step=clock, **took)
    assert not result.failed  # noqa: S101 # else there is nothing to measure
    lines = (folder / "journal.jsonl").read_text(encoding="utf-8").splitlines()
    done = [json.loads(line) for line in lines][workers:]
    busy_s, cost_s = (sum(one[key] for one in done) for key in ("seconds", "processor_seconds"))
    return clock.times_s[-1] - clock.times_s[0], busy_s, cost_s / len(done)


def timed(work: Callable[[Path], object]) -> tuple[float, float]:
    """Do work in a folder of its own; return its time, and that of the processor in children."""
    with tempfile.TemporaryDirectory() as name:
        start, before = time.perf_counter(), _of_children_s()
        work(Path(name) / "out")
        return time.perf_counter() - start, _of_children_s() - before


def _of_children_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def measure() -> Iterator[Row]:
    """Yield what a sweep costs over plain processes, and how well two workers are used."""
    os.environ.update(ONE_THREAD)
    found: dict[str, list[float]] = {}

    def keep(name: str, value: float) -> None:
        found.setdefault(name, []).append(value)
        print(f"  {name}: {value:.4g}", file=sys.stderr)

    def spans(name: str, workers: int, address: str | None = None) -> Callable[[Path], None]:
        def work(folder: Path) -> None:
            span_s, busy_s, cost_s = swept(folder, workers, address)
            keep(f"{name}: cost", cost_s)
            keep(f"{name}: pace", span_s / (TASKS * workers - 1))
            keep(f"{name}: idle", 100.0 * (1.0 - busy_s / (workers * span_s)))

        return work

    timed(lambda folder: plain(folder, 1))  # compiles
    for _ in range(ROUNDS):
        wall_s, processor_s = timed(lambda folder: plain(folder, 1))
        keep("plain", wall_s)
        keep("plain: processor", processor_s)
        wall_s, processor_s = timed(spans("one", 1))
        keep("local", wall_s)
        keep("local: processor", processor_s)
        timed(spans("two", 2))
        if find_spec("distributed"):
            with tempfile.TemporaryDirectory() as name, cluster(Path(name)) as made:
                other, _ = made.add(**WORKER), made.add(**WORKER)
                timed(spans("two of a cluster", 2, made.address))
                other.terminate()
                other.wait()
                timed(spans("one of a cluster", 1, made.address))
    yield from rows({name: min(values) for name, values in found.items()})


def rows(fastest: Fastest) -> Iterator[Row]:
    """Yield the rows from the fastest of each."""
    yield Row("a task, processor's time", fastest["one: cost"], "s")
    for name, over in (("time", ""), ("processor's time", ": processor")):
        more = fastest[f"local{over}"] / fastest[f"plain{over}"] - 1.0
        yield Row(f"{name} over plain processes, with their start", 100.0 * more, "%", at_most=5.0)
    for name, label in (("one", "local"), ("one of a cluster", "cluster")):
        if f"{name}: idle" in fastest:
            yield Row(f"between tasks, {label}", fastest[f"{name}: idle"], "%", at_most=5.0)
    for name, one, label in (
        ("two", "one", "local"),
        ("two of a cluster", "one of a cluster", "cluster"),
    ):
        if f"{name}: pace" in fastest:
            share = fastest[f"{one}: pace"] / (2.0 * fastest[f"{name}: pace"])
            yield Row(f"efficiency of two workers, {label}", 100.0 * share, "%", at_least=85.0)
            # Of the time that two workers have, the part in tasks, less what a task costs more than
            # with one: this does not move with what else the machine does.
            busy = 1.0 - fastest[f"{name}: idle"] / 100.0
            share = busy * fastest[f"{one}: cost"] / fastest[f"{name}: cost"]
            told = f"efficiency of two workers, {label}, by the processor's time"
            yield Row(told, 100.0 * share, "%", at_least=85.0)
