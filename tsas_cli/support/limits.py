"""Limits on files, checked before memory is allocated; docs/untrusted.md lists them.

Formats that are read in parts (text tables, Parquet) have no limit of rows; those that are loaded
whole are limited by the free memory. No file may expand to more than a recording can hold.
"""

import math
import os
import re
import stat
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, TextIO

from tsas_cli.support.errors import InputError

MIB = 1 << 20
TOML_BYTES = 16 * MIB
TOML_KEYS = 500_000
JSON_BYTES = 1024 * MIB
JSON_EXPANDS = 25  # bytes in memory for one in the file, at most
DEPTH = 100  # tables in tables, lists in lists, groups in groups
RUNS = 50_000  # of a dataset, and files of one ingest
UNKNOWN_KEYS = 1_000  # of a table of the manifest
COLUMNS = 10_000
NAME = 1_000  # characters of a column's name
LINE = MIB  # characters of a line of a text table
HEADER = 16 * MIB  # characters of the comments above it
FOOTER = 16 * MIB  # bytes of a Parquet file's footer
EXPANSION = 500  # times the size of a compressed file; zeros reach 1032, constant channels 24
PARQUET_EXPANSION = 5_000  # likewise; an even clock and constant channels reach 1700
HARMLESS = 256 * MIB  # to which any file may expand
LOADING = 1_200_000_000  # bytes of addresses that the libraries take
COPIES = 3  # in memory of a file that is loaded whole
SEEDS = 10_000  # of noise, in one call
ITEMS = 1_000_000  # variables, cells, blocks of one file
# Largest plausible magnitudes of the canonical columns by unit; beyond are sentinels and mix-ups.
LARGEST = {"mm": 1e6, "N": 1e9, "rpm": 1e9, "rad": 1e9, "°C": 1e6}
SMALLEST = 1e-30  # of what a channel reaches, in any unit: far below what rounding leaves of zero
SHORTEST_STEP_S, LONGEST_STEP_S = 1e-10, 1e9  # from a sample to the next
LONGEST_PAUSE = 1e3  # in a recording, of the time without it
THREADS = "TSAS_THREADS"  # environment variable: how many threads, by default one for each core
MOST_THREADS = 10_000
_DOTTED = re.compile(
    r"""(?<![\w"'.-])(?:(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+){%d}""" % DEPTH  # noqa: UP031
)


def text_of(path: Path, most: int) -> str:
    """Return the text of a UTF-8 file of at most `most` bytes, without its byte-order mark.

    InputError: the file is not regular, or too large.
    OSError, UnicodeDecodeError: the file cannot be read, or is not UTF-8.
    """
    # Without O_NONBLOCK, opening a pipe without a writer would block.
    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    with os.fdopen(descriptor, "rb") as stream:
        regular(path, os.fstat(descriptor))
        return decoded(stream.read(most + 1), path, most)


def decoded(content: bytes, path: object, most: int) -> str:
    """Return the content of a file as text, as `text_of` does."""
    if len(content) > most:
        raise InputError(
            f"is larger than {size(most)}", where=path, expected="a file written by tsas or by hand"
        )
    return content.decode("utf-8-sig")


def regular(path: Path, state: os.stat_result | None = None) -> None:
    """Refuse a pipe or a device, which may never end, a folder, or a name that is not UTF-8."""
    mode = (state or path.stat()).st_mode
    if not stat.S_ISREG(mode):
        kind = "a folder" if stat.S_ISDIR(mode) else "a pipe or a device"
        raise InputError(f"is {kind}", where=path, expected="a file")
    text_name(path)


def text_name(path: Path) -> None:
    """Refuse a path that is not UTF-8, since no output can record it."""
    if not is_text(path):
        raise InputError("its name is not UTF-8", where=path, remedy="rename it")


def is_text(name: object) -> bool:
    """Return whether a path or a name is valid UTF-8."""
    try:
        str(name).encode()
    except UnicodeEncodeError:
        return False
    return True


def toml(text: str, path: object) -> None:
    """Refuse TOML whose parsing would take too long."""
    runs = text.count("\n[[")
    if runs > RUNS:
        raise InputError(
            f"holds {runs} runs",
            where=path,
            expected=f"at most {RUNS}",
            remedy="split it into several datasets",
        )
    keys = text.count("=")
    if keys > TOML_KEYS:
        raise InputError(f"holds {keys} keys", where=path, expected=f"at most {TOML_KEYS}")
    if _DOTTED.search(text):
        raise too_deep(path)


def depth(content: Any, path: object) -> None:
    """Refuse tables and lists that are nested too deep."""
    level = [content] if isinstance(content, dict | list) else []
    for _ in range(DEPTH):
        outer = [each.values() if isinstance(each, dict) else each for each in level]
        level = [v for each in outer for v in each if isinstance(v, dict | list)]
        if not level:
            return
    raise too_deep(path)


