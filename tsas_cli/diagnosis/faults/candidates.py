"""Every fault of a recording by one unknown, with the squares of the residual that it takes away.

The zero or the gain of a channel over a part of a run, its delay, also since a moment, its lag, the
pace of its clock, the friction or the stiffness of one run; in all runs a coupling to AC, a
saturation, or a swing.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from tsas_cli.diagnosis.faults.beside import HIDDEN, Beside, Candidate, beside, one
from tsas_cli.diagnosis.faults.hum import swings
from tsas_cli.diagnosis.faults.shapes import (
    LATE_S,
    RATES,
    WINDOWS,
    ReadRun,
    RunShapes,
    passed,
    shapes_of,
)
from tsas_cli.diagnosis.friction_scatter import SCATTER, friction_of_runs
from tsas_cli.identification.extension import Bench
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.support.arrays import Floats, Indices

STIFFNESS, OWN_FRICTION = "tendon_stiffness_N", "run-friction"
SINCE = ("lost-samples", "repeated-buffer")  # a channel that is early, or late, since a moment
OF_A_SIZE = ("run-delay", "run-lag", *SINCE)  # their columns are of a size that is tried
OF_THE_CATALOGUE = "channel_delay"  # no fault of a run: the search for causes finds it
CONSTANTS_S = (2.0, 5.0, 10.0, 20.0, 40.0, 80.0, 160.0, 320.0)  # of amplifiers coupled to AC
LEVELS = np.linspace(0.4, 0.98, 16)  # of all values, below which a sensor may not saturate
STIFFER = 0.01  # step of a finite difference, relative
MOST_SCATTER = 3.0  # standard deviations of a friction or a zero, from run to run
LEAST_SHARE = 0.3  # of the squares, in the run in which a channel comes late since a moment
ONCE = (0.5, 2.0)  # the amount of an effect whose size its shape tells
HELD_BACK = (0.1, 1.5)  # the share that a saturated sensor holds back, with a scatter


def candidates(
    bench: Bench, trial: HypothesisFit, reads: Sequence[ReadRun], left: Beside
) -> list[Candidate]:
    """Return all faults with the squares that each takes away, the largest first."""
    shapes = [shapes_of(read) for read in reads]
    found = [
        *(c for k, own in enumerate(shapes) for c in _of_run(k, own, left.in_run(k))),
        *_of_clocks(shapes, left),
        *(c for constant_s in CONSTANTS_S for c in of_amplifiers(reads, left, constant_s)),
        *_of_saturation(reads, left),
        *_of_manifest(bench, trial, left),
        *_of_hum(reads, left),
        *(c for late_s in LATE_S for c in _of_shifts(reads, left, late_s)),
    ]
    return sorted(found, key=lambda c: -c.reduction)


def of_frictions(
    trial: HypothesisFit, tolerated: Floats, run: Indices, bends: Sequence[float]
) -> Iterator[tuple[Candidate, float]]:
    """Yield a friction of each run's own beyond its tolerance, and the squares without it."""
    frictions = friction_of_runs(trial, run)
    left = beside(trial, tolerated, run, alike=True)
    for k in range(frictions.shape[1]):
        for found in one(OWN_FRICTION, k, (), -frictions[:, k], left):
            if abs(found.amount) > MOST_SCATTER:
                alone = bends.count(bends[k]) == 1
                yield replace(found, amount=SCATTER * found.amount, alone=alone), left.squares


def _of_run(k: int, shapes: RunShapes, left: Beside) -> Iterator[Candidate]:
    """Yield the best part of the run, for each channel, for its zero and its gain."""
    for code, columns in (("run-offset", shapes.offset), ("run-gain", shapes.gain)):
        for name, own in columns.items():
            gram, score = left.seen(own)
            sums = np.pad(np.cumsum(np.cumsum(gram, axis=0), axis=1), ((1, 0), (1, 0)))
            scores = np.append(0.0, np.cumsum(score))
            for first, last in combinations(range(WINDOWS + 1), 2):
                square = (
                    sums[last, last] - sums[first, last] - sums[last, first] + sums[first, first]
                )
                if square > 1.0:
                    along = scores[last] - scores[first]
                    edges = (first > 0) + (last < WINDOWS)
                    ends = np.append(shapes.starts_s, np.nan)[[first, last]]
                    yield Candidate(
                        code,
                        k,
                        (name,),
                        along / square,
                        along**2 / square,
                        int(edges),
                        float(ends[0]) if first else None,
                        float(ends[1]) if last < WINDOWS else None,
                    )
    for code, late in (("run-delay", shapes.late), ("clock", shapes.pace)):
        names = tuple(late)
        for channels in _groups(names):
            yield from one(code, k, channels, _sum(late, channels), left)
    for channels in _groups(tuple(shapes.clocked)):
        for rate in RATES:
            at_pace = shapes.at_pace(channels, rate)
            yield from _of_size(one("clock", k, channels, at_pace, left), rate)


