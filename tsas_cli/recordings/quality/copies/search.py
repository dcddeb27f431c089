"""Search for the runs of a dataset that hold samples of others.

Short stretches of every run are searched for in every other run, piece by piece; if one is found,
the two runs are compared sample by sample. A run that is a whole copy is not searched further, so
that many copies of one run cost little.
"""

import math
from collections import Counter
from collections.abc import Iterator, Sequence, Set
from dataclasses import dataclass, replace

import numpy as np

from tsas_cli.recordings.columns import TIME
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.quality.copies.agreement import (
    Copy,
    RowSpan,
    RunSamples,
    agreement,
    contradictions,
    joined,
    stretches,
)
from tsas_cli.recordings.quality.copies.fingerprint import (
    Fineness,
    Fingerprint,
    Reader,
    side_by_side,
)
from tsas_cli.recordings.quality.copies.lookup import Lookup, Shift
from tsas_cli.support.arrays import Floats, Indices

SHIFT_TOLERANCE = 0.1  # of a sample interval, within which two shifts are one
MOST_SHIFTS = 8  # of a run on another that are compared


@dataclass(frozen=True)
class Found:
    """The copies in a dataset, in the order of its runs, and the runs that were not searched.

    In `unordered` runs time does not increase; in `short` ones too few rows change.
    """

    copies: tuple[Copy, ...] = ()
    unordered: tuple[str, ...] = ()
    short: tuple[str, ...] = ()


def find_copies(dataset: Dataset, *, strict: bool = True) -> Found:
    """Return the runs that hold samples of others.

    With `strict=False`, unreadable runs are left out, and time may decrease.
    """
    if len(dataset.runs) < 2:
        return Found()
    with np.errstate(all="ignore"):  # a stray 1e300 may overflow
        return _found(dataset, strict=strict)


def _found(dataset: Dataset, *, strict: bool) -> Found:
    reader = Reader(dataset, strict=strict)
    first: dict[str, Fingerprint] = {}
    copies: list[Copy] = []
    for run in dataset.runs:
        digest = run.sha256.lower()
        if digest in first:
            known, same = first[digest], contradictions(run, first[digest].run)
            copies.append(Copy(run, known.run, known.all, known.all, known.all, contradicts=same))
            continue
        one = reader.fingerprint(run)
        if one is not None:
            first[digest] = one
    searched = list(first.values())
    order = {run.id: k for k, run in enumerate(dataset.runs)}
    copies += _search(reader, [f for f in searched if f.increases], order)
    if dataset.manifest.kind == "simulated":  # without noise, different rigs may have equal samples
        quiet = {f.run.id for f in searched if not f.noisy}
        copies = [replace(c, contradicts=()) if c.other.id in quiet else c for c in copies]
    return Found(
        tuple(sorted(copies, key=lambda c: (order[c.run.id], c.span.first))),
        tuple(f.run.id for f in searched if not f.increases),
        tuple(f.run.id for f in searched if f.increases and not f.stretches.size),
    )


def _search(reader: Reader, known: Sequence[Fingerprint], order: dict[str, int]) -> list[Copy]:
    """Return the copies among runs with different files."""
    groups = _groups(known)
    whole: dict[str, Copy] = {}
    parts: list[Copy] = []
    # The contained run is the copy, whichever comes first.
    for source in sorted(known, key=lambda f: (f.interpolated, -f.all.rows)):
        if source.run.id in whole:
            continue
        for copy in _in_source(reader, source, groups, whole.keys() | {source.run.id}):
            if copy.whole:
                whole[copy.run.id] = copy
            else:
                parts.append(copy)
    kept = {
        (c.run.id, c.other.id, c.span): c
        for c in parts
        if not {c.run.id, c.other.id} & whole.keys()
    }
    # What two runs share is said once: of the later one, if it was found in both.
    later = [c for c in kept.values() if order[c.run.id] >= order[c.other.id]]
    pairs = {(c.other.id, c.run.id) for c in later}
    earlier = [c for c in kept.values() if order[c.run.id] < order[c.other.id]]
    alone = [c for c in earlier if (c.run.id, c.other.id) not in pairs]
    return [*whole.values(), *later, *alone]


