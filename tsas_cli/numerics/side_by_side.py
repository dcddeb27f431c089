"""Independent calls on threads: compiled kernels release the interpreter's lock."""

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import TypeVar

from tsas_cli.support.limits import THREADS, threads_by

Item = TypeVar("Item")
Result = TypeVar("Result")


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

    InputError: the environment variable is no such number.
    """
    return threads_by(THREADS) or os.cpu_count() or 1


@cache
def _pool(threads: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(threads)


os.register_at_fork(after_in_child=_pool.cache_clear)  # a fork has none of its parent's threads
