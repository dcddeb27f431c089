"""One reader per file format, selected by the suffix of the file name.

Packed files and those of spreadsheets are first converted to a file of another known format.
"""

import shlex
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

from tsas_cli.recordings.guards import in_another_process
from tsas_cli.recordings.readers import converted, offered
from tsas_cli.recordings.readers.table import ColumnSource, ColumnTable, ReadOptions, whole
from tsas_cli.support import limits
from tsas_cli.support.errors import InputError

_UNPACKED = "unpack it and ingest the folder {folder}: "
_PANDAS = 'convert it{}: python -c "import pandas, sys; pandas.{}(sys.argv[1]).to_parquet('
_PANDAS += 'sys.argv[2])" {{file}} {{parquet}}'
_WAYS = {  # from a file that is not read to one that is, by its suffix
    ".tar": f"{_UNPACKED}mkdir -p {{folder}} && tar -xf {{file}} -C {{folder}}",
    ".7z": f"{_UNPACKED}7z x {{file}} -o{{folder}}",
    ".rar": f"{_UNPACKED}unrar x {{file}} {{folder}}/",
    ".orc": _PANDAS.format("", "read_orc"),
    ".pkl": _PANDAS.format(" (only if you trust it: the file may run code)", "read_pickle"),
    ".nc": "copy it: cp {file} {hdf5}",
    ".log": "copy it: cp {file} {text}",
}
_SAME_WAY = {".tgz": ".tar", ".tbz": ".tar", ".txz": ".tar", ".pickle": ".pkl", ".nc4": ".nc"}
_SAME_WAY |= dict.fromkeys((".out", ".prn"), ".log")
_EXPORTED = "export it from the program that has written it, as CSV or Parquet"
_SHEETS = (".xlsx", ".xlsm", ".xlsb", ".xls", ".ods")
_FORMATS = (  # suffixes, reader, and what they are if its library crashes on damaged files
    ((".csv", ".tsv", ".txt", ".dat", ".asc"), "delimited", ""),
    ((".mat",), "matlab", "a MATLAB file"),
    ((".mf4", ".mdf"), "mdf", "MDF"),
    ((".json", ".jsonl", ".ndjson"), "json_table", ""),
    ((".parquet",), "parquet", ""),
    ((".feather", ".arrow"), "feather", "Feather"),
    ((".npy", ".npz"), "numpy_file", "a NumPy file"),
    ((".h5", ".hdf5"), "hdf5", "HDF5"),
    ((".tdms",), "tdms", "TDMS"),
    ((".mcap",), "bags", "MCAP"),
    ((".bag",), "bags", "a bag of ROS 1"),
    ((".db3",), "bags", "a bag of ROS 2"),
    ((".join",), "joined", ""),
    (converted.PACKED, "converted", ""),
    ((".lvm",), "labview", ""),
    (_SHEETS, "spreadsheet", "a spreadsheet"),
)
_READERS = {suffix: (module, kind) for suffixes, module, kind in _FORMATS for suffix in suffixes}
_CONVERTING = ("converted", "labview", "spreadsheet")  # to a file of another format
_IN_PARTS = ("delimited", "parquet")  # they have `batches` and `names`, the others `offered`
_WITH_TABLES = ("json_table", "matlab", "spreadsheet")
SUFFIXES = tuple(_READERS)
READABLE = (
    "CSV or other text, MATLAB, HDF5, NumPy, Parquet, Feather, JSON, a spreadsheet, TDMS, LVM, "
    f"MDF, MCAP or a ROS bag, plain or in {' '.join(converted.PACKED)}"
)


def read(path: Path, options: ReadOptions, wanted: Sequence[ColumnSource]) -> ColumnTable:
    """Return the requested columns of one file.

    InputError: the suffix is unknown, the file is empty or damaged, or a requested column is
    missing or not numeric.
    """
    return whole(batches(path, options, wanted))


