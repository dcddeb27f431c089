"""How much a file may ask for, checked before the memory is taken; docs/untrusted.md states it.

What is read in parts (text tables, Parquet) has no limit of rows. What has to be loaded whole may
take the memory that is there. Nothing may expand to more than a recording can.
"""

import os
import re
import stat
from collections.abc import Iterable, Iterator, Sequence
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
FOOTER = 16 * MIB  # bytes of a Parquet file's description of itself
EXPANSION = 500  # times the size of a packed file; zeros reach 1032, channels at rest 24
PARQUET_EXPANSION = 5_000  # there an even clock and channels at rest reach 1700
HARMLESS = 256 * MIB  # which any file may expand to
COPIES = 3  # of what is loaded whole, until it is a recording
SEEDS = 10_000  # of noise, in one call
ITEMS = 1_000_000  # variables, cells, blocks of one file
# What no rig has, in the units of the canonical columns: a sentinel, or a number of another thing.
LARGEST = {"mm": 1e6, "N": 1e9, "rpm": 1e9, "rad": 1e9, "°C": 1e6}
SHORTEST_STEP_S, LONGEST_STEP_S = 1e-10, 1e9  # from a sample to the next
_DOTTED = re.compile(
    r"""(?<![\w"'.-])(?:(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+){%d}""" % DEPTH  # noqa: UP031
)


def text_of(path: Path, most: int) -> str:
    """Return the text of a file of at most `most` bytes in UTF-8, without its mark.

    Raises
    ------
    InputError
        It is no regular file, or larger.
    OSError, UnicodeDecodeError
        It cannot be read, or is other text.
    """
    # Without O_NONBLOCK a pipe that nobody writes to would be waited for.
    descriptor = os.open(
        path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    )
    with os.fdopen(descriptor, "rb") as stream:
        regular(path, os.fstat(descriptor))
        return decoded(stream.read(most + 1), path, most)


def decoded(content: bytes, path: object, most: int) -> str:
    """Return what was read of a file, as `text_of` does.

    Raises
    ------
    InputError, UnicodeDecodeError
        As from `text_of`.
    """
    if len(content) > most:
        raise InputError(
            f"is larger than {size(most)}", where=path, expected="what tsas or a person has written"
        )
    return content.decode("utf-8-sig")


def regular(path: Path, state: os.stat_result | None = None) -> None:
    """Refuse what is no file but a pipe or a device, which may never end, or has no text as name.

    Raises
    ------
    InputError
        It is one, or has none.
    OSError
        It is not there.
    """
    mode = (state or path.stat()).st_mode
    if not stat.S_ISREG(mode):
        kind = "a folder" if stat.S_ISDIR(mode) else "a pipe or a device"
        raise InputError(f"is {kind}", where=path, expected="a file")
    text_name(path)


def text_name(path: Path) -> None:
    """Refuse a place that no file can name, since its name holds bytes that are no UTF-8.

    Raises
    ------
    InputError
        It has such a name.
    """
    if not is_text(path):
        raise InputError("its name is no text", where=path, remedy="rename it")


def is_text(path: Path) -> bool:
    """Say whether the name of a place, or of a folder on the way that is given, is text."""
    return _encodable(str(path))


def toml(text: str, path: object) -> None:
    """Refuse TOML that would take its parser too long.

    Raises
    ------
    InputError
        It has too many runs or keys, or tables too deep in tables.
    """
    runs = text.count("\n[[")
    if runs > RUNS:
        raise InputError(
            f"holds {runs} runs",
            where=path,
            expected=f"at most {RUNS}",
            remedy="make several datasets of it",
        )
    keys = text.count("=")
    if keys > TOML_KEYS:
        raise InputError(f"holds {keys} keys", where=path, expected=f"at most {TOML_KEYS}")
    if _DOTTED.search(text):
        raise too_deep(path)


def depth(content: Any, path: object) -> None:
    """Refuse tables and lists that are nested too deep.

    Raises
    ------
    InputError
        They are.
    """
    level = [content]
    for _ in range(DEPTH):
        level = [v for outer in level for v in _members(outer) if isinstance(v, dict | list)]
        if not level:
            return
    raise too_deep(path)


def _members(value: Any) -> Iterable[Any]:
    return value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()


def reason(error: Exception) -> str:
    """Return why text cannot be parsed, for the line of an error."""
    said = str(error)
    return "an integer has thousands of digits" if "int_max_str" in said else said[:200]


def too_deep(path: object) -> InputError:
    """Return the error for what is nested too deep."""
    return InputError(
        "is nested too deep", where=path, expected=f"at most {DEPTH} tables or lists in each other"
    )


def lines(stream: TextIO, path: Path) -> Iterator[str]:
    """Yield the lines of a text table.

    Raises
    ------
    InputError
        A line is longer than any row of a recording.
    """
    row = 0
    while line := stream.readline(LINE + 1):
        row += 1
        if len(line) > LINE:
            raise InputError(
                f"is longer than {LINE} characters",
                where=f"{path}, row {row}",
                expected="a row of numbers that ends with its line",
                remedy="is this a text table?",
            )
        yield line


def columns(names: Sequence[str], path: object) -> None:
    """Refuse more columns than a recording has, or names that are no names.

    Raises
    ------
    InputError
        There are too many, or one is too long or no text.
    """
    column_count(len(names), path)
    for number, name in enumerate(names, start=1):
        if len(name) > NAME or not _encodable(name):
            raise InputError(
                f"the name of column {number} is no text of at most {NAME} characters",
                where=path,
                remedy="name it anew",
            )


def column_count(count: int, path: object) -> None:
    """Refuse more columns than a recording has.

    Raises
    ------
    InputError
        There are more.
    """
    if count > COLUMNS:
        raise InputError(
            f"holds {count} columns",
            where=path,
            expected=f"at most {COLUMNS}",
            remedy="is this a recording? split it, or export the channels that you need",
        )


def size(bytes_: int) -> str:
    """Return a number of bytes as people say it."""
    for unit, one in (("TB", 10**12), ("GB", 10**9), ("MB", 10**6), ("kB", 10**3)):
        if bytes_ >= one:
            return f"{bytes_ / one:.3g} {unit}"
    return f"{bytes_} bytes"


def _encodable(name: str) -> bool:
    try:
        name.encode()
    except UnicodeEncodeError:
        return False
    return True
