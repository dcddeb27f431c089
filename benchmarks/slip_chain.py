"""Nanoseconds per sample of the distributed model on a measured input, and its memory."""

import math
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from benchmarks.row import Row
from tests.physics.references import GROUP_A
from tsas_cli.numerics.conditioning import condition
from tsas_cli.physics.branches import branches
from tsas_cli.physics.slip_chain import DISPLACEMENT, FORCE, Boundary, slip_chain

WRAP = np.array([GROUP_A.friction_coefficient * GROUP_A.total_bend_rad])
PRELOAD = np.array([GROUP_A.preload_N])
TIME_S = np.arange(12566) / 1000.0  # two periods
REPEATS = 30
TIMES_LONGER = 100  # the run whose memory is looked at
PEAK, NOW = "VmHWM", "VmRSS"


def measure() -> Iterator[Row]:
    """Time each solver, compiled, on two periods; the best of several repeats counts."""
    x_in = 10.0 * (1.0 - np.cos(TIME_S))
    _, f_out, _ = branches(x_in, GROUP_A)
    x_out = (f_out - GROUP_A.preload_N) / GROUP_A.load_stiffness_N_per_mm
    drive = as_measured(x_in, noise=0.005, step=0.002)
    yield Row("closed form", best_ns(lambda: branches(drive, GROUP_A)), "ns", at_most=20.0)

    spring = Boundary(DISPLACEMENT, DISPLACEMENT, 1.0 / GROUP_A.load_stiffness_N_per_mm)
    loads = {
        "spring": (np.zeros_like(drive), spring),
        "force": (as_measured(f_out, noise=0.08, step=0.01), Boundary(DISPLACEMENT, FORCE, 0.0)),
        "displacement": (
            as_measured(x_out, noise=0.005, step=0.002),
            Boundary(DISPLACEMENT, DISPLACEMENT, 0.0),
        ),
    }
    for n, at_most in ((30, 2000.0), (60, None)):
        for name, (load, boundary) in loads.items():
            ns = best_ns(lambda: slip_chain(drive, load, WRAP, PRELOAD, GROUP_A, boundary, n))  # noqa: B023 # called at once
            yield Row(f"slip chain, {n} nodes, load {name}", ns, "ns", at_most)
    if sys.platform == "linux":
        megabytes = memory_beyond_output(np.tile(drive, TIMES_LONGER), spring)
        yield Row(f"memory beyond output, {TIMES_LONGER} such runs", megabytes, "MB", at_most=1.0)


def as_measured(values: np.ndarray, *, noise: float, step: float) -> np.ndarray:
    """Add noise, quantise, and condition as a recording is conditioned."""
    noisy = values + noise * np.random.default_rng(1).standard_normal(values.size)
    return condition(TIME_S, step * np.round(noisy / step)).values


def best_ns(solve: Callable[[], object]) -> float:
    """Return the time per sample of the fastest repeat; the first call compiles."""
    solve()
    best = math.inf
    for _ in range(REPEATS):
        start = time.perf_counter_ns()
        solve()
        best = min(best, time.perf_counter_ns() - start)
    return best / TIME_S.size


def memory_beyond_output(drive: np.ndarray, boundary: Boundary) -> float:
    """Return by how much the process grows at most over what the chain returns [MB]."""
    load = np.zeros_like(drive)
    Path("/proc/self/clear_refs").write_text("5", encoding="ascii")  # forgets earlier peaks
    before = memory(NOW)
    output = slip_chain(drive, load, WRAP, PRELOAD, GROUP_A, boundary, 30)
    return (memory(PEAK) - before - sum(column.nbytes for column in output)) / 1e6


def memory(field: str) -> int:
    """Return a field of the process's memory [bytes]."""
    lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
    return next(1024 * int(line.split()[1]) for line in lines if line.startswith(field))