def reason(error: Exception) -> str:
    """Return the reason of a parser error, for a message."""
    text = str(error)
    return "an integer has thousands of digits" if "int_max_str" in text else text[:200]


def too_deep(path: object) -> InputError:
    """Return the error for content that is nested too deep."""
    return InputError(
        "is nested too deep", where=path, expected=f"at most {DEPTH} tables or lists in each other"
    )


def lines(stream: TextIO, path: Path) -> Iterator[str]:
    """Yield the lines of a text table; InputError: a line exceeds the limit."""
    row = 0
    while line := stream.readline(LINE + 1):
        row += 1
        if len(line) > LINE:
            raise InputError(
                f"is longer than {LINE} characters",
                where=f"{path}, row {row}",
                expected="a row of numbers per line",
                remedy="is this a text table?",
            )
        yield line


def columns(names: Sequence[str], path: object) -> None:
    """Refuse too many columns, or invalid names."""
    column_count(len(names), path)
    for number, name in enumerate(names, start=1):
        if len(name) > NAME or not is_text(name):
            raise InputError(
                f"the name of column {number} is not UTF-8 or longer than {NAME} characters",
                where=path,
                remedy="rename it",
            )


def column_count(count: int, path: object) -> None:
    """Refuse too many columns."""
    if count > COLUMNS:
        raise InputError(
            f"holds {count} columns",
            where=path,
            expected=f"at most {COLUMNS}",
            remedy="is this a recording? split it, or export the channels that you need",
        )


def size(bytes_: int) -> str:
    """Return a number of bytes with a decimal unit."""
    for unit, one in (("TB", 10**12), ("GB", 10**9), ("MB", 10**6), ("kB", 10**3)):
        if bytes_ >= one:
            return f"{bytes_ / one:.3g} {unit}"
    return f"{bytes_} bytes"


def loadable() -> None:
    """Refuse what libraries cannot be loaded in, or no path be found in.

    Under a low limit of memory they abort, or never end.
    """
    for name in (THREADS, "NUMBA_NUM_THREADS"):
        threads_by(name)
    try:
        os.getcwd()  # noqa: PTH109 # without a Path
    except OSError as error:
        raise InputError(
            f"the current folder cannot be found ({error.strerror})",
            expected="one that exists",
            remedy="change to another folder",
        ) from error
    if __doc__ is None:
        raise InputError(
            "Python runs without docstrings, which hold the texts of the effects",
            expected="no `-OO`, and no PYTHONOPTIMIZE of 2",
            remedy="unset PYTHONOPTIMIZE",
        )
    most = _most_addresses()
    if most < LOADING:
        raise InputError(
            f"this process may take {size(int(most))} of memory",
            expected=f"at least {size(LOADING)}, which the libraries take",
            remedy="raise the limit (`ulimit -v`)",
        )


def threads_by(name: str) -> int | None:
    """Return a number of threads that an environment variable sets, None where it sets none.

    InputError: it is no such number.
    """
    asked = os.environ.get(name)
    if asked is None or (name == THREADS and not asked):
        return None
    if not re.fullmatch("[0-9]{1,9}", asked) or not 1 <= int(asked) <= MOST_THREADS:
        raise InputError(
            f"{name} is {asked!r}",
            where="environment",
            expected=f"a whole number from 1 to {MOST_THREADS}",
            remedy=f"correct it, or unset {name}",
        )
    return int(asked)


def fits(path: object, bytes_: int) -> None:
    """Refuse a file that is loaded whole and exceeds the memory."""
    free = available()
    if bytes_ > free:
        raise InputError(
            f"needs {size(bytes_)} of memory, and {size(free)} are free",
            where=path,
            remedy=_remedy(path),
        )


def out_of_memory(path: object) -> InputError:
    """Return the error for a file that exhausted the memory."""
    return InputError(
        f"needs more memory than is free ({size(available())})",
        where=path,
        remedy=f"see whether the file is whole; else {_remedy(path)}",
    )


def _remedy(path: object) -> str:
    in_parts = "" if str(path).endswith(".parquet") else ", or export it as CSV or Parquet"
    return f"use a larger machine{in_parts}"


def available() -> int:
    """Return the memory that this process may still allocate, as far as it is known [bytes]."""
    import psutil

    free = [psutil.virtual_memory().available, *_of_container()]
    if (most := _most_addresses()) < math.inf:
        free.append(int(most) - psutil.Process().memory_info().vms)
    return int(max(0, min(free)))


def _most_addresses() -> float:
    """Return the limit of this process's addresses [bytes], infinite without one."""
    import resource

    most, _ = resource.getrlimit(resource.RLIMIT_AS)
    return math.inf if most == resource.RLIM_INFINITY else float(most)


def _of_container() -> Iterator[int]:
    """Yield the free memory of the container, if it has a limit [bytes]."""
    group = Path("/sys/fs/cgroup")
    with suppress(OSError, ValueError):  # no such group, or "max"
        most, used = (int((group / f).read_text()) for f in ("memory.max", "memory.current"))
        yield most - used
