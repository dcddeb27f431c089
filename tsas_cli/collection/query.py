"""SQL conditions over all runs of an index, evaluated by DuckDB.

A query is one expression over one table. It cannot read another file, change anything or load an
extension.
"""

import json
import os
import re
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from tsas_cli.support.errors import InputError, nearest, printable

if TYPE_CHECKING:
    from duckdb import DuckDBPyConnection

    from tsas_cli.collection.index import Index

Result = TypeVar("Result")

LONGEST_S = 30.0  # of a query; one over 100,000 runs takes less than a second

# Strings, quoted names and comments are not translated.
QUOTED = r"'(?:[^']|'')*'|\"(?:[^\"]|\"\")*\"|--[^\n]*|/\*.*?\*/"
DATE = r"(?<![\w.-])(?P<date>\d{4}-\d\d(?:-\d\d(?:T\d\d:\d\d(?::\d\d)?)?)?)(?![\w.-])"
CHANNEL = r"\b(?P<channel>[A-Za-z_]\w*)(?=\s+(?:not\s+)?in\s+channels\b)"
TOKEN = re.compile(f"{QUOTED}|{DATE}|{CHANNEL}", re.DOTALL | re.IGNORECASE)
NO_CHANNELS = {"not", "null", "true", "false", "and", "or"}


@dataclass(frozen=True)
class SqlQuery:
    """A query as SQL, and the shift of the text after each translated token."""

    sql: str
    shifts: tuple[tuple[int, int], ...]


def to_sql(query: str, channels: Callable[[], Iterable[str]]) -> SqlQuery:
    """Return a query as SQL, with `2026-01` as a time and `f_out in channels` with the full name.

    InputError: no run has such a channel.

    >>> to_sql("started >= 2026-01 and f_out in channels", lambda: ["f_out_N"]).sql
    "started >= TIMESTAMP '2026-01-01' and 'f_out_N' in channels"
    """
    sql, behind, shifts = "", 0, []
    for token in TOKEN.finditer(query):
        sql += query[behind : token.start()]
        date, name, translated = token["date"], token["channel"], token[0]
        if date is not None:
            translated = f"TIMESTAMP '{date}{'-01' if len(date) == len('2026-01') else ''}'"
        elif name is not None and name.lower() not in NO_CHANNELS:
            translated = f"'{_channel(name, list(channels()))}'"
        sql, behind = sql + translated, token.end()
        shifts.append((len(sql), len(translated) - len(token[0])))
    return SqlQuery(sql + query[behind:], tuple(shifts))


def _channel(name: str, known: list[str]) -> str:
    """Return the channel of a name, in which the unit may be omitted."""
    matching = [k for k in known if name in (k, k.rpartition("_")[0])]
    if len(matching) != 1:
        raise InputError(
            f"no run has a channel {name}" if not matching else f"{name} is more than one channel",
            where="the query",
            remedy=nearest(name, known) if not matching else f"there are {', '.join(matching)}",
        )
    return matching[0]


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
PREFIX = "SELECT "  # with which DuckDB parses a condition
EXAMPLE = "total_bend_rad > 3 and f_out in channels and started >= 2026-01"


@dataclass(frozen=True)
class QueryResult:
    """Result of a query: columns, one row per run, and the numbers of runs."""

    columns: tuple[str, ...]
    rows: list[tuple[Any, ...]]
    folders: tuple[str, ...]  # of their datasets, each once
    fitting: int  # runs that match, beyond the limit too
    all_runs: int
    problems: list[str]


def connected() -> "DuckDBPyConnection":
    """Return a connection to a database in memory; InputError: DuckDB is not installed."""
    try:
        import duckdb
    except ImportError as error:
        raise InputError(
            "queries need the package duckdb", remedy="install tsas[catalogue]"
        ) from error
    return duckdb.connect(
        config={"autoinstall_known_extensions": False, "autoload_known_extensions": False}
    )


