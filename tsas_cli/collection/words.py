"""What a query may say in fewer words than SQL asks for: dates, and channels."""

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from tsas_cli.support.errors import InputError, nearest

# Texts, quoted names and comments stay as they are.
QUOTED = r"'(?:[^']|'')*'|\"(?:[^\"]|\"\")*\"|--[^\n]*|/\*.*?\*/"
DATE = r"(?<![\w.-])(?P<date>\d{4}-\d\d(?:-\d\d(?:T\d\d:\d\d(?::\d\d)?)?)?)(?![\w.-])"
CHANNEL = r"\b(?P<channel>[A-Za-z_]\w*)(?=\s+(?:not\s+)?in\s+channels\b)"
TOKEN = re.compile(f"{QUOTED}|{DATE}|{CHANNEL}", re.DOTALL | re.IGNORECASE)
NO_CHANNELS = {"not", "null", "true", "false", "and", "or"}


@dataclass(frozen=True)
class Spelt:
    """A query as SQL, and by how much what follows each place in it has moved."""

    sql: str
    moved: tuple[tuple[int, int], ...]

    def place(self, position: int) -> int:
        """Return where in the query that is which stands at a position of the SQL."""
        return position - sum(by for at, by in self.moved if at <= position)


def spelt_out(query: str, channels: Callable[[], Iterable[str]]) -> Spelt:
    """Return a query as SQL: `2026-01` as a time, `f_out in channels` with the channel's name.

    Raises
    ------
    InputError
        No run has such a channel.

    Examples
    --------
    >>> spelt_out("started >= 2026-01 and f_out in channels", lambda: ["f_out_N"]).sql
    "started >= TIMESTAMP '2026-01-01' and 'f_out_N' in channels"
    """
    sql, behind, moved = "", 0, []
    for token in TOKEN.finditer(query):
        sql += query[behind : token.start()]
        spelt = _spelt(token, channels)
        sql, behind = sql + spelt, token.end()
        moved.append((len(sql), len(spelt) - len(token[0])))
    return Spelt(sql + query[behind:], tuple(moved))


def _spelt(token: re.Match[str], channels: Callable[[], Iterable[str]]) -> str:
    if (date := token["date"]) is not None:
        return f"TIMESTAMP '{date}-01'" if len(date) == len("2026-01") else f"TIMESTAMP '{date}'"
    name = token["channel"]
    if name is None or name.lower() in NO_CHANNELS:
        return token[0]
    return f"'{_channel(name, list(channels()))}'"


def _channel(name: str, known: list[str]) -> str:
    """Return the channel that is meant, whose unit may be left out."""
    meant = [k for k in known if name in (k, k.rpartition("_")[0])]
    if len(meant) != 1:
        raise InputError(
            f"no run has a channel {name}" if not meant else f"{name} is more than one channel",
            where="the query",
            remedy=nearest(name, known) if not meant else f"there are {', '.join(meant)}",
        )
    return meant[0]