def _in_source(
    reader: Reader, source: Fingerprint, groups: Sequence["_Group"], but: Set[str]
) -> Iterator[Copy]:
    """Yield the copies of a source in other runs, except those in `but`."""
    places: dict[str, Counter[Shift]] = {}
    others: dict[str, Fingerprint] = {}
    for other, shift in _places(reader, source, groups, but):
        others[other.run.id] = other
        seen = places.setdefault(other.run.id, Counter())
        near_s = SHIFT_TOLERANCE * source.interval_s
        alike = (s for s in seen if s.spline == shift.spline)
        same = (s for s in alike if abs(s.seconds - shift.seconds) < near_s)
        seen[next(same, shift)] += 1
    for run, seen in places.items():
        spans: list[RowSpan] = []
        for shift, _ in seen.most_common(MOST_SHIFTS):
            for copy in _common_stretches(reader, source, others[run], shift):
                if not any(s.first < copy.span.end and copy.span.first < s.end for s in spans):
                    spans.append(copy.span)
                    yield copy
                    if not copy.whole:  # the source may be a part of it
                        back = Shift(-shift.seconds, shift.spline)
                        yield from _common_stretches(reader, others[run], source, back)
            if sum(span.rows for span in spans) == others[run].all.rows:
                break


@dataclass(frozen=True, eq=False)
class _Group:
    """Runs with the same channels and similar quantisation steps, and all their stretches."""

    members: Sequence[Fingerprint]
    steps: dict[str, float]  # the coarsest ones
    owner: Indices  # number of the run of each stretch
    stretches_s: Floats
    stretches: Floats


def _groups(known: Sequence[Fingerprint]) -> list[_Group]:
    """Return the runs in groups; runs without stretches are in none."""
    groups: dict[tuple[object, ...], list[Fingerprint]] = {}
    for one in known:
        if one.stretches.size:
            key = [(name, math.frexp(c.step)[1]) for name, c in one.channels.items()]
            groups.setdefault((*key, one.dense, one.stretches_s.shape[1]), []).append(one)
    return [
        _Group(
            members,
            {n: max(m.channels[n].step for m in members) for n in members[0].channels},
            np.repeat(np.arange(len(members)), [len(m.stretches) for m in members]),
            np.concatenate([m.stretches_s for m in members]),
            np.concatenate([m.stretches for m in members]),
        )
        for members in groups.values()
    ]


def _places(
    reader: Reader, source: Fingerprint, groups: Sequence[_Group], but: Set[str]
) -> Iterator[tuple[Fingerprint, Shift]]:
    """Yield the run and the shift of each stretch found in a source."""
    comparable = []
    for group in groups:
        one = group.members[0]
        names = [n for n in one.dense if n in source.dense and n in source.channels]
        if names and one.evidence <= source.channels.keys():
            comparable.append((group, one, names))
    for piece in reader.parts(source.run) if comparable else ():
        for group, one, names in comparable:
            searched = np.array([m.run.id not in but for m in group.members])[group.owner]
            if not searched.any():
                continue
            values = np.column_stack([piece.columns[name] for name in names])
            fine = [source.channels[name] for name in names]
            lookup = Lookup(
                RunSamples(piece.columns[TIME], values),
                np.array([source.channels[n].tolerance(group.steps[n]) for n in names]),
                # Coarse samples agree loosely with those of any repeat.
                np.array([channel.noise if source.noisy else 0.0 for channel in fine]),
            )
            columns = [one.dense.index(name) for name in names]
            owner = group.owner[searched]
            for number, shift in lookup.shifts(
                group.stretches_s[searched], group.stretches[searched][:, :, columns]
            ):
                yield group.members[owner[number]], shift


def _common_stretches(
    reader: Reader, source: Fingerprint, other: Fingerprint, shift: Shift
) -> Iterator[Copy]:
    """Yield the stretches of another run that are a source's samples at this shift."""
    names = [name for name in other.channels if name in source.channels]
    fine = [source.channels[name] for name in names]
    tolerance = np.array(
        [one.tolerance(other.channels[n].step) for n, one in zip(names, fine, strict=True)]
    )
    information = _information(fine, tolerance)
    both = side_by_side(reader.parts(other.run), reader.parts(source.run), names, shift.seconds)
    found = (
        stretches(
            row,
            samples.moved(-shift.seconds),
            agreement(around, samples, tolerance, spline=shift.spline),
            information,
        )
        for row, samples, around in both
    )
    against = contradictions(other.run, source.run)
    for span, every in joined(stretch for part in found for stretch in part):
        yield Copy(
            other.run, source.run, span, other.all, source.all, shift.seconds, every, against
        )


def _information(channels: Sequence[Fineness], tolerance: Floats) -> Floats:
    """Return −ln of the probability that a repeat agrees with a sample of each channel [nats].

    If some channels have noise, the others carry no information: they may be commanded, and equal
    in every repeat. The same holds for computed channels beside coarse ones.
    """
    noisy = np.array([channel.noisy for channel in channels])
    coarse = np.array([channel.step > 0.0 for channel in channels])
    informative = noisy if noisy.any() else coarse if coarse.any() else ~noisy
    pairs = zip(channels, tolerance.tolist(), strict=True)
    return np.where(informative, [channel.information(off) for channel, off in pairs], 0.0)
