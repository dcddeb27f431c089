"""The file of a run, from a folder or an address, after its checksum is verified."""

from pathlib import Path
from typing import TypeAlias

import pyarrow as pa

from tsas_cli.recordings.fetched import fetched
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.storage import Address, Location, check_inside
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import sha256_of

ParquetSource: TypeAlias = Path | pa.NativeFile


def checked_file(folder: Location, run: Run) -> ParquetSource:
    """Return the source that Parquet is read from, after its checksum matches the manifest.

    Raises
    ------
    InputError
        The file is missing, leaves its folder or has another checksum, or cannot be fetched.
    """
    if isinstance(folder, Address):
        path = folder / run.file
        try:
            content = fetched(path, run.sha256.lower())
        except FileNotFoundError as error:
            raise _missing(path, run) from error
        if content is None:
            raise changed(path, run)
        return pa.BufferReader(content)
    file = local_file(folder, run)
    try:
        digest = sha256_of(file)
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", where=file) from error
    if digest != run.sha256.lower():
        raise changed(file, run)
    return file


def local_file(folder: Path, run: Run) -> Path:
    """Return a run's file in a local folder.

    Raises
    ------
    InputError
        The file is missing, or a link leads out of the folder.
    """
    path = folder / run.file
    if not path.is_file():
        raise _missing(path, run)
    check_inside(path, folder)
    return path


def _missing(path: Location, run: Run) -> InputError:
    return InputError(
        "the run's file is missing", where=path, expected=f"the Parquet file of run {run.id}"
    )


def changed(path: Location, run: Run) -> InputError:
    """Return the error for a file whose checksum differs from the manifest."""
    return InputError(
        "the checksum differs from the manifest's",
        where=path,
        expected=run.sha256.lower(),
        remedy="the file has changed since ingest: restore it or ingest again",
    )
