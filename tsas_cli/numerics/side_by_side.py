"""Independent calls on threads: compiled kernels release the interpreter's lock."""

import os
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
    pool = threads() if at_once else 1
    if pool < 2 or len(items) < 2:
        return [function(item) for item in items]
    return list(_pool(pool).map(function, items))  # after an error it begins no other item


def threads() -> int:
    """Return how many threads share such calls.

    InputError: the environment variable is not a whole number.
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


os.register_at_fork(after_in_child=_pool.cache_clear)  # a fork has none of its parent's threads
