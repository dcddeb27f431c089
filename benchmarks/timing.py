"""The time of the fastest repeat, for every benchmark that times a function."""

import math
import time
from collections.abc import Callable


def best(solve: Callable[[], object], repeats: int) -> float:
    """Return the time of the fastest repeat [s]; the first call compiles and does not count."""
    solve()
    fastest = math.inf
    for _ in range(repeats):
        start = time.perf_counter_ns()
        solve()
        fastest = min(fastest, time.perf_counter_ns() - start)
    return 1e-9 * fastest
