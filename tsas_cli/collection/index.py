"""An index of all manifests and diagnoses below folders, kept and brought up to date.

It is one Parquet file in the user's cache, with its checksum in a file beside it: what is damaged
there is made again. A file is read again when its size or the time of its
last change is another; what is gone from the folders goes from the index.
"""

import hashlib
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from tsas_cli.collection.found import Place, Stamp, files_below
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import own_file, sha256_of
from tsas_cli.support.steps import Steps

if TYPE_CHECKING:
    import pyarrow as pa
    from duckdb import DuckDBPyConnection

FORMAT = 1  # another number where the columns of `entries.SCHEMA` change


@dataclass(frozen=True)
class Index:
    """Where the index is, or itself where it could not be kept, and what was wrong on the way."""

    roots: Sequence[Path]
    kept: Path | None
    held: "pa.Table | None"
    problems: Sequence[str]


def index_of(folders: Sequence[Path], connection: "DuckDBPyConnection", step: Steps) -> Index:
    """Look for what has changed below some folders, and read that alone.

    Raises
    ------
    InputError
        One of them is no folder.
    """
    for folder in folders:
        if not folder.is_dir():
            raise InputError(
                "is no folder", where=folder, expected="a folder with datasets below it"
            )
    roots = [folder.resolve() for folder in folders]
    found, problems = files_below(roots)
    file = _file_for(roots)
    whole = _whole(file)
    known = _known(connection, file) if whole else {}
    changed = [place for place, stamp in found.items() if known.get(place) != stamp]
    if whole and not changed and len(known) == len(found):
        return Index(folders, file, None, problems)
    step.ahead(len(changed))
    table = _renewed(connection, roots, found, changed, file if known else None, step)
    if (problem := _kept(table, file)) is not None:
        return Index(folders, None, table, [*problems, problem])
    return Index(folders, file, None, problems)


def _file_for(roots: Sequence[Path]) -> Path:
    import platformdirs

    cache = Path(os.environ.get("TSAS_CACHE_DIR") or platformdirs.user_cache_dir("tsas"))
    named = hashlib.sha256("\0".join(map(str, roots)).encode("utf-8", "surrogateescape"))
    return cache / "runs" / f"{named.hexdigest()[:16]}-{FORMAT}.parquet"


def _sum_beside(file: Path) -> Path:
    return file.with_suffix(".sha256")


def _whole(file: Path) -> bool:
    """Say whether the index is there as it was written."""
    try:
        return _sum_beside(file).read_bytes() == sha256_of(file).encode()
    except OSError:
        return False


def _known(connection: "DuckDBPyConnection", file: Path) -> dict[Place, Stamp]:
    """Return what the index holds."""
    sql = "SELECT root, folder, file, mtime_ns, size FROM read_parquet(?)"
    rows = connection.execute(sql, [str(file)]).fetchall()
    return {Place(*row[:3]): Stamp(*row[3:]) for row in rows}


def _renewed(
    connection: "DuckDBPyConnection",
    roots: Sequence[Path],
    found: Mapping[Place, Stamp],
    changed: Sequence[Place],
    old: Path | None,
    step: Steps,
) -> "pa.Table":
    """Return the index with what has changed read again, in the order of the folders."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    from tsas_cli.collection.entries import SCHEMA, entry_of

    entries = []
    for place in changed:
        entry = entry_of(connection, roots[place.root] / place.folder, place.file)
        entries.append(place._asdict() | found[place]._asdict() | entry)
        step()
    table = pa.Table.from_pylist(entries, schema=SCHEMA)
    if old is not None:
        before, read_again = pq.ParquetFile(old).read(), set(changed)
        keys = zip(*(before[name].to_pylist() for name in Place._fields), strict=True)
        stays = [
            row
            for row, key in enumerate(map(Place._make, keys))
            if key in found and key not in read_again
        ]
        table = pa.concat_tables([before.take(stays).cast(SCHEMA), table])  # filter is far slower
    return table.sort_by([(name, "ascending") for name in Place._fields])


def _kept(table: "pa.Table", file: Path) -> str | None:
    """Write the index; return why that could not be, or None where it was."""
    import pyarrow.parquet as pq

    try:
        with own_file(file) as path:
            pq.write_table(table, path, compression="zstd")
            digest = sha256_of(path)
        with own_file(_sum_beside(file)) as path:
            path.write_text(digest, encoding="utf-8")
    except (InputError, OSError) as error:
        return f"the index is made again at every call, since it cannot be kept: {error}"
    return None
