"""Search for the runs of a dataset that hold samples of others.

Hashes that two runs have in common give the shift of their clocks, by the most frequent difference
of the times. At this shift all rows are compared.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from tsas_cli.recordings.dataset import CONDITIONS, Dataset
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.quality.copies.rows import Reader, RowSpan, SearchedRun, common_grid
from tsas_cli.support.arrays import Floats, Indices, Mask
from tsas_cli.support.errors import InputError

WHOLE_SHARE = 0.98  # of a run's samples; the rest is its edges
CONDITION_TOLERANCE = 1e-3  # relative: 3.14 rad is π
ORDINALS = {1: "st", 2: "nd", 3: "rd"}
LEAST_INFORMATION = 40.0  # nats: by chance at one of 10¹⁷ shifts
LEAST_ROWS = 16  # that can tell as much
VOTING_SHARE = 0.25  # of the rows that tell as much, for a shift to be tried
MOST_SHIFTS = 4  # of a run on another that are tried
EQUAL_SHARE = 0.6  # of a stretch's information; rounding to other digits may part rows in noise
LONGEST_GAP = 16  # consecutive rows that it may part


@dataclass(frozen=True)
class Copy:
    """A stretch of a run whose samples are those of another run."""

    run: Run  # that holds the copy
    other: Run  # the original
    span: RowSpan
    all_of_run: RowSpan
    all_of_other: RowSpan
    shift_s: float = 0.0  # of the samples to the other run's clock
    every: int = 1  # k if it holds every k-th sample of the original
    contradicts: tuple[str, ...] = ()  # conditions that differ between the two in the manifest

    @property
    def whole(self) -> bool:
        """Whether the whole run is a copy."""
        return self.span.rows >= WHOLE_SHARE * self.all_of_run.rows

    @property
    def sentence(self) -> str:
        """Description of the copy, a predicate for the name of the run."""
        samples = f"the samples of run {self.other.id}"
        if self.every > 1:
            ordinal = ORDINALS.get(self.every % 10 if self.every % 100 // 10 != 1 else 0, "th")
            samples = f"every {self.every}{ordinal} sample of run {self.other.id}"
        begin_s, end_s = self.span.begin_s, self.span.end_s
        there = f"from {begin_s + self.shift_s:.6g} s to {end_s + self.shift_s:.6g} s"
        if not self.whole:
            return f"holds, from {begin_s:.6g} s to {end_s:.6g} s, {samples} {there}"
        if self.span.duration_s < WHOLE_SHARE * self.all_of_other.duration_s:
            return f"holds {samples} {there}"
        if abs(self.shift_s) * self.all_of_run.rows > self.all_of_run.duration_s:
            return f"holds {samples}, its time shifted by {-self.shift_s:.6g} s"
        return f"holds {samples}"

    @property
    def contradiction(self) -> str:
        """The differing conditions, as the end of a sentence; empty without any."""
        differing = [
            f"{name} = {_text(getattr(self.run, name))} here and "
            f"{_text(getattr(self.other, name))} there"
            for name in self.contradicts
        ]
        return f", but the manifest says {', '.join(differing)}" if differing else ""


def _text(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:.6g}"


@dataclass(frozen=True)
class Found:
    """The copies in a dataset, in the order of its runs, and the runs that were not searched.

    In `unordered` runs time does not increase; in `short` ones too few rows change.
    """

    copies: tuple[Copy, ...] = ()
    unordered: tuple[str, ...] = ()
    short: tuple[str, ...] = ()


@np.errstate(all="ignore")  # a stray 1e300 may overflow
def find_copies(dataset: Dataset, *, strict: bool = True) -> Found:
    """Return the runs that hold samples of others.

    With `strict=False`, unreadable runs are left out, and time may decrease.
    """
    if len(dataset.runs) < 2:
        return Found()
    reader = Reader(dataset, strict=strict)
    first: dict[str, SearchedRun] = {}
    copies: list[Copy] = []
    for number, run in enumerate(dataset.runs):
        digest = run.sha256.lower()
        try:
            known = first.get(digest) or reader.searched(run, number)
        except InputError:
            if strict:
                raise
            continue
        if known.run is not run:
            same = contradictions(run, known.run)
            copies.append(Copy(run, known.run, known.all, known.all, known.all, contradicts=same))
        first[digest] = known
    ordered = [one for one in first.values() if one.increases]
    searched = [one for one in ordered if one.channels and one.all.rows >= LEAST_ROWS]
    copies += _search(reader, searched)
    if dataset.manifest.kind == "simulated":  # without noise, different rigs may have equal samples
        quiet = {one.run.id for one in ordered if not any(c.noise for c in one.channels.values())}
        copies = [replace(c, contradicts=()) if c.other.id in quiet else c for c in copies]
    order = {run.id: k for k, run in enumerate(dataset.runs)}
    return Found(
        tuple(sorted(copies, key=lambda c: (order[c.run.id], c.span.first))),
        tuple(one.run.id for one in first.values() if not one.increases),
        tuple(one.run.id for one in ordered if one not in searched),
    )


def contradictions(run: Run, other: Run) -> tuple[str, ...]:
    """Return the conditions that differ between two runs by more than rounding."""
    stated = [(name, getattr(run, name), getattr(other, name)) for name in CONDITIONS]
    different = [
        name
        for name, a, b in stated
        if not (a is None or b is None or math.isclose(a, b, rel_tol=CONDITION_TOLERANCE))
    ]
    return (*different, "load") if run.load != other.load else tuple(different)


def _search(reader: Reader, known: list[SearchedRun]) -> list[Copy]:
    """Return the copies among runs with different files."""
    # What tells more is the original: more channels, more rows.
    known = sorted(known, key=lambda one: (-len(one.channels), -one.all.rows, one.number))
    whole: dict[str, Copy] = {}
    parts: list[Copy] = []
    for source, other in combinations(known, 2):
        if not {source.run.id, other.run.id} & whole.keys():
            found = _shared(reader, source, other)
            whole |= {copy.run.id: copy for copy in found if copy.whole}
            parts += found
    return [*whole.values(), *(c for c in parts if not {c.run.id, c.other.id} & whole.keys())]


def _shared(reader: Reader, source: SearchedRun, other: SearchedRun) -> list[Copy]:
    """Return the stretches that two runs share; the source has more channels, or more rows."""
    slow, fast = (source, other) if source.interval_s > 1.5 * other.interval_s else (other, source)
    if slow.channels.keys() - fast.channels.keys():  # a channel of its own is evidence
        return []
    grid = common_grid(slow, fast)
    rows, there = reader.hashed(slow, grid), reader.hashed(fast, grid)
    marks = rows.hashes[rows.first], there.hashes[there.first]
    _, ours, theirs = np.intersect1d(*marks, assume_unique=True, return_indices=True)
    apart_s = there.time_s[there.first[theirs]] - rows.time_s[rows.first[ours]]
    near_s = 0.5 * fast.interval_s
    votes = VOTING_SHARE * LEAST_INFORMATION / max(float(rows.nats.max(initial=0.0)), 1e-9)
    found: list[Copy] = []
    for shift_s in _shifts(apart_s, near_s, votes):
        at = np.searchsorted(0.5 * (there.time_s[1:] + there.time_s[:-1]), rows.time_s + shift_s)
        equal = there.hashes[at] == rows.hashes
        equal &= np.abs(there.time_s[at] - rows.time_s - shift_s) < near_s
        for ends in stretches(equal, rows.nats, noisy=rows.noisy):
            spans = {slow: rows.span(ends, slow.all), fast: there.span(at[ends], fast.all)}
            every = round((spans[fast].rows - 1) / (spans[slow].rows - 1))
            # The copy has fewer channels, or is in the other one as a whole, or comes later.
            rank = [
                (-len(one.channels), span.rows >= WHOLE_SHARE * one.all.rows, one.number)
                for one, span in spans.items()
            ]
            copy = slow if every > 1 or rank[0] > rank[1] else fast
            of, by_s = (fast, shift_s) if copy is slow else (slow, -shift_s)
            against = contradictions(copy.run, of.run)
            found.append(
                Copy(copy.run, of.run, spans[copy], copy.all, of.all, by_s, every, against)
            )
    return found


def _shifts(apart_s: Floats, near_s: float, least: float) -> Iterator[float]:
    """Yield the most frequent differences between times [s], of at least so many rows."""
    apart_s = np.sort(apart_s)
    for _ in range(MOST_SHIFTS):
        votes = np.searchsorted(apart_s, apart_s + near_s, side="right") - np.arange(apart_s.size)
        if votes.max(initial=0) < least:
            return
        first = int(votes.argmax())
        chosen = slice(first, first + int(votes[first]))
        yield float(np.median(apart_s[chosen]))
        apart_s = np.delete(apart_s, chosen)


def stretches(equal: Mask, nats: Floats, *, noisy: bool) -> list[Indices]:
    """Return the first and the last row of each stretch of equal rows that no repeat has.

    `nats` is what each row tells, shape (n,) as `equal`. Without noise every row has to be equal.
    """
    at = np.flatnonzero(equal)
    apart = np.flatnonzero(np.diff(at) > (LONGEST_GAP if noisy else 0) + 1) + 1
    edges = np.r_[0, apart, at.size]
    found = []
    for k in np.flatnonzero(np.diff(edges) >= LEAST_ROWS).tolist():
        rows = at[edges[k] : edges[k + 1]]
        evidence = float(nats[rows].sum())
        if evidence >= max(LEAST_INFORMATION, EQUAL_SHARE * nats[rows[0] : rows[-1] + 1].sum()):
            found.append(rows[[0, -1]])
    return found
