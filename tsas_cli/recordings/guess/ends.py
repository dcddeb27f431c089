"""Which columns are at the drive and which at the load.

Every way to give the displacements and the tensions to the four channels is held against what the
names say and against which channel goes ahead of which. A channel is settled when all ways that
are left give it the same column.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations

from tsas_cli.recordings.guess.columns import Column
from tsas_cli.recordings.guess.looks import goes_ahead

_X, _F = ("x_in_mm", "x_out_mm"), ("f_in_N", "f_out_N")
# Nearer to the drive first.
_ORDER = (
    ("f_in_N", "x_in_mm"),
    ("f_in_N", "x_out_mm"),
    ("f_in_N", "f_out_N"),
    ("x_in_mm", "x_out_mm"),
)
_MOST = 5  # columns of one kind whose motion is compared
Way = Mapping[str, Column | None]


@dataclass(frozen=True)
class Ends:
    """The channels that are settled, and for the others the columns and the reason.

    `ahead` holds the pairs of columns whose order the motion tells, the nearer to the drive first.
    """

    settled: dict[str, Column]
    asked: dict[str, tuple[Column, ...]]
    reason: str
    ahead: tuple[tuple[Column, Column], ...]


def settle(displacements: Sequence[Column], tensions: Sequence[Column]) -> Ends:
    """Give displacements and tensions to their ends, as far as names and motion tell."""
    if max(len(displacements), len(tensions)) > _MOST:
        displacements, tensions = _with_place(displacements), _with_place(tensions)
    if max(len(displacements), len(tensions)) > _MOST:
        reason = "there are too many columns of one kind to tell them by their motion"
        return Ends({}, _every(displacements, tensions), reason, ())
    motion = _Motion()
    ways = list(_ways(displacements, tensions))
    by_name = [way for way in ways if _as_named(way)]
    left = [way for way in by_name if _as_moved(way, motion)]
    ahead = motion.told((*displacements, *tensions))
    if not by_name:
        return _apart(displacements, tensions, ahead)
    if not left:
        reason = "the names give the ends one way, the motion another"
        return Ends({}, _every(displacements, tensions), reason, ahead)
    settled: dict[str, Column] = {}
    asked = {}
    for name in (*_X, *_F):
        found = {id(way[name]): way[name] for way in left}
        (first, *more) = found.values()
        if more:
            asked[name] = tuple(c for c in found.values() if c is not None)
        elif first is not None:
            settled[name] = first
    reason = "neither the names nor the motion tell the ends apart"
    return Ends(settled, asked, reason, ahead)


def _with_place(columns: Sequence[Column]) -> list[Column]:
    """Return the columns whose names speak of an end, all where none does."""
    return [c for c in columns if c.place is not None] or list(columns)


def _apart(
    displacements: Sequence[Column],
    tensions: Sequence[Column],
    ahead: tuple[tuple[Column, Column], ...],
) -> Ends:
    """Return what is asked where names fit no way: one kind, if the other is named well."""
    reason = "the names do not give one column to each end"
    asked = _every(displacements, tensions)
    if displacements and tensions:
        x, f = settle(displacements, ()), settle((), tensions)
        if bool(x.settled) != bool(f.settled):
            good, bad = (x, f) if x.settled else (f, x)
            return Ends(good.settled, {**good.asked, **bad.asked}, reason, ahead)
    return Ends({}, asked, reason, ahead)


def _every(
    displacements: Sequence[Column], tensions: Sequence[Column]
) -> dict[str, tuple[Column, ...]]:
    asked = dict.fromkeys(_X, tuple(displacements)) | dict.fromkeys(_F, tuple(tensions))
    return {name: columns for name, columns in asked.items() if columns}


class _Motion:
    """Which of two columns goes ahead, found once for each pair."""

    def __init__(self) -> None:
        self._found: dict[tuple[int, int], int] = {}

    def __call__(self, a: Column, b: Column) -> int:
        if (id(a), id(b)) not in self._found:
            order = goes_ahead(a.values, b.values)
            self._found |= {(id(a), id(b)): order, (id(b), id(a)): -order}
        return self._found[id(a), id(b)]

    def told(self, columns: Sequence[Column]) -> tuple[tuple[Column, Column], ...]:
        return tuple((a, b) for a, b in permutations(columns, 2) if self(a, b) == 1)


def _ways(displacements: Sequence[Column], tensions: Sequence[Column]) -> Iterator[Way]:
    for x_in, x_out in _pairs(displacements):
        for f_in, f_out in _pairs(tensions):
            yield dict(zip((*_X, *_F), (x_in, x_out, f_in, f_out), strict=True))


def _pairs(columns: Sequence[Column]) -> list[tuple[Column | None, Column | None]]:
    """Return every way to give columns to two ends; one that is alone may be at either."""
    if not columns:
        return [(None, None)]
    if len(columns) == 1:
        return [(columns[0], None), (None, columns[0])]
    return list(permutations(columns, 2))


def _as_named(way: Way) -> bool:
    ends = {"x_in_mm": "out", "f_in_N": "out", "x_out_mm": "in", "f_out_N": "in"}
    return not any(
        column is not None
        and (column.place == wrong or (column.place == "motor" and wrong == "in"))
        for (name, wrong) in ends.items()
        for column in [way[name]]
    )


def _as_moved(way: Way, motion: _Motion) -> bool:
    def order(near: str, far: str) -> int:
        a, b = way[near], way[far]
        return 0 if a is None or b is None else motion(a, b)

    if any(order(*pair) == -1 for pair in _ORDER):
        return False
    # A load with friction of its own may put f_out ahead of x_in, which x_out then shows.
    return order("x_in_mm", "x_out_mm") == 1 or order("x_in_mm", "f_out_N") != -1