def batches(
    path: Path, options: ReadOptions, wanted: Sequence[ColumnSource]
) -> Iterator[ColumnTable]:
    """Yield the requested columns in parts of `BATCH_ROWS` rows, or whole for some formats.

    InputError: as from `read`; a fault in a later part is raised with that part.
    """
    with _checked(path, options) as (module, file):
        if module in _IN_PARTS:
            yield from _call("batches", file, options, wanted)
        else:
            yield _call("read", file, options, wanted)


def names(path: Path, options: ReadOptions) -> tuple[str, ...]:
    """Return the names of a file's columns by number; empty text for a column without a name."""
    with _checked(path, options) as (_, file):
        found = tuple(_call("names", file, options))
    limits.columns(found, path)
    return found


def tables(path: Path) -> list[str]:
    """Return the valid values of `table` in a map: sheets, or tables in a JSON or MATLAB file."""
    with _checked(path, ReadOptions(), but=_SHEETS) as (module, file):
        return list(_call("tables", file)) if module in _WITH_TABLES else []


def text_of(path: Path, options: ReadOptions) -> Path | None:
    """Return the text table in a file: the file itself, or what it is converted to; else None."""
    with _checked(path, options) as (module, file):
        return file if module == "delimited" else None


def is_known(path: Path) -> bool:
    """Return whether the name of a file says that it can be read."""
    inside = path.with_suffix("") if converted.is_packed(path) else path
    return _suffix(inside) in SUFFIXES and not converted.is_packed(inside)


def stem(path: Path) -> str:
    """Return the name of a file without its suffixes: `a` for `a.csv` and `a.csv.gz`."""
    return Path(path.stem).stem if converted.is_packed(path) else path.stem


def _suffix(path: Path) -> str:
    return path.suffix.lower()


def _call(function: str, path: Path, *rest: Any) -> Any:
    """Return the result of a reader's function, in another process if its library may crash."""
    module, kind = _READERS[_suffix(path)]
    name = f"{__name__}.{module}"
    if module not in _IN_PARTS and function in ("names", "read"):
        name, rest = offered.__name__, (name, kind or "a table", *rest)
    if kind:
        return in_another_process(name, function, path, *rest, kind=kind)
    return getattr(import_module(name), function)(path, *rest)


@contextmanager
def _checked(
    path: Path, options: ReadOptions, *, but: Sequence[str] = ()
) -> Iterator[tuple[str, Path]]:
    """Yield the name of the reader's module, and the file for it, which may be a converted one.

    Files of a suffix among `but` are not converted. Errors of the system become `InputError`; all
    name `path`.
    """
    file = path
    try:
        while True:
            if not is_known(file) and _suffix(file) != ".zip":
                raise _unknown(file)
            _check(file)
            module, _ = _READERS[_suffix(file)]
            if module not in _CONVERTING or _suffix(file) in but:
                break
            file = converted.converted(file, options, partial(_call, "convert"))
        yield module, file
    except InputError as error:
        error.where = error.where.replace(str(file), str(path))
        raise
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror or error})", where=path) from error


def _check(file: Path) -> None:
    limits.regular(file)
    if file.stat().st_size == 0:
        raise InputError("is empty", where=file, expected="a recording")


def _unknown(path: Path) -> InputError:
    """Return the error, with the command that makes a readable file, or which formats to use."""
    packed = converted.is_packed(path)
    suffix = (path.with_suffix("") if packed else path).suffix or "(no suffix)"
    suffixes = [each.lower() for each in path.suffixes]
    last = ".tar" if ".tar" in suffixes else suffixes[-1] if suffixes else ""
    made = path.with_name(path.name.split(".")[0] or "data")
    ends = {"folder": "", "parquet": ".parquet", "hdf5": ".h5", "text": ".txt"}
    names = {key: shlex.quote(f"{made}{end}") for key, end in ends.items()}
    way = _WAYS.get(_SAME_WAY.get(last, last), _EXPORTED)
    return InputError(
        f"unknown file format {suffix}{' inside' if packed else ''}",
        where=path,
        expected=READABLE,
        remedy=way.format(file=shlex.quote(str(path)), **names),
    )
