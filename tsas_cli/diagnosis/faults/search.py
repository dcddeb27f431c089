"""Find the fault of one run, or of one clock, that explains most of the nominal model's residual.

Every fault is one linear unknown beside the nominal parameters and the tolerances of a rig: the
zero or the gain of a channel over a part of a run, its delay, the pace of its clock, and the
friction or the stiffness of one run; or a swing of a channel, by the phase in each run.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from tsas_cli.diagnosis.faults.hum import swings
from tsas_cli.diagnosis.faults.shapes import CONSTANTS_S, RATES, WINDOWS, RunShapes, shapes_of
from tsas_cli.diagnosis.search import Search
from tsas_cli.diagnosis.signals import signals_at_residuals
from tsas_cli.diagnosis.tolerances import SCATTER, friction_of_runs
from tsas_cli.identification.extension import Bench, HypothesisFit
from tsas_cli.support.arrays import Floats, Indices, Mask

STIFFNESS, OWN_FRICTION = "tendon_stiffness_N", "run-friction"
OF_THE_CATALOGUE = "channel_delay"  # no fault of a run: the search for causes finds it
TINY = 1e-9
MOST_SCATTER = 3.0  # standard deviations of the friction from run to run
LEAST_EXCESS = 0.05  # of the squares of the noise, that a fault is sought for
MOST = 0.7  # of the excess, that a fault has to explain
RIVAL, MOST_RIVALS = 0.9, 2  # of the best reduction, by a fault that is said beside it
ONCE = (0.5, 2.0)  # the amount of an effect whose size its shape tells
AS_GOOD = 0.97  # of the best reduction, by a fault that is simpler


@dataclass(frozen=True)
class Candidate:
    """A fault by one unknown: what it is, where, the amount, and the squares that it takes away.

    `run` is None for a fault of all runs; `edges` counts the ends of the part of the run that it
    is in, from `first_s` to `last_s`. A run is `alone` if no other has its bend.
    """

    code: str
    run: int | None
    channels: tuple[str, ...]
    amount: float
    reduction: float
    edges: int = 0
    first_s: float | None = None
    last_s: float | None = None
    alone: bool = False


@dataclass(frozen=True, eq=False)
class Beside:
    """The residual of a trial beside its parameters and tolerances, and columns beside them."""

    basis: Floats  # orthonormal, of residuals and priors, shape (n + m, p)
    residual: Floats
    squares: float

    def project(self, columns: Floats) -> Floats:
        """Return columns, shape (n, m), beside the basis."""
        n = columns.shape[0]
        padded = np.vstack((columns, np.zeros((self.basis.shape[0] - n, columns.shape[1]))))
        return np.asarray(padded - self.basis @ (self.basis.T @ padded))


def beside(trial: HypothesisFit, tolerated: Floats, run: Indices, *, alike: bool = False) -> Beside:
    """Return the residual that neither the parameters of a trial nor tolerances explain.

    The friction of the runs has a tolerance, unless it is `alike` in all of them.
    """
    free = trial.solution.jacobian[:, ~trial.solution.at_bound]
    frictions = friction_of_runs(trial, run)
    if alike:
        frictions = frictions[:, :0]
    own = np.column_stack((frictions, tolerated))
    count = own.shape[1]
    columns = np.hstack((free / np.linalg.norm(free, axis=0), own))
    priors = np.hstack((np.zeros((count, free.shape[1])), np.eye(count)))
    basis = np.linalg.qr(np.vstack((columns, priors)))[0]
    residual = np.append(trial.solution.residual, np.zeros(count))
    residual = residual - basis @ (basis.T @ residual)
    return Beside(basis, residual, float(residual @ residual))


def candidates(bench: Bench, trial: HypothesisFit, left: Beside, run: Indices) -> list[Candidate]:
    """Return all faults with the squares that each takes away, the largest first."""
    shapes = [shapes_of(bench, trial, k) for k in range(len(bench.rigs))]
    found = [
        *(c for k, own in enumerate(shapes) for c in _of_run(k, own, left, run)),
        *_of_clocks(shapes, left),
        *_of_amplifiers(shapes, left),
        *_of_manifest(trial, left, run),
        *_of_hum(bench, trial, left, run),
    ]
    return sorted(found, key=lambda c: -c.reduction)


def simplest(found: Sequence[Candidate]) -> Candidate:
    """Return the best fault, or one as good with fewer ends."""
    good = [c for c in found if c.reduction >= AS_GOOD * found[0].reduction]
    return min(good, key=lambda c: (c.edges, -c.reduction))


@dataclass(frozen=True)
class FoundFault:
    """The best fault and others as good.

    `share` is that of the `excess` of the squares over the noise's that it explains, `rest` the
    squares that are left with it.
    """

    found: tuple[Candidate, ...]
    share: float
    excess: float
    rest: float


def fault_of_recording(search: Search, accepted: Collection[str]) -> FoundFault | None:
    """Return the fault that explains most of what the nominal model leaves, and faults as good.

    None is returned where the nominal model leaves little, or no fault explains most of it: a
    mechanism acts in every run. Faults of the codes that are `accepted` are not sought.
    """
    bench, trial, run = search.bench, search.trial(frozenset()), search.folds.run
    tolerated = search.tolerated[trial.on_mesh]
    left = beside(trial, tolerated, run)
    found = [c for c in candidates(bench, trial, left, run) if c.code not in accepted]
    choices = [_judged(found, left.squares, run.size)]
    if OWN_FRICTION not in accepted:
        own = _of_frictions(trial, tolerated, run, [rig.total_bend_rad for rig in bench.rigs])
        choices += [_judged([c], squares, run.size) for c, squares in own]
    convincing = [fault for fault in choices if _convinces(fault, run.size)]
    return min(convincing, key=lambda fault: fault.rest) if convincing else None


def _judged(found: Sequence[Candidate], squares: float, count: int) -> FoundFault:
    """Return the simplest of the best faults, with those that are as good elsewhere."""
    best = simplest(found)
    where = {(best.run, best.channels)}
    rivals: list[Candidate] = []
    for other in found:
        if other.reduction < RIVAL * best.reduction or len(rivals) == MOST_RIVALS:
            break
        known = other.code == OF_THE_CATALOGUE or (other.run, other.channels) in where
        if not known and other.edges <= best.edges:
            where.add((other.run, other.channels))
            rivals.append(other)
    excess = squares - count
    share = best.reduction / max(excess, TINY)
    return FoundFault((best, *rivals), share, excess, squares - best.reduction)


def _convinces(fault: FoundFault, count: int) -> bool:
    known = fault.found[0].code == OF_THE_CATALOGUE
    return not known and fault.excess > LEAST_EXCESS * count and fault.share > MOST


def _of_frictions(
    trial: HypothesisFit, tolerated: Floats, run: Indices, bends: Sequence[float]
) -> Iterator[tuple[Candidate, float]]:
    """Yield a friction of each run's own beyond its tolerance, and the squares without it."""
    frictions = friction_of_runs(trial, run)
    left = beside(trial, tolerated, run, alike=True)
    for k in range(frictions.shape[1]):
        column = left.project(-frictions[:, [k]])[:, 0]
        for found in _one(OWN_FRICTION, k, (), column, left):
            if abs(found.amount) > MOST_SCATTER:
                alone = bends.count(bends[k]) == 1
                yield replace(found, amount=SCATTER * found.amount, alone=alone), left.squares


