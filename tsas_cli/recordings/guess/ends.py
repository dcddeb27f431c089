"""Assignment of columns to the proximal and the distal end.

Every assignment of the displacements and the tensions to the four channels is compared with the
names and with the order in which the channels move. A channel is assigned if all consistent
assignments agree on its column.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, permutations, product

from tsas_cli.recordings.guess.columns import FileColumn
from tsas_cli.recordings.guess.looks import leads

_X, _F = ("x_in_mm", "x_out_mm"), ("f_in_N", "f_out_N")
# Pairs of channels, the one nearer to the drive first.
_ORDER = (
    ("f_in_N", "x_in_mm"),
    ("f_in_N", "x_out_mm"),
    ("f_in_N", "f_out_N"),
    ("x_in_mm", "x_out_mm"),
)
LENGTHS, FORCES = ("displacement", "angle"), ("force", "torque")
_MOST = 5  # columns of one kind whose motion is compared
_Candidate = Mapping[str, FileColumn | None]
_Order = Mapping[tuple[int, int], int]  # of two columns by id: 1 if the first moves first, or −1, 0


@dataclass(frozen=True)
class Assignment:
    """The assigned channels; for the open ones, their candidate columns and the reason.

    `ahead` holds the pairs of columns whose order the motion shows, the one nearer to the drive
    first.
    """

    assigned: dict[str, FileColumn]
    open: dict[str, tuple[FileColumn, ...]]
    reason: str
    ahead: tuple[tuple[FileColumn, FileColumn], ...]


def assign(displacements: Sequence[FileColumn], tensions: Sequence[FileColumn]) -> Assignment:
    """Return displacements and tensions by end, as far as names and motion determine it."""
    if max(len(displacements), len(tensions)) > _MOST:
        displacements, tensions = _with_end(displacements), _with_end(tensions)
    if max(len(displacements), len(tensions)) > _MOST:
        reason = "there are too many columns of one kind to order them by their motion"
        return Assignment({}, _every(displacements, tensions), reason, ())
    columns = (*displacements, *tensions)
    motion: dict[tuple[int, int], int] = {}
    for a, b in combinations(columns, 2):
        order = leads(a.values, b.values)
        motion |= {(id(a), id(b)): order, (id(b), id(a)): -order}
    candidates = [
        dict(zip((*_X, *_F), (*x, *f), strict=True))
        for x, f in product(_pairs(displacements), _pairs(tensions))
    ]
    by_name = [one for one in candidates if _fits_names(one, columns)]
    consistent = [one for one in by_name if _fits_motion(one, motion)]
    ahead = tuple((a, b) for a, b in permutations(columns, 2) if motion[id(a), id(b)] == 1)
    if not consistent:
        return _inconsistent(displacements, tensions, ahead, by_names=not by_name)
    assigned: dict[str, FileColumn] = {}
    undecided = {}
    for name in (*_X, *_F):
        found = {id(one[name]): one[name] for one in consistent}
        (first, *more) = found.values()
        if more:
            undecided[name] = tuple(c for c in found.values() if c is not None)
        elif first is not None:
            assigned[name] = first
    reason = "neither the names nor the motion distinguish the ends"
    return Assignment(assigned, undecided, reason, ahead)


def _with_end(columns: Sequence[FileColumn]) -> list[FileColumn]:
    """Return the columns whose names state an end; all if none does."""
    return [c for c in columns if c.end is not None] or list(columns)


def _inconsistent(
    displacements: Sequence[FileColumn],
    tensions: Sequence[FileColumn],
    ahead: tuple[tuple[FileColumn, FileColumn], ...],
    *,
    by_names: bool,
) -> Assignment:
    """Return the assignment if no candidate is consistent with the names, or with the motion too.

    One kind may still be well named; or, if units distinguish the kinds, be consistent by itself.
    """
    reason = (
        "the names do not assign one column to each end"
        if by_names
        else "names and motion disagree on the ends"
    )
    units_known = all(c.kind not in (None, "label") for c in (*displacements, *tensions))
    if displacements and tensions and (by_names or units_known):
        x, f = assign(displacements, ()), assign((), tensions)
        for good, bad in ((x, f), (f, x)):
            if not bad.assigned and (good.assigned if by_names else good.ahead and not good.open):
                return Assignment(good.assigned, {**good.open, **bad.open}, reason, ahead)
    return Assignment({}, _every(displacements, tensions), reason, ahead)


def _every(
    displacements: Sequence[FileColumn], tensions: Sequence[FileColumn]
) -> dict[str, tuple[FileColumn, ...]]:
    channels = dict.fromkeys(_X, tuple(displacements)) | dict.fromkeys(_F, tuple(tensions))
    return {name: columns for name, columns in channels.items() if columns}


def _pairs(columns: Sequence[FileColumn]) -> list[tuple[FileColumn | None, FileColumn | None]]:
    """Return every assignment of columns to two ends; a single column may be at either."""
    if not columns:
        return [(None, None)]
    if len(columns) == 1:
        return [(columns[0], None), (None, columns[0])]
    return list(permutations(columns, 2))


def _fits_names(candidate: _Candidate, columns: Sequence[FileColumn]) -> bool:
    """Return whether each column is at the end in its name, and at no end of another's name."""
    for name, column in candidate.items():
        end = "in" if name.endswith(("in_mm", "in_N")) else "out"
        if column is None:
            continue
        if column.end is None:
            kind = LENGTHS if name in _X else FORCES
            if any(c.end == end and c.quantity in kind for c in columns):
                return False
        elif column.end != end and (column.end, end) != ("motor", "in"):
            return False
    return True


def _fits_motion(candidate: _Candidate, motion: _Order) -> bool:
    """Return whether no channel moves before one that is nearer to the drive."""

    def order(near: str, far: str) -> int:
        a, b = candidate[near], candidate[far]
        return 0 if a is None or b is None else motion[id(a), id(b)]

    if any(order(*pair) == -1 for pair in _ORDER):
        return False
    # With friction at the load, f_out may lead x_in; x_out then shows the order.
    return order("x_in_mm", "x_out_mm") == 1 or order("x_in_mm", "f_out_N") != -1
