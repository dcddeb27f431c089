"""Independent calls on threads: compiled kernels release the interpreter's lock."""

import os
from collections import deque
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import TypeVar

from tsas_cli.support.errors import InputError

Item = TypeVar("Item")
Result = TypeVar("Result")

THREADS = "TSAS_THREADS"  # environment variable: how many threads, by default one for each core


def each(
    function: Callable[[Item], Result], items: Sequence[Item], *, at_once: bool = True
) -> list[Result]:
    """Return the function of each item, in their order; it must not change shared data.

    Call short or mostly Python functions without `at_once`: they lose more to the interpreter's
    lock than threads save.
    """
    if not at_once:
        return [function(item) for item in items]
    pool = threads()
    if pool < 2 or len(items) < 2:
        return [function(item) for item in items]
    found: dict[int, Result] = {}
    waiting = iter(range(len(items)))  # shared by all threads: a fixed split is slower

    def work(_: int) -> None:
        try:
            for k in waiting:
                found[k] = function(items[k])
        finally:
            deque(waiting, maxlen=0)  # after an error none begins another item

    try:
        deque(_pool(pool).map(work, range(min(pool, len(items)))), maxlen=0)
    finally:
        deque(waiting, maxlen=0)  # nor after Ctrl-C
    return [found[k] for k in range(len(items))]


def threads() -> int:
    """Return how many threads share such calls.

    Raises
    ------
    InputError
        The environment variable is not a whole number.
    """
    asked = os.environ.get(THREADS) or str(os.cpu_count() or 1)
    if not asked.isdecimal():
        raise InputError(
            f"{THREADS} is {asked!r}", where="environment", expected="a whole number, 1 or more"
        )
    return int(asked)


@cache
def _pool(threads: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(threads)
