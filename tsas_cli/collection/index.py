"""A persistent index of all manifests and diagnoses below folders.

It is one Parquet file in the user's cache, with its checksum in a second file; a damaged index is
rebuilt. A file is read again if its size or modification time has changed; the entries of removed
files are removed.
"""

import hashlib
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
from duckdb import DuckDBPyConnection

from tsas_cli.collection.entries import SCHEMA, FileKey, Stamp, entry_of, files_below
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import own_file, sha256_of
from tsas_cli.support.steps import Steps

SUM = ".sha256"  # suffix of the checksum's file
FORMAT = 1  # to be increased with a change of `entries.SCHEMA`


@dataclass(frozen=True)
class Index:
    """The entries of all manifests and diagnoses below folders, and problems on the way."""

    roots: Sequence[Path]
    table: pa.Table
    problems: Sequence[str]


def index_of(folders: Sequence[Path], connection: DuckDBPyConnection, step: Steps) -> Index:
    """Return the index of folders; only changed files are read; InputError: a path is no folder."""
    for folder in folders:
        if not folder.is_dir():
            raise InputError(
                "is no folder", where=folder, expected="a folder with datasets below it"
            )
    import platformdirs

    roots = [folder.resolve() for folder in folders]
    found, problems = files_below(roots)
    cache = Path(os.environ.get("TSAS_CACHE_DIR") or platformdirs.user_cache_dir("tsas"))
    named = hashlib.sha256("\0".join(map(str, roots)).encode("utf-8", "surrogateescape"))
    file = cache / "runs" / f"{named.hexdigest()[:16]}-{FORMAT}.parquet"
    try:
        intact = file.with_suffix(SUM).read_bytes() == sha256_of(file).encode()
    except OSError:
        intact = False
    before = pq.ParquetFile(file).read() if intact else SCHEMA.empty_table()
    rows = zip(
        *(before[name].to_pylist() for name in (*FileKey._fields, *Stamp._fields)), strict=True
    )
    known = [(FileKey(*row[:3]), Stamp(*row[3:])) for row in rows]
    kept = {key: row for row, (key, stamp) in enumerate(known) if found.get(key) == stamp}
    if intact and len(kept) == len(known) == len(found):
        return Index(folders, before, problems)
    table = _renewed(connection, roots, found, kept, before, step)
    problem = _stored(table, file)
    return Index(folders, table, problems if problem is None else [*problems, problem])


def _renewed(
    connection: DuckDBPyConnection,
    roots: Sequence[Path],
    found: Mapping[FileKey, Stamp],
    kept: Mapping[FileKey, int],
    before: pa.Table,
    step: Steps,
) -> pa.Table:
    """Return the kept rows and those of the other files, which are read, in the folders' order."""
    changed = [key for key in found if key not in kept]
    step.ahead(len(changed))
    entries = []
    for key in changed:
        entry = entry_of(connection, roots[key.root] / key.folder, key.file)
        entries.append(key._asdict() | found[key]._asdict() | entry)
        step()
    # take is far faster than filter; without a type, an empty list has none that it takes
    unchanged = before.take(pa.array(kept.values(), pa.int64())).cast(SCHEMA)
    table = pa.concat_tables([unchanged, pa.Table.from_pylist(entries, schema=SCHEMA)])
    return table.sort_by([(name, "ascending") for name in FileKey._fields])


def _stored(table: pa.Table, file: Path) -> str | None:
    """Write the index; return the reason if that fails, else None."""
    try:
        with own_file(file) as path:
            pq.write_table(table, path, compression="zstd")
            digest = sha256_of(path)
        with own_file(file.with_suffix(SUM)) as path:
            path.write_text(digest, encoding="utf-8")
    except (InputError, OSError) as error:
        what = error.what if isinstance(error, InputError) else error
        return (
            f"the index is rebuilt at every call, since {file} {what}; "
            "set TSAS_CACHE_DIR to a folder that you may write to"
        )
    return None