def run_query(
    connection: "DuckDBPyConnection",
    index: "Index",
    query: str,
    *,
    columns: Sequence[str],
    sort: Sequence[str],
    limit: int | None,
) -> QueryResult:
    """Return the matching runs with the requested columns, or with all.

    A minus before a name in `sort` reverses its order; missing values come last.

    InputError: the query is no condition on these columns, a column does not exist, or it takes
    too long.
    """
    import duckdb

    problems = _opened(connection, index)
    runs = connection.table("runs")
    for name in (*columns, *(key.removeprefix("-") for key in sort)):
        if name not in runs.columns:
            hint = nearest(name, runs.columns)
            raise InputError(f"there is no column {name!r}", remedy=hint)
    chosen = tuple(columns) or tuple(runs.columns)
    order = ", ".join(
        f'"{key.removeprefix("-")}" {"DESC" if key.startswith("-") else "ASC"} NULLS LAST'
        for key in (*sort, "folder", "run")
    )
    picked = ", ".join(f'"{name}"' for name in (*chosen, "folder"))
    names = runs.project("unnest(channels) AS name").distinct().order("name")
    translated = to_sql(query, lambda: [str(name) for (name,) in names.fetchall()])

    def found() -> tuple[list[tuple[Any, ...]], int, int]:
        fitting = runs.filter(translated.sql) if query.strip() else runs
        ordered = fitting.order(order)
        shown = ordered if limit is None else ordered.limit(limit)
        rows = shown.project(picked).fetchall()
        ((fit,),), ((every,),) = (r.aggregate("count(*)").fetchall() for r in (fitting, runs))
        return rows, fit, every

    try:
        rows, fit, every = _not_too_long(connection, found)
    except duckdb.OutOfMemoryException as error:
        raise MemoryError from error
    except duckdb.Error as error:
        raise _query_error(query, translated, error, runs.columns) from error
    folders = tuple(dict.fromkeys(str(row[-1]) for row in rows))
    return QueryResult(chosen, [row[:-1] for row in rows], folders, fit, every, problems)


def _not_too_long(connection: "DuckDBPyConnection", work: Callable[[], Result]) -> Result:
    """Return what work on a connection gives; on a thread, since DuckDB hears no signal."""
    with ThreadPoolExecutor(1) as pool:
        future = pool.submit(work)
        try:
            return future.result(LONGEST_S)
        except TimeoutError as error:
            raise InputError(
                f"the query takes longer than {LONGEST_S:g} s",
                expected="a condition on the columns of one run",
            ) from error
        finally:
            while wait([future], 0.1).not_done:
                connection.interrupt()


def _opened(connection: "DuckDBPyConnection", index: "Index") -> list[str]:
    """Create the table of all runs; return the problems of files.

    Afterwards the connection can read nothing else, neither files nor the index.
    """
    places = [(k, printable(root.as_posix())) for k, root in enumerate(index.roots)]
    connection.execute("CREATE TEMP TABLE places (root INTEGER, shown VARCHAR)")
    connection.executemany("INSERT INTO places VALUES (?, ?)", places)
    connection.register("index", index.table)
    connection.execute("CREATE TEMP TABLE entries AS SELECT * FROM index")
    connection.unregister("index")
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


def _query_error(
    query: str, translated: SqlQuery, error: Exception, columns: Sequence[str]
) -> InputError:
    """Return DuckDB's error with its position in the query."""
    if missing := re.search(r'Referenced column "(.+?)" not found', str(error)):
        return InputError(
            f"there is no column {missing[1]}",
            where=_position(query, query.find(missing[1])),
            remedy="name folders with --in"
            if os.path.isdir(query)  # noqa: PTH112 - Path.is_dir raises on a name that is too long
            else nearest(missing[1], sorted(columns)),
        )
    message, position = _message(str(error))
    at = -1
    if position is not None:
        in_sql = position - len(PREFIX)
        at = in_sql - sum(by for behind, by in translated.shifts if behind <= in_sql)
    return InputError(
        message, where=_position(query, at), expected=f"a condition such as: {EXAMPLE}"
    )


def _position(query: str, at: int) -> str:
    if not 0 <= at < len(query):
        return "the query"
    return f"the query, character {at + 1}, at {query[at:][:20]!r}"


def _message(text: str) -> tuple[str, int | None]:
    """Return DuckDB's message without its kind, and the position of a parser error."""
    kind, _, rest = text.partition(": ")
    if not rest.startswith("{"):
        return (rest or kind).splitlines()[0], None
    content = json.loads(rest)
    at = content.get("position") if kind == "Parser Error" else None
    return str(content["exception_message"]), None if at is None else int(at)