def _of_run(k: int, shapes: RunShapes, left: Beside, run: Indices) -> Iterator[Candidate]:
    """Yield the best part of the run, for each channel, for its zero and its gain."""
    for code, columns in (("run-offset", shapes.offset), ("run-gain", shapes.gain)):
        for name, own in columns.items():
            parts = left.project(_in_run(own, run == k))
            gram, score = parts.T @ parts, parts.T @ left.residual
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
            whole = _in_run(_sum(late, channels)[:, None], run == k)
            yield from _one(code, k, channels, left.project(whole)[:, 0], left)


def _of_clocks(shapes: Sequence[RunShapes], left: Beside) -> Iterator[Candidate]:
    """Yield clocks of some channels that run at another pace in all runs, or are late in all."""
    for channels in _groups(tuple(shapes[0].pace)):
        if all(set(channels) <= set(own.pace) for own in shapes):
            for code in ("clock", OF_THE_CATALOGUE):
                of_runs = [own.pace if code == "clock" else own.late for own in shapes]
                yield from _of_all(code, channels, [_sum(own, channels) for own in of_runs], left)
    for channels in _groups(tuple(shapes[0].clocked)):
        for rate in RATES if all(set(channels) <= set(own.clocked) for own in shapes) else ():
            parts = [np.sum([own.clocked[n][rate] for n in channels], axis=0) for own in shapes]
            for found in _of_all("clock", channels, parts, left):
                if ONCE[0] < found.amount < ONCE[1]:
                    yield replace(found, amount=rate * found.amount)


