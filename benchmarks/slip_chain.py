"""Nanoseconds per sample of the distributed model on a measured input, and its memory."""

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks.row import Row
from benchmarks.timing import Times, times
from tests.physics.references import (
    GROUP_A,
    LOADED_BY_DISPLACEMENT,
    LOADED_BY_FORCE,
    LOADED_BY_SPRING,
    branches,
    course_of,
    slip_chain,
)
from tsas_cli.effects import EFFECTS
from tsas_cli.numerics.conditioning import condition
from tsas_cli.physics.ends import DriveInput, ends_of
from tsas_cli.physics.rig import Rig, with_values

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
    took = times(lambda: branches(drive, GROUP_A), repeats=1000)  # of 60 µs each
    yield per_sample("closed form", took, at_most=5.0)

    loads = {
        "spring": (0.0, LOADED_BY_SPRING),
        "force": (as_measured(f_out, noise=0.08, step=0.01), LOADED_BY_FORCE),
        "displacement": (as_measured(x_out, noise=0.005, step=0.002), LOADED_BY_DISPLACEMENT),
    }
    for n, at_most in ((30, 2000.0), (60, None)):
        for name, (load, boundary) in loads.items():
            course = course_of(drive, GROUP_A, load=load)
            took = times(lambda: slip_chain(course, GROUP_A, boundary, n), REPEATS)  # noqa: B023 # called at once
            yield per_sample(f"slip chain, {n} nodes, load {name}", took, at_most)
    rig = with_every_effect()
    ends = ends_of(rig, DriveInput(drive, time_s=TIME_S))
    took = times(lambda: slip_chain(ends.course, rig, ends.boundary, 30), REPEATS)
    yield per_sample("slip chain, 30 nodes, every effect at once", took, at_most=1000.0)
    if sys.platform == "linux":
        megabytes = memory_beyond_output(np.tile(drive, TIMES_LONGER))
        yield Row(f"memory beyond output, {TIMES_LONGER} such runs", megabytes, "MB", at_most=1.0)


def as_measured(values: np.ndarray, *, noise: float, step: float) -> np.ndarray:
    """Add noise, quantise, and condition as a recording is conditioned."""
    noisy = values + noise * np.random.default_rng(1).standard_normal(values.size)
    return condition(TIME_S, step * np.round(noisy / step)).values


def per_sample(name: str, took: Times, at_most: float | None) -> Row:
    """Return the time per sample."""
    return Row.timed(name, took, "ns", per_s=1e9 / TIME_S.size, at_most=at_most)


def with_every_effect() -> Rig:
    """Return the rig with every effect at the value from which a fit begins."""
    start = {f"{e.name}.{p.name}": p.start for e in EFFECTS for p in e.parameters}
    return with_values(GROUP_A, start)


def memory_beyond_output(drive: np.ndarray) -> float:
    """Return by how much the process grows at most over what the chain returns [MB]."""
    course = course_of(drive, GROUP_A)
    Path("/proc/self/clear_refs").write_text("5", encoding="ascii")  # forgets earlier peaks
    before = memory(NOW)
    output = slip_chain(course, GROUP_A, LOADED_BY_SPRING, 30)
    return (memory(PEAK) - before - sum(column.nbytes for column in output)) / 1e6


def memory(field: str) -> int:
    """Return a field of the process's memory [bytes]."""
    lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
    return next(1024 * int(line.split()[1]) for line in lines if line.startswith(field))
