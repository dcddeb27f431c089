"""The dynamic chain beside general solvers on the same equations, at equal error, in one run."""

import math
import os
import time
from collections.abc import Iterator

import numpy as np

from benchmarks.lugre_rivals.drives import Sine, Sines
from benchmarks.lugre_rivals.ode import Model, Output, Problem
from benchmarks.lugre_rivals.references import tight
from benchmarks.lugre_rivals.solution import NotAvailableError
from benchmarks.lugre_rivals.solvers import RIVALS
from benchmarks.row import Row
from benchmarks.timing import best, times
from tests.physics.references import LOADED_BY_SPRING, TABLE_1, course_of
from tsas_cli.numerics.side_by_side import each
from tsas_cli.physics.course import PULLED, RELEASED
from tsas_cli.physics.course import Output as ChainOutput
from tsas_cli.physics.lugre.chain import OWN_STEPS, Progress, StepControl, lugre_chain
from tsas_cli.physics.response import TOLERANCE
from tsas_cli.physics.rig import Rig

LUMPS = 50
TIME_S = np.arange(12566) / 1000.0  # two periods of group a
DRIVE = Sines((Sine(10.0, 1.0),))
COURSE = course_of(DRIVE.position(TIME_S), TABLE_1, time_s=TIME_S)
AT_LEAST = {"CVODE in C": 30.0, "LSODA": 100.0, "CVODE, scikit-sundae": 150.0}  # times slower
EQUAL = 4e-5  # tolerance for an error of less than 0.05 % of f_in, as the rivals have it
REPEATS, RIVALS_REPEATS = 60, 5
SETS = 64


def measure() -> Iterator[Row]:
    """Time the chain, the rivals after each other, a fixed step, and many rigs at once."""
    problem = Problem(Model(LUMPS), DRIVE, TIME_S)
    exact = tight(problem)
    found, progress = own()
    took = times(own, REPEATS)
    seconds = took.least
    yield Row.timed("two periods", took, "ms", per_s=1e3)
    yield Row("times faster than real", TIME_S[-1] / seconds, "", kind="rate")
    yield from errors("own", Output(found.f_in, found.f_out, found.x_out), exact, limit=0.05)
    per = seconds / (LUMPS * (progress.iterations + progress.tries))
    yield Row("per lump and evaluation", 1e9 * per, "ns", at_most=10.0)
    for rival in RIVALS:
        try:
            output = rival.solve(problem, rival.tolerance)
        except NotAvailableError as error:
            yield Row(f"{rival.name}: {error}", math.nan, "")
            continue
        slow, fast = math.inf, math.inf
        for _ in range(RIVALS_REPEATS):
            begin = time.perf_counter()
            rival.solve(problem, rival.tolerance)
            slow = min(slow, time.perf_counter() - begin)
            fast = min(fast, best(own, repeats=REPEATS // RIVALS_REPEATS))
        yield Row(rival.name, 1e3 * slow, "ms")
        yield from errors(rival.name, output, exact)
        limit = AT_LEAST.get(rival.name)
        yield Row(f"{rival.name}, times slower", slow / fast, "", at_least=limit, kind="gain")
    usual = times(lambda: own(tolerance=TOLERANCE), REPEATS)
    yield Row.timed("at the usual tolerance, two periods", usual, "ms", per_s=1e3)
    real = TIME_S[-1] / best(lambda: own(step_ends_s=TIME_S[1:]), repeats=10)
    yield Row("a step at every ms, times faster than real", real, "", at_least=1500.0, kind="rate")
    os.environ["TSAS_THREADS"] = "2"
    rigs = [TABLE_1._replace(friction_coefficient=0.1 + 0.001 * i) for i in range(SETS)]
    many = best(lambda: each(own, rigs), repeats=5)
    yield Row(f"{SETS} rigs on two threads, over one", many / best(own, REPEATS), "", at_most=40.0)


def own(
    rig: Rig = TABLE_1, *, tolerance: float = EQUAL, step_ends_s: np.ndarray = OWN_STEPS
) -> tuple[ChainOutput, Progress]:
    """Follow the run from rest."""
    course = COURSE.copy()
    course[[PULLED, RELEASED]] = rig.friction_coefficient * rig.total_bend_rad
    start = np.zeros((2, LUMPS + 2))
    start[1] = rig.preload_N
    control = StepControl(tolerance, step_ends_s)
    output, progress = lugre_chain(course, start, rig, LOADED_BY_SPRING, LUMPS, control)
    return output, progress


def errors(name: str, found: Output, exact: Output, limit: float | None = None) -> Iterator[Row]:
    """Return the largest differences of both tensions, over their ranges."""
    for channel, at_most in (("f_in_N", limit), ("f_out_N", None)):
        off = np.abs(getattr(found, channel) - getattr(exact, channel))
        share = np.max(off) / np.ptp(getattr(exact, channel))
        yield Row(f"{name}, largest error of {channel}", 100.0 * share, "%", at_most=at_most)
