"""What a file takes when it is loaded, against the memory there is."""

import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from tsas_cli.support import limits
from tsas_cli.support.errors import InputError


def fits(path: object, bytes_: int) -> None:
    """Refuse what has to be loaded whole and is larger than the memory.

    Raises
    ------
    InputError
        It is.
    """
    there = available()
    if bytes_ > there:
        raise InputError(
            f"takes {limits.size(bytes_)} of memory, and {limits.size(there)} are there",
            where=path,
            remedy=_otherwise(path),
        )


def out_of_memory(path: object) -> InputError:
    """Return the error for a file that took more memory than there was."""
    return InputError(
        f"takes more memory than there is ({limits.size(available())} are left)",
        where=path,
        remedy=_otherwise(path),
    )


def _otherwise(path: object) -> str:
    in_parts = "" if str(path).endswith(".parquet") else ", or export it as CSV or Parquet"
    return f"use a larger machine{in_parts}"


def available() -> int:
    """Return the bytes of memory that this process may still take, as far as it can be told."""
    import psutil

    there = [psutil.virtual_memory().available, *_of_container()]
    if sys.platform != "win32":
        import resource

        most, _ = resource.getrlimit(resource.RLIMIT_AS)
        taken = psutil.Process().memory_info().vms
        there += [] if most == resource.RLIM_INFINITY else [most - taken]
    return int(max(0, min(there)))


def _of_container() -> Iterator[int]:
    """Yield what the container may still take, where this is in one that has a limit."""
    group = Path("/sys/fs/cgroup")
    with suppress(OSError, ValueError):  # no such group, or "max"
        most, taken = (int((group / f).read_text()) for f in ("memory.max", "memory.current"))
        yield most - taken