def _of_amplifiers(shapes: Sequence[RunShapes], left: Beside) -> Iterator[Candidate]:
    """Yield a coupling to AC of a tension in all runs, of about the size that it has."""
    for name in shapes[0].coupled:
        for constant_s in CONSTANTS_S if all(name in own.coupled for own in shapes) else ():
            parts = [own.coupled[name][constant_s] for own in shapes]
            for found in _of_all("ac-coupled", (name,), parts, left):
                if ONCE[0] < found.amount < ONCE[1]:
                    yield replace(found, amount=constant_s)


def _sum(columns: Mapping[str, Floats], channels: tuple[str, ...]) -> Floats:
    return np.asarray(np.sum([columns[name] for name in channels], axis=0))


def _of_all(
    code: str, channels: tuple[str, ...], parts: Sequence[Floats], left: Beside
) -> Iterator[Candidate]:
    """Yield a fault of all runs, by its column in each of them."""
    column = left.project(np.concatenate(parts)[:, None])[:, 0]
    yield from _one(code, None, channels, column, left)


def _of_manifest(trial: HypothesisFit, left: Beside, run: Indices) -> Iterator[Candidate]:
    """Yield a stiffness, or a length, of one run's own."""
    for j, unknown in enumerate(trial.unknowns):
        if unknown.name == STIFFNESS and not trial.solution.at_bound[j]:
            for k in range(int(run.max()) + 1):
                column = -trial.solution.jacobian[:, j] * (run == k)
                yield from _one("run-length", k, (), left.project(column[:, None])[:, 0], left)


def _of_hum(bench: Bench, trial: HypothesisFit, left: Beside, run: Indices) -> Iterator[Candidate]:
    """Yield a swing of a channel at one frequency in all runs."""
    at = signals_at_residuals(bench, trial)
    for name, frequency, columns in swings(bench, trial, at, left.residual[: run.size], run):
        basis = np.linalg.qr(left.project(columns))[0]
        along = basis.T @ left.residual
        yield Candidate("hum", None, (name,), frequency, float(along @ along))


def _one(
    code: str, k: int | None, channels: tuple[str, ...], column: Floats, left: Beside
) -> Iterator[Candidate]:
    square = float(column @ column)
    if square > TINY:
        along = float(column @ left.residual)
        yield Candidate(code, k, channels, along / square, along**2 / square)


def _in_run(own: Floats, here: Mask) -> Floats:
    column = np.zeros((here.size, own.shape[1]))
    column[here] = own
    return column


def _groups(names: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    """Yield one channel, or two, of these: the others are on the first clock."""
    for count in (1, 2):
        yield from combinations(names, count)
