"""One table `[columns.NAME]` of a proposed map, with why, how sure, and what has to be asked."""

from dataclasses import dataclass, field
from typing import Literal

from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.recordings.guess.columns import Column
from tsas_cli.recordings.ingest_map import QUESTION
from tsas_cli.recordings.readers.table import Source
from tsas_cli.support.files import Raw

Sureness = Literal["sure", "likely", "open"]


@dataclass(frozen=True)
class Proposed:
    """What a map says of one channel.

    Attributes
    ----------
    name
        The canonical column.
    entry
        The keys of its table; `QUESTION` where a person has to answer.
    sure
        "sure" where name, unit and motion agree or leave nothing else, "likely" where only one of
        them tells, "open" where none does or they contradict each other.
    why
        The reasons, one sentence each.
    questions
        What to answer, by key of the entry.
    alternatives
        What else it could be.
    candidates
        The columns that it may be, where that is the question.
    """

    name: str
    entry: Raw
    sure: Sureness
    why: tuple[str, ...] = ()
    questions: dict[str, str] = field(default_factory=dict)
    alternatives: tuple[str, ...] = ()
    candidates: tuple[Source, ...] = ()


def with_unit(column: Column, name: str) -> tuple[Raw, dict[str, str]]:
    """Return the keys that take a column to a channel's unit, and the questions among them."""
    to = BY_NAME[name].unit
    entry: Raw = {"source": column.source}
    asked: dict[str, str] = {}
    if column.unit and not column.own_unit:
        entry["unit"] = column.unit
    if column.kind is None:
        asked["unit"] = f"which unit is {column.shown} in? Neither its name nor the file says it."
    elif column.kind == "label":
        asked["factor"] = f"how many {to} (or what else) is one of {column.unit}?"
        asked["factor_unit"] = f"the unit of that factor, such as {_EXAMPLE.get(to, to)}"
    elif column.kind in ("angle", "torque") and to in ("mm", "N"):
        what = "an angle becomes mm" if column.kind == "angle" else "a torque becomes N"
        asked["pulley_radius_mm"] = f"{what} on a radius: which is the pulley's, in mm?"
    return entry | dict.fromkeys(asked, QUESTION), asked


_EXAMPLE = {
    "mm": '"mm", or "deg" with pulley_radius_mm beside it',
    "N": '"N", or "N m" with pulley_radius_mm beside it',
}
