"""A condition in SQL over all runs of an index, answered by DuckDB.

The query is one expression and sees one table. Nothing that it says can read another file, change
anything or load an extension.
"""

import json
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tsas_cli.collection.index import Index
from tsas_cli.collection.words import Spelt, spelt_out
from tsas_cli.support.errors import InputError, nearest, printable

if TYPE_CHECKING:
    from duckdb import DuckDBPyConnection, DuckDBPyRelation

RUNS = """
CREATE TEMP TABLE runs AS
WITH each_run AS (
    SELECT root, folder, sha256, dataset, kind, rig, unnest(runs) AS r
    FROM entries WHERE runs IS NOT NULL
), diagnosed AS (
    SELECT manifest_sha256, chosen, verdict, causes, make_timestamp(mtime_ns // 1000) AS diagnosed
    FROM entries WHERE verdict IS NOT NULL
)
SELECT
    CASE WHEN e.folder = '' THEN p.shown WHEN p.shown = '.' THEN e.folder
         WHEN p.shown = '/' THEN '/' || e.folder ELSE p.shown || '/' || e.folder END AS folder,
    r.run, dataset, kind, r.* EXCLUDE (run, tags), rig.*, r.tags, verdict, causes,
    diagnosed
FROM each_run AS e JOIN places AS p USING (root) LEFT JOIN diagnosed AS d
ON d.manifest_sha256 = e.sha256 AND (chosen IS NULL OR list_contains(chosen, r.run))
QUALIFY 1 = row_number() OVER (
    PARTITION BY root, e.folder, r.run ORDER BY diagnosed DESC NULLS LAST
)
"""
BEFORE = "SELECT "  # what DuckDB puts before a condition that it parses
EXAMPLE = "total_bend_rad > 3 and f_out in channels and started >= 2026-01"


@dataclass(frozen=True)
class Answer:
    """The runs that a query names: their columns, a row of values each, and how many there are."""

    columns: tuple[str, ...]
    rows: list[tuple[Any, ...]]
    folders: tuple[str, ...]  # of their datasets, each once
    fitting: int
    all_runs: int
    problems: list[str]


def connected() -> "DuckDBPyConnection":
    """Return a database in memory.

    Raises
    ------
    InputError
        DuckDB is not installed.
    """
    try:
        import duckdb
    except ImportError as error:
        raise InputError(
            "queries need the package duckdb", remedy="install tsas[catalogue]"
        ) from error
    return duckdb.connect(
        config={"autoinstall_known_extensions": False, "autoload_known_extensions": False}
    )


def asked(
    connection: "DuckDBPyConnection",
    index: Index,
    query: str,
    *,
    columns: Sequence[str],
    sort: Sequence[str],
    limit: int | None,
) -> Answer:
    """Return the runs that fit, with the columns that were asked for, or all where none were.

    A name in `sort` with a minus before it sorts the other way round; what is missing comes last.

    Raises
    ------
    InputError
        The query is no condition on these columns, or there is no such column.
    """
    import duckdb

    problems = _opened(connection, index)
    runs = connection.table("runs")
    chosen = tuple(_known(name, runs.columns) for name in columns) or tuple(runs.columns)
    order = ", ".join(_ordered(name, runs.columns) for name in (*sort, "folder", "run"))
    picked = ", ".join(f'"{name}"' for name in (*chosen, "folder"))
    spelt = spelt_out(query, lambda: _channels(runs))
    try:
        fitting = runs.filter(spelt.sql) if query.strip() else runs
        ordered = fitting.order(order)
        shown = ordered if limit is None else ordered.limit(limit)
        rows = shown.project(picked).fetchall()
        ((fit,),), ((every,),) = (r.aggregate("count(*)").fetchall() for r in (fitting, runs))
    except duckdb.Error as error:
        raise _wrong(query, spelt, error, runs.columns) from error
    folders = tuple(dict.fromkeys(str(row[-1]) for row in rows))
    return Answer(chosen, [row[:-1] for row in rows], folders, fit, every, problems)


def _opened(connection: "DuckDBPyConnection", index: Index) -> list[str]:
    """Make the table of all runs; return what was wrong with files.

    From then on there is nothing else to read: no file, and not the index.
    """
    places = [(k, printable(root.as_posix())) for k, root in enumerate(index.roots)]
    connection.execute("CREATE TEMP TABLE places (root INTEGER, shown VARCHAR)")
    connection.executemany("INSERT INTO places VALUES (?, ?)", places)
    if index.kept is None:
        connection.register("held", index.held)
        connection.execute("CREATE TEMP TABLE entries AS SELECT * FROM held")
        connection.unregister("held")
    else:
        read = "CREATE TEMP TABLE entries AS SELECT * FROM read_parquet(?)"
        connection.execute(read, [str(index.kept)])
    connection.execute(RUNS)
    problems = connection.execute(
        "SELECT folder, file, unnest(problems) FROM entries ORDER BY ALL"
    ).fetchall()
    connection.execute(
        "DROP TABLE entries; DROP TABLE places; SET enable_external_access = false; "
        "SET errors_as_json = true; SET lock_configuration = true"
    )
    in_files = [f"{Path(folder) / file}: {problem}" for folder, file, problem in problems]
    return [*index.problems, *in_files]


def _channels(runs: "DuckDBPyRelation") -> list[str]:
    rows = runs.project("unnest(channels) AS name").distinct().order("name").fetchall()
    return [str(name) for (name,) in rows]


def _known(name: str, columns: Sequence[str]) -> str:
    if name not in columns:
        raise InputError(f"there is no column {name!r}", remedy=nearest(name, columns))
    return name


def _ordered(name: str, columns: Sequence[str]) -> str:
    down = name.startswith("-")
    return f'"{_known(name[down:], columns)}" {"DESC" if down else "ASC"} NULLS LAST'


def _wrong(query: str, spelt: Spelt, error: Exception, columns: Sequence[str]) -> InputError:
    """Return DuckDB's complaint in a line that points at the place in the query."""
    if missing := re.search(r'Referenced column "(.+?)" not found', str(error)):
        return InputError(
            f"there is no column {missing[1]}",
            where=_place(query, query.find(missing[1])),
            remedy="name folders with --in"
            if os.path.isdir(query)  # noqa: PTH112 - Path.is_dir raises on a name that is too long
            else nearest(missing[1], sorted(columns)),
        )
    said, position = _said(str(error))
    at = -1 if position is None else spelt.place(position - len(BEFORE))
    return InputError(said, where=_place(query, at), expected=f"a condition such as: {EXAMPLE}")


def _place(query: str, at: int) -> str:
    if not 0 <= at < len(query):
        return "the query"
    return f"the query, character {at + 1}, at {query[at:][:20]!r}"


def _said(text: str) -> tuple[str, int | None]:
    """Return DuckDB's sentence without its kind, and the place that it names while it parses."""
    kind, _, rest = text.partition(": ")
    if not rest.startswith("{"):
        return (rest or kind).splitlines()[0], None
    told = json.loads(rest)
    at = told.get("position") if kind == "Parser Error" else None
    return str(told["exception_message"]), None if at is None else int(at)
