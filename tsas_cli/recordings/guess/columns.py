"""One column of a file with what its name and its unit say of it."""

import re
from dataclasses import dataclass

import numpy as np

from tsas_cli.recordings.guess.kinds import QUANTITY_OF, Kind, fits, kind_of, unit_behind
from tsas_cli.recordings.guess.opening import Opened
from tsas_cli.recordings.guess.words import WEAK, Place, Quantity, Words, words_of
from tsas_cli.recordings.readers.table import Floats, Source

_BRACKETS = re.compile(r"\s*[\[(]([^\[\]()]*)[\])]\s*$")


@dataclass(frozen=True)
class Column:
    """A column of numbers.

    Attributes
    ----------
    source
        How a map names it: by name, or by number where it has none.
    values
        Shape (n,), in the file's unit; a gap is NaN.
    words
        What its name says.
    unit, kind
        The unit as the file says it, empty where it does not, and what it is of.
    own_unit
        Whether ingest finds this unit by itself.
    where
        Where the unit stands ("in its name").
    """

    source: Source
    name: str
    values: Floats
    words: Words
    unit: str
    kind: Kind | None
    own_unit: bool
    where: str

    @property
    def shown(self) -> str:
        """The column as a sentence names it."""
        return f'"{self.name}"' if self.name else f"column {self.source}"

    @property
    def quantity(self) -> Quantity | None:
        """What the column measures by its unit, else by its name; None where they disagree."""
        said = self.words.quantity
        if self.kind in (None, "label"):
            return said
        if self.disagrees:
            return None
        return "other" if said == "other" else QUANTITY_OF[self.kind]

    @property
    def place(self) -> Place | None:
        """The end that its name speaks of; "Load [N]" speaks of a force and of no end."""
        alone = self.words.quantity is None and self.words.told.get("place") in WEAK
        force = self.kind in (None, "force", "torque", "label")
        return None if alone and force else self.words.place

    @property
    def disagrees(self) -> bool:
        """Whether the name speaks of something that the unit cannot measure."""
        said, kind = self.words.quantity, self.kind
        if said in (None, "other") or kind in (None, "label", "other"):
            return False
        return not fits(said, kind)

    @property
    def reasons(self) -> list[str]:
        """What the name and the unit say, one sentence each."""
        told = self.words.told
        said = []
        speaks = {}
        if "quantity" in told:
            speaks[told["quantity"]] = _AN[self.words.quantity]
        if "place" in told and self.place:
            more = speaks.pop(told["place"], "")
            speaks[told["place"]] = (
                f"{more} at {_PLACE[self.place]}" if more else _PLACE[self.place]
            )
        said += [f'"{word}" in its name speaks of {meaning}' for word, meaning in speaks.items()]
        if self.unit:
            said.append(f"its unit, {self.unit}, stands {self.where}")
        return said

    @property
    def moves(self) -> bool:
        """Whether it takes more than one value."""
        there = self.values[np.isfinite(self.values)]
        return there.size > 1 and float(np.ptp(there)) > 0.0


_AN: dict[Quantity | None, str] = {
    "time": "a time",
    "counter": "a count of samples",
    "displacement": "a displacement",
    "angle": "an angle",
    "force": "a force",
    "torque": "a torque",
    "speed": "a speed",
    "temperature": "a temperature",
    "other": "something that no channel holds",
}
_PLACE: dict[Place, str] = {"in": "the drive", "out": "the load", "motor": "the motor"}


def columns_of(opened: Opened) -> list[Column]:
    """Return the columns of a file in their order."""
    return [
        _column(source, opened.names[source], _finite(values), opened.table.units.get(source, ""))
        for source, values in opened.table.columns.items()
    ]


def _finite(values: Floats) -> Floats:
    return np.where(np.isfinite(values), values, np.nan)


def _column(source: Source, name: str, values: Floats, told: str) -> Column:
    """Return a column; `told` is the unit that ingest finds by itself, if any."""
    bracket = _BRACKETS.search(name)
    inside = bracket[1].strip() if bracket else ""
    stem, behind = unit_behind(name[: bracket.start()] if bracket else name)
    where = "in its name" if told == inside else "in the file"
    for unit, own, place in (
        (told, True, where),
        (told.strip(" ?"), False, where),
        (inside.strip(" ?"), False, "in its name"),
        (behind, False, "at the end of its name"),
    ):
        kind = kind_of(unit) if unit else None
        if kind is not None:
            return Column(source, name, values, words_of(stem), unit, kind, own, place)
    return Column(source, name, values, words_of(name), "", None, False, "")
