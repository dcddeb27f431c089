"""One column of a file, with the meaning of its name and its unit."""

import re
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.recordings.guess.opening import Opened
from tsas_cli.recordings.guess.words import (
    WEAK,
    End,
    NamedQuantity,
    UnitKind,
    Words,
    fits,
    kind_of,
    unit_behind,
    words_of,
)
from tsas_cli.recordings.ingest_map import QUESTION
from tsas_cli.recordings.readers.table import ColumnSource
from tsas_cli.support.arrays import Floats
from tsas_cli.support.files import Raw

Certainty = Literal["sure", "likely", "open"]
_EXAMPLE = {
    "mm": '"mm", or "deg" with pulley_radius_mm beside it',
    "N": '"N", or "N m" with pulley_radius_mm beside it',
}
_BRACKETS = re.compile(r"\s*[\[(]([^\[\]()]*)[\])]\s*$")


@dataclass(frozen=True)
class Proposed:
    """The proposal for one channel of a map.

    It is "sure" if name, unit and motion agree or exclude all else, "likely" if only one of them is
    evidence, "open" if none is or they contradict each other.
    """

    name: str  # of the canonical column
    entry: Raw  # the keys of its table; `QUESTION` for an open value
    certainty: Certainty
    why: tuple[str, ...] = ()  # the evidence, one sentence each
    questions: dict[str, str] = field(default_factory=dict)  # the open ones, by key of the entry
    alternatives: tuple[str, ...] = ()  # other possible values
    candidates: tuple[ColumnSource, ...] = ()  # the columns in question, if the source is open


@dataclass(frozen=True)
class FileColumn:
    """A column of numbers, with what its name and its unit mean."""

    source: ColumnSource  # in a map: the name, or the number of a column without a name
    name: str
    values: Floats  # shape (n,), in the file's unit; a gap is NaN
    words: Words
    unit: str  # stated by the file, empty without one
    kind: UnitKind | None
    own_unit: bool  # whether ingest finds this unit in the file
    where: str  # the unit is stated: "in its name"

    @property
    def shown(self) -> str:
        """The column's name in sentences."""
        return f'"{self.name}"' if self.name else f"column {self.source}"

    @property
    def quantity(self) -> NamedQuantity | None:
        """The measured quantity by the unit, else by the name; None if they disagree."""
        named = self.words.quantity
        if self.kind is None or self.kind == "label":
            return named
        if self.disagrees:
            return None
        return "other" if named == "other" else self.kind

    @property
    def end(self) -> End | None:
        """The end in its name; "Load [N]" names a force and no end."""
        alone = self.words.quantity is None and self.words.matched.get("end") in WEAK
        force = self.kind in (None, "force", "torque", "label")
        return None if alone and force else self.words.end

    @property
    def disagrees(self) -> bool:
        """Whether the name states a quantity that does not have this unit."""
        named, kind = self.words.quantity, self.kind
        if named in (None, "other") or kind in (None, "label", "other"):
            return False
        return not fits(named, kind)

    @property
    def reasons(self) -> list[str]:
        """The evidence of the name and the unit, one sentence each."""
        matched, named = self.words.matched, str(self.words.quantity)
        meanings = {}
        if "quantity" in matched:
            meanings[matched["quantity"]] = _QUANTITY.get(named, f"a {named}")
        if "end" in matched and self.end:
            more = meanings.pop(matched["end"], "")
            meanings[matched["end"]] = f"{more} at {_END[self.end]}" if more else _END[self.end]
        reasons = [f'"{word}" in its name means {meaning}' for word, meaning in meanings.items()]
        if self.unit:
            reasons.append(f"its unit, {self.unit}, is stated {self.where}")
        return reasons

    @property
    def moves(self) -> bool:
        """Whether it has more than one value."""
        finite = self.values[np.isfinite(self.values)]
        return finite.size > 1 and float(np.ptp(finite)) > 0.0


_QUANTITY = {
    "counter": "a count of samples",
    "angle": "an angle",
    "other": "no quantity of a channel",
}
_END: dict[End, str] = {"in": "the drive", "out": "the load", "motor": "the motor"}


def columns_of(opened: Opened) -> list[FileColumn]:
    """Return the columns of a file, in order."""
    return [
        _column(source, opened.names[source], values, opened.table.units.get(source, ""))
        for source, values in opened.table.columns.items()
    ]


def with_trusted_names(columns: list[FileColumn]) -> tuple[list[FileColumn], str]:
    """Return the columns, without the meaning of any name if one name and its unit disagree.

    The names may then be those of other columns: only units and motion are used, and the sentence
    states it.
    """
    disagreeing = [c.shown for c in columns if c.disagrees]
    if not disagreeing:
        return columns, ""
    sentence = f"Name and unit of {', '.join(disagreeing)} disagree: no name is used."
    return [replace(c, words=Words(None, None, is_reference=False)) for c in columns], sentence


def _column(source: ColumnSource, name: str, values: Floats, declared: str) -> FileColumn:
    """Return a column; `declared` is the unit that ingest finds in the file, if any."""
    values = np.where(np.isfinite(values), values, np.nan)
    bracket = _BRACKETS.search(name)
    inside = bracket[1].strip() if bracket else ""
    stem, behind = unit_behind(name[: bracket.start()] if bracket else name)
    where = "in its name" if declared == inside else "in the file"
    for unit, own, position in (
        (declared, True, where),
        (declared.strip(" ?"), False, where),
        (inside.strip(" ?"), False, "in its name"),
        (behind, False, "at the end of its name"),
    ):
        kind = kind_of(unit) if unit else None
        if kind is not None:
            return FileColumn(source, name, values, words_of(stem), unit, kind, own, position)
    return FileColumn(source, name, values, words_of(name), "", None, False, "")


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
            + (" An angle needs pulley_radius_mm beside it." if to == "mm" else "")
        )
    elif column.kind == "label":
        questions["factor"] = f"how many {to} (or what else) is one of {column.unit}?"
        questions["factor_unit"] = f"the unit of that factor, such as {_EXAMPLE.get(to, to)}"
    elif column.kind in ("angle", "torque") and to in ("mm", "N"):
        what = "an angle to mm" if column.kind == "angle" else "a torque to N"
        questions["pulley_radius_mm"] = f"which pulley radius, in mm, converts {what}?"
    return entry | dict.fromkeys(questions, QUESTION), questions
