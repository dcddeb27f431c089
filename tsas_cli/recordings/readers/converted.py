"""Files that are converted to a file of another format before they are read, once each."""

import atexit
from functools import cache
from importlib import import_module
from pathlib import Path
from shutil import rmtree
from tempfile import mkdtemp
from typing import Any

from tsas_cli.recordings.guards import in_another_process
from tsas_cli.recordings.readers.table import ReadOptions
from tsas_cli.support.files import state_of

SHEETS = (".xlsx", ".xlsm", ".xlsb", ".xls", ".ods")
_PACKED = (".gz", ".bz2", ".xz", ".zip")
_CONVERTERS = dict.fromkeys(_PACKED, "packed") | {
    ".jsonl": "json_table",
    ".ndjson": "json_table",
    ".lvm": "labview",
    **dict.fromkeys(SHEETS, "spreadsheet"),
}
_ISOLATED = {"spreadsheet": "a spreadsheet"}
SUFFIXES = tuple(_CONVERTERS)
_KEPT = 3  # a file is asked for names and tables first, and may be converted twice
_made: dict[Any, Path] = {}


def tables(path: Path) -> list[str]:
    """Return the sheets of numbers in a spreadsheet, the longest first."""
    name = f"{__package__}.spreadsheet"
    return list(in_another_process(name, "tables", path, kind=_ISOLATED["spreadsheet"]))


def is_packed(path: Path) -> bool:
    """Return whether the name of a file says that it is packed."""
    return path.suffix.lower() in _PACKED


def converted(path: Path, options: ReadOptions) -> Path:
    """Return the temporary file of a known format that `path` is converted to.

    InputError: it is damaged, or holds no such file.
    OSError: a file cannot be read or written.
    """
    key = (path.absolute(), state_of(path), options.table, options.encoding)
    if key not in _made:
        while len(_made) >= _KEPT:
            rmtree(_made.pop(next(iter(_made))).parent, ignore_errors=True)
        folder = Path(mkdtemp(dir=_root()))
        try:
            _made[key] = _convert(path, folder, options)
        except BaseException:
            rmtree(folder, ignore_errors=True)
            raise
    return _made[key]


def _convert(path: Path, folder: Path, options: ReadOptions) -> Path:
    module = _CONVERTERS[path.suffix.lower()]
    name = f"{__package__}.{module}"
    if module in _ISOLATED:
        made = in_another_process(name, "convert", path, folder, options, kind=_ISOLATED[module])
    else:
        made = import_module(name).convert(path, folder, options)
    return Path(made)


@cache
def _root() -> Path:
    """Return the folder of all temporary files of this process."""
    root = Path(mkdtemp(prefix="tsas-"))
    atexit.register(rmtree, root, ignore_errors=True)
    return root
