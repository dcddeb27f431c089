"""Limit of the free memory for files that are loaded whole."""

import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from tsas_cli.support import limits
from tsas_cli.support.errors import InputError


def fits(path: object, bytes_: int) -> None:
    """Refuse a file that is loaded whole and exceeds the memory."""
    free = available()
    if bytes_ > free:
        raise InputError(
            f"needs {limits.size(bytes_)} of memory, and {limits.size(free)} are free",
            where=path,
            remedy=_remedy(path),
        )


def out_of_memory(path: object) -> InputError:
    """Return the error for a file that exhausted the memory."""
    return InputError(
        f"needs more memory than is free ({limits.size(available())})",
        where=path,
        remedy=_remedy(path),
    )


def _remedy(path: object) -> str:
    in_parts = "" if str(path).endswith(".parquet") else ", or export it as CSV or Parquet"
    return f"use a larger machine{in_parts}"


def available() -> int:
    """Return the memory that this process may still allocate, as far as it is known [bytes]."""
    import psutil

    free = [psutil.virtual_memory().available, *_of_container()]
    if sys.platform != "win32":
        import resource

        most, _ = resource.getrlimit(resource.RLIMIT_AS)
        used = psutil.Process().memory_info().vms
        free += [] if most == resource.RLIM_INFINITY else [most - used]
    return int(max(0, min(free)))


def _of_container() -> Iterator[int]:
    """Yield the free memory of the container, if it has a limit [bytes]."""
    group = Path("/sys/fs/cgroup")
    with suppress(OSError, ValueError):  # no such group, or "max"
        most, used = (int((group / f).read_text()) for f in ("memory.max", "memory.current"))
        yield most - used
