"""Abbreviations in queries that SQL does not have: dates, and channels."""

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from tsas_cli.support.errors import InputError, nearest

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

    def position_in_query(self, position: int) -> int:
        """Return the position in the query of a position in the SQL."""
        return position - sum(by for at, by in self.shifts if at <= position)


def to_sql(query: str, channels: Callable[[], Iterable[str]]) -> SqlQuery:
    """Return a query as SQL, with `2026-01` as a time and `f_out in channels` with the full name.

    Raises
    ------
    InputError
        No run has such a channel.

    Examples
    --------
    >>> to_sql("started >= 2026-01 and f_out in channels", lambda: ["f_out_N"]).sql
    "started >= TIMESTAMP '2026-01-01' and 'f_out_N' in channels"
    """
    sql, behind, shifts = "", 0, []
    for token in TOKEN.finditer(query):
        sql += query[behind : token.start()]
        translated = _translated(token, channels)
        sql, behind = sql + translated, token.end()
        shifts.append((len(sql), len(translated) - len(token[0])))
    return SqlQuery(sql + query[behind:], tuple(shifts))


def _translated(token: re.Match[str], channels: Callable[[], Iterable[str]]) -> str:
    if (date := token["date"]) is not None:
        return f"TIMESTAMP '{date}-01'" if len(date) == len("2026-01") else f"TIMESTAMP '{date}'"
    name = token["channel"]
    if name is None or name.lower() in NO_CHANNELS:
        return token[0]
    return f"'{_channel(name, list(channels()))}'"


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
