"""One table `[columns.NAME]` of a proposed map, with its evidence and open questions."""

from dataclasses import dataclass, field
from typing import Literal

from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.recordings.guess.columns import FileColumn
from tsas_cli.recordings.ingest_map import QUESTION
from tsas_cli.recordings.readers.table import ColumnSource
from tsas_cli.support.files import Raw

Certainty = Literal["sure", "likely", "open"]


@dataclass(frozen=True)
class Proposed:
    """The proposal for one channel of a map.

    Attributes
    ----------
    name
        The canonical column.
    entry
        The keys of its table; `QUESTION` for an open value.
    certainty
        "sure" if name, unit and motion agree or exclude all else, "likely" if only one of them is
        evidence, "open" if none is or they contradict each other.
    why
        The evidence, one sentence each.
    questions
        The open questions, by key of the entry.
    alternatives
        Other possible values.
    candidates
        The columns in question, if the source is open.
    """

    name: str
    entry: Raw
    certainty: Certainty
    why: tuple[str, ...] = ()
    questions: dict[str, str] = field(default_factory=dict)
    alternatives: tuple[str, ...] = ()
    candidates: tuple[ColumnSource, ...] = ()


def with_unit(column: FileColumn, name: str) -> tuple[Raw, dict[str, str]]:
    """Return the keys that convert a column to a channel's unit, and the questions among them."""
    to = BY_NAME[name].unit
    entry: Raw = {"source": column.source}
    questions: dict[str, str] = {}
    if column.unit and not column.own_unit:
        entry["unit"] = column.unit
    if column.kind is None:
        questions["unit"] = (
            f"which unit does {column.shown} have? Neither its name nor the file states it."
        )
    elif column.kind == "label":
        questions["factor"] = f"how many {to} (or what else) is one of {column.unit}?"
        questions["factor_unit"] = f"the unit of that factor, such as {_EXAMPLE.get(to, to)}"
    elif column.kind in ("angle", "torque") and to in ("mm", "N"):
        what = "an angle to mm" if column.kind == "angle" else "a torque to N"
        questions["pulley_radius_mm"] = f"which pulley radius, in mm, converts {what}?"
    return entry | dict.fromkeys(questions, QUESTION), questions


_EXAMPLE = {
    "mm": '"mm", or "deg" with pulley_radius_mm beside it',
    "N": '"N", or "N m" with pulley_radius_mm beside it',
}
