"""JSON tables: rows, records or columns, at the top level or under a key."""

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

from tsas_cli.recordings.readers.offered import Column, Offered, flat
from tsas_cli.recordings.readers.table import ReadOptions
from tsas_cli.support.errors import InputError, nearest
from tsas_cli.support.files import Raw, read_json
from tsas_cli.support.wording import count_of


def offered(path: Path, options: ReadOptions) -> Iterator[Offered]:
    """Yield the columns of a JSON table.

    It is a list of rows, a list of records, or an object of columns, under the key `table` of the
    map (nested with dots). A key `columns` beside the rows names their columns; else they are
    numbered. Records in records are named by their paths.

    InputError: it is no such table.
    """
    above: Raw = {}
    content = _content(path)
    for key in options.table.split(".") if options.table else ():
        if not isinstance(content, dict) or key not in content:
            keys_here = list(content) if isinstance(content, dict) else []
            raise InputError(f"key {key} is missing", where=path, remedy=nearest(key, keys_here))
        above, content = content, content[key]
    names, column = _columns(content, above.get("columns"), path)
    header = tuple(
        f"{key} = {value}" for key, value in above.items() if isinstance(value, str | int | float)
    )
    yield Offered([Column(name, partial(column, i)) for i, name in enumerate(names)], header)


def tables(path: Path) -> list[str]:
    """Return the keys of rows, records or columns, nested with dots.

    InputError: the file is not JSON, or nested too deep.
    """
    return list(_tables(_content(path), ""))


def _content(path: Path) -> Any:
    return read_json(path, lines=path.suffix.lower() != ".json")


def _is_numbers(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and isinstance(value[0], int | float)


def _tables(content: Any, key: str) -> Iterator[str]:
    if key and isinstance(content, dict) and all(map(_is_numbers, content.values())):
        yield key
    elif isinstance(content, dict):
        for name, value in content.items():
            yield from _tables(value, f"{key}.{name}" if key else name)
    elif key and isinstance(content, list) and content and isinstance(content[0], list | dict):
        yield key


def _columns(content: Any, names: Any, path: Path) -> tuple[list[str], Callable[[int], list[Any]]]:
    """Return the names of the columns, and a function that returns a column by its index."""
    if isinstance(content, dict) and all(isinstance(c, list) for c in content.values()):
        return list(content), list(content.values()).__getitem__
    if isinstance(content, list) and content and all(isinstance(r, dict) for r in content):
        records = [dict(flat(record)) for record in content]
        names = list(dict.fromkeys(key for record in records for key in record))
        return names, lambda i: [record.get(names[i]) for record in records]
    if isinstance(content, list) and content and all(isinstance(r, list) for r in content):
        names = [str(n) for n in names] if isinstance(names, list) else [""] * len(content[0])
        for row, cells in enumerate(content, start=1):
            if len(cells) != len(names):
                raise InputError(
                    count_of(len(cells), "value"),
                    where=f"{path}, row {row}",
                    expected=str(len(names)),
                )
        return names, lambda i: [row[i] for row in content]
    keys = f"; its keys are: {', '.join(content)}" if isinstance(content, dict) else ""
    raise InputError(
        "holds no table here",
        where=path,
        expected="a list of rows, a list of records, or an object of columns",
        remedy=f'name the key that holds it in the map: table = "…" under [read]{keys}',
    )
