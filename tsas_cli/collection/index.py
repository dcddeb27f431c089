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
from typing import TYPE_CHECKING

from tsas_cli.collection.entries import FileKey, Stamp, files_below
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import own_file, sha256_of
from tsas_cli.support.steps import Steps

if TYPE_CHECKING:
    import pyarrow as pa
    from duckdb import DuckDBPyConnection

SUM = ".sha256"  # suffix of the checksum's file
FORMAT = 1  # to be increased with a change of `entries.SCHEMA`


@dataclass(frozen=True)
class Index:
    """The file of the index, or its table if it could not be stored, and problems on the way."""

    roots: Sequence[Path]
    file: Path | None
    table: "pa.Table | None"
    problems: Sequence[str]


def index_of(folders: Sequence[Path], connection: "DuckDBPyConnection", step: Steps) -> Index:
    """Return the index of folders; only changed files are read; InputError: a path is no folder."""
    for folder in folders:
        if not folder.is_dir():
            raise InputError(
                "is no folder", where=folder, expected="a folder with datasets below it"
            )
    roots = [folder.resolve() for folder in folders]
    found, problems = files_below(roots)
    import platformdirs

    cache = Path(os.environ.get("TSAS_CACHE_DIR") or platformdirs.user_cache_dir("tsas"))
    named = hashlib.sha256("\0".join(map(str, roots)).encode("utf-8", "surrogateescape"))
    file = cache / "runs" / f"{named.hexdigest()[:16]}-{FORMAT}.parquet"
    try:
        intact = file.with_suffix(SUM).read_bytes() == sha256_of(file).encode()
    except OSError:
        intact = False
    known: dict[FileKey, Stamp] = {}
    if intact:
        sql = "SELECT root, folder, file, mtime_ns, size FROM read_parquet(?)"
        rows = connection.execute(sql, [str(file)]).fetchall()
        known = {FileKey(*row[:3]): Stamp(*row[3:]) for row in rows}
    changed = [key for key, stamp in found.items() if known.get(key) != stamp]
    if intact and not changed and len(known) == len(found):
        return Index(folders, file, None, problems)
    step.ahead(len(changed))
    table = _renewed(connection, roots, found, changed, file if known else None, step)
    if (problem := _stored(table, file)) is not None:
        return Index(folders, None, table, [*problems, problem])
    return Index(folders, file, None, problems)


def _renewed(
    connection: "DuckDBPyConnection",
    roots: Sequence[Path],
    found: Mapping[FileKey, Stamp],
    changed: Sequence[FileKey],
    old: Path | None,
    step: Steps,
) -> "pa.Table":
    """Return the index with the changed files read again, in the order of the folders."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    from tsas_cli.collection.entries import SCHEMA, entry_of

    entries = []
    for key in changed:
        entry = entry_of(connection, roots[key.root] / key.folder, key.file)
        entries.append(key._asdict() | found[key]._asdict() | entry)
        step()
    table = pa.Table.from_pylist(entries, schema=SCHEMA)
    if old is not None:
        before, read_again = pq.ParquetFile(old).read(), set(changed)
        keys = zip(*(before[name].to_pylist() for name in FileKey._fields), strict=True)
        unchanged = [
            row
            for row, key in enumerate(map(FileKey._make, keys))
            if key in found and key not in read_again
        ]
        # take is far faster than filter; without a type, an empty list has none that it takes
        kept = before.take(pa.array(unchanged, pa.int64()))
        table = pa.concat_tables([kept.cast(SCHEMA), table])
    return table.sort_by([(name, "ascending") for name in FileKey._fields])


def _stored(table: "pa.Table", file: Path) -> str | None:
    """Write the index; return the reason if that fails, else None."""
    import pyarrow.parquet as pq

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