def _of_clocks(shapes: Sequence[RunShapes], left: Beside) -> Iterator[Candidate]:
    """Yield clocks of some channels that run at another pace in all runs, or are late in all."""
    for channels in _groups(tuple(shapes[0].pace)):
        if all(set(channels) <= set(own.pace) for own in shapes):
            for code in ("clock", OF_THE_CATALOGUE):
                of_runs = [own.pace if code == "clock" else own.late for own in shapes]
                yield from _of_all(code, channels, [_sum(own, channels) for own in of_runs], left)
    for channels in _groups(tuple(shapes[0].clocked)):
        for rate in RATES if all(set(channels) <= set(own.clocked) for own in shapes) else ():
            parts = [own.at_pace(channels, rate) for own in shapes]
            yield from _of_size(_of_all("clock", channels, parts, left), rate)


def _of_size(found: Iterator[Candidate], size: float) -> Iterator[Candidate]:
    """Yield faults whose amount is about the one that their columns are calculated with."""
    for c in found:
        if ONCE[0] < c.amount < ONCE[1]:
            yield replace(c, amount=size * c.amount)


def of_amplifiers(reads: Sequence[ReadRun], left: Beside, constant_s: float) -> Iterator[Candidate]:
    """Yield a coupling to AC of a tension in all runs, of about the size that it has.

    A tension that is the only channel and fades may be that of a load that relaxes.
    """
    for name in _tensions(reads) if len(_common(reads)) > 1 else ():
        columns = []
        for read in reads:
            values = read.values(name)
            columns.append(read.changed(name, passed(read.time_s, values, constant_s) - values))
        for found in _of_all("ac-coupled", (name,), columns, left):
            if ONCE[0] < found.amount < ONCE[1]:
                yield replace(found, amount=constant_s)


def _of_saturation(reads: Sequence[ReadRun], left: Beside) -> Iterator[Candidate]:
    """Yield a tension whose sensor holds back a share of all beyond a level, in all runs."""
    for name in _tensions(reads):
        values = [read.values(name) for read in reads]
        for level in np.quantile(np.concatenate(values), LEVELS):
            beyond = [np.maximum(own - level, 0.0) for own in values]
            pairs = zip(reads, beyond, strict=True)
            columns = [read.changed(name, -own) for read, own in pairs]
            for found in _of_all("saturates", (name,), columns, left):
                if HELD_BACK[0] < found.amount < HELD_BACK[1]:
                    yield replace(found, amount=float(level))


def _common(reads: Sequence[ReadRun]) -> list[str]:
    """Return the channels that all runs compare with the model."""
    first = reads[0].errors.samples
    return [name for name in first if all(name in read.errors.samples for read in reads)]


def _tensions(reads: Sequence[ReadRun]) -> list[str]:
    return [name for name in _common(reads) if name.endswith("_N")]


def _sum(columns: Mapping[str, Floats], channels: tuple[str, ...]) -> Floats:
    return np.asarray(np.sum([columns[name] for name in channels], axis=0))


def _of_all(
    code: str, channels: tuple[str, ...], parts: Sequence[Floats], left: Beside
) -> Iterator[Candidate]:
    """Yield a fault of all runs, by its column in each of them."""
    yield from one(code, None, channels, np.concatenate(parts), left)


def _of_manifest(bench: Bench, trial: HypothesisFit, left: Beside) -> Iterator[Candidate]:
    """Yield a stiffness, or a length, of one run's own, unless that of all is at a bound."""
    free = next((j for j, u in enumerate(trial.unknowns) if u.name == STIFFNESS), None)
    if free is None:
        stiffness = bench.rig(trial, 0).tendon_stiffness_N
        stiffer = bench.errors_at(trial, {STIFFNESS: (1.0 + STIFFER) * stiffness})
        slope = (stiffer - bench.errors_at(trial, {})) / math.log1p(STIFFER)
    elif trial.solution.at_bound[free]:
        return
    else:
        slope = trial.solution.jacobian[:, free]
    for k, rows in enumerate(left.runs):
        yield from one("run-length", k, (), -slope[rows], left.in_run(k))


def _of_hum(reads: Sequence[ReadRun], left: Beside) -> Iterator[Candidate]:
    """Yield a swing of a channel at one frequency in all runs."""
    from scipy.linalg import block_diag

    for name, frequency, columns in swings(reads, _common(reads)):
        products, along = left.seen(block_diag(*columns))
        amounts = np.linalg.lstsq(products, along, rcond=HIDDEN)[0]
        yield Candidate("hum", None, (name,), frequency, float(along @ amounts))


def _of_shifts(reads: Sequence[ReadRun], left: Beside, late_s: float) -> Iterator[Candidate]:
    """Yield channels of a run that come late by about that, all along or since a moment, or lag."""
    for k, read in enumerate(reads):
        here = left.in_run(k)
        if here.squares < LEAST_SHARE * left.squares:
            continue
        late = {name: read.since(name, read.late(name, late_s)) for name in read.errors.samples}
        for channels in _groups(tuple(late)):
            columns = _sum(late, channels)
            for part, first_s in enumerate(read.time_s[read.starts]):
                code = SINCE[late_s > 0.0] if part else "run-delay"
                since = float(first_s) if part else None
                for found in _of_size(one(code, k, channels, columns[:, part], here), late_s):
                    yield replace(found, edges=int(part > 0), first_s=since)
        for name in read.errors.samples if late_s > 0.0 else ():
            lagging = read.changed(name, read.lagging(name, late_s))
            yield from _of_size(one("run-lag", k, (name,), lagging, here), late_s)


def _groups(names: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    """Yield one channel, or two, of these: the others are on the first clock."""
    for count in (1, 2):
        yield from combinations(names, count)
