"""Find the fault of one run, or of one clock, that explains most of the nominal model's residual.

Every fault is one linear unknown beside the nominal parameters and the tolerances of a rig. What
explains most is looked at more closely: where a part of a run begins and ends, how fast an
amplifier forgets, and whether a zero steps several times.
"""

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tsas_cli.diagnosis.faults.beside import HIDDEN, TINY, Beside, Candidate, beside, one
from tsas_cli.diagnosis.faults.candidates import (
    MOST_SCATTER,
    OF_A_SIZE,
    OF_THE_CATALOGUE,
    OWN_FRICTION,
    candidates,
    of_amplifiers,
    of_frictions,
)
from tsas_cli.diagnosis.faults.shapes import WINDOWS, ReadRun, runs_at
from tsas_cli.diagnosis.fits import Fits
from tsas_cli.diagnosis.search import EXCESS_OF_COMPLETE_MODEL
from tsas_cli.diagnosis.signals import channel_of_residuals
from tsas_cli.diagnosis.tolerances import ZERO, largest_forces
from tsas_cli.identification.extension import Bench
from tsas_cli.support.arrays import Floats

LEAST_EXCESS = 0.05  # of the squares of the noise, that a fault is sought for
MOST, LEAST = 0.9, 0.7  # of the excess, that a fault has to explain; where only noise is left
TWICE, NOISE, MOST_RIVALS = 2.0, 0.1, 2  # what a rival leaves, over the best, and over the noise
AS_GOOD = 0.97  # of the best reduction, by a fault that is simpler
CLOSER = 0.7  # of the best reduction, by a fault that is looked at more closely
# Squares that are left over the noise's, and their share of the excess, from which all runs err: a
# stop in three of four runs left 0.66, faults 0.003 to 0.15.
FAR, LEFT_IN_ALL = 4.0, 0.3
FINER = np.arange(-8, 9) / 8.0  # of a part of the run, or powers of two of a time constant
FEWEST_RUNS, STANDS_OUT = 3, 4.0  # of which one's fault explains so many times that of any other
STEP, MOST_STEPS = 0.1, 4  # least share of the excess by a step, and steps of a zero in a run


@dataclass(frozen=True)
class FoundFault:
    """The best fault and others as good.

    `share` is that of the `excess` of the squares over the `usual` ones that it explains, `rest`
    the squares that are left with it.
    """

    found: tuple[Candidate, ...]
    share: float
    excess: float
    rest: float
    usual: float


def fault_of_recording(fits: Fits, accepted: Collection[str]) -> FoundFault | None:
    """Return the fault that explains most of what the nominal model leaves, and faults as good.

    None is returned where the nominal model leaves little, or no fault explains most of it: a
    mechanism acts in every run. What all runs have, as slow noise, is none of a fault that stands
    out in one. Faults of the codes that are `accepted` are not sought.
    """
    bench, trial, run = fits.bench, fits.trial(frozenset()), fits.folds.run
    tolerated = fits.tolerated[trial.on_mesh]
    left = beside(trial, tolerated, run)
    choices: list[FoundFault] = []
    if left.squares > (1.0 + LEAST_EXCESS) * run.size:
        reads = runs_at(bench, trial)
        found = [c for c in candidates(bench, trial, reads, left) if c.code not in accepted]
        closer = [c for c in _closer(found, reads, left) if c.code not in accepted]
        usual = _usual(fits, left.residual) if _stands_out(closer) else run.size
        choices.append(_judged(closer, left.squares, usual))
    if OWN_FRICTION not in accepted:
        own = of_frictions(trial, tolerated, run, [rig.total_bend_rad for rig in bench.rigs])
        choices += [_judged([c], squares, run.size) for c, squares in own]
    convincing = [fault for fault in choices if _convinces(fault, run.size)]
    best = min(convincing, key=lambda fault: fault.rest, default=None)
    if best is None or any(_is_tolerated_zero(bench, one) for one in best.found):
        return None
    return best


def _is_tolerated_zero(bench: Bench, fault: Candidate) -> bool:
    """Return whether a fault is a zero of a force sensor no further off than that of every run."""
    if fault.code != "run-offset" or fault.edges:
        return False
    forces = largest_forces(bench)
    limits = [MOST_SCATTER * ZERO * forces[name] for name in fault.channels if name in forces]
    return bool(limits) and abs(fault.amount) <= min(limits)


def simplest(found: Sequence[Candidate]) -> Candidate:
    """Return the best fault, or one as good with fewer ends; of a lag and a delay the delay.

    Of one since a moment and one until then, which a free zero makes the same, that since then.
    """
    good = [c for c in found if c.reduction >= AS_GOOD * found[0].reduction]
    return min(good, key=lambda c: (c.edges, c.code == "run-lag", _is_until(c), -c.reduction))


def _is_until(c: Candidate) -> bool:
    return c.edges == 1 and c.first_s is None


def _stands_out(found: Sequence[Candidate]) -> bool:
    """Return whether the best fault is one of a run that explains far more than any of another."""
    best: dict[int, float] = {}
    for c in found:
        if c.run is not None:
            best.setdefault(c.run, c.reduction)
    others = [reduction for run, reduction in best.items() if run != found[0].run]
    return (
        found[0].run is not None
        and len(best) >= FEWEST_RUNS
        and found[0].reduction > STANDS_OUT * max(others)
    )


def _usual(fits: Fits, residual: Floats) -> float:
    """Return the squares of a residual whose channels are as large in all runs as in the median.

    They are at least those of noise.
    """
    run, channel = fits.folds.run, channel_of_residuals(fits.bench, fits.trial(frozenset()))
    usual = 0.0
    for number in np.unique(channel):
        here = channel == number
        means = [
            np.mean(residual[: run.size][here & (run == k)] ** 2) for k in np.unique(run[here])
        ]
        usual += max(float(np.median(means)), 1.0) * np.count_nonzero(here)
    return usual


def _judged(found: Sequence[Candidate], squares: float, usual: float) -> FoundFault:
    """Return the simplest of the best faults, with those that are as good elsewhere."""
    best = simplest(found)
    excess = squares - usual
    most = TWICE * max(excess - best.reduction, 0.0) + NOISE * usual
    where = {(best.run, best.channels)}
    rivals: list[Candidate] = []
    for other in found:
        if excess - other.reduction > most or len(rivals) == MOST_RIVALS:
            break
        known = other.code == OF_THE_CATALOGUE or (other.run, other.channels) in where
        if not known and other.edges <= best.edges:
            where.add((other.run, other.channels))
            rivals.append(other)
    share = best.reduction / max(excess, TINY)
    return FoundFault((best, *rivals), share, excess, squares - best.reduction, usual)


def _convinces(fault: FoundFault, noise: float) -> bool:
    """Return whether a fault is the reason; `noise` are the squares that it alone leaves.

    One that stands out in its run leaves what all runs have, but no mechanism that acts in all.
    """
    known = fault.found[0].code == OF_THE_CATALOGUE
    relative = fault.excess / fault.usual, fault.rest / fault.usual
    over_noise = fault.excess + fault.usual - noise
    in_all = fault.rest > FAR * noise and fault.rest - noise > LEFT_IN_ALL * over_noise
    return not in_all and not known and explains(fault.share, *relative)


def explains(share: float, excess: float, left: float) -> bool:
    """Return whether a fault is the reason of what the nominal model leaves.

    `share` is that of the `excess` of the mean square over the noise's that it explains, `left` the
    mean square with it.
    """
    least = LEAST if left < 1.0 + EXCESS_OF_COMPLETE_MODEL else MOST
    return excess > LEAST_EXCESS and share > least


def _closer(found: Sequence[Candidate], reads: Sequence[ReadRun], left: Beside) -> list[Candidate]:
    """Return the faults, those that explain most with the best ends, constants and steps."""
    best: dict[tuple[str, int | None, tuple[str, ...], int, bool], Candidate] = {}
    for c in found:
        if c.reduction < CLOSER * found[0].reduction:
            break
        best.setdefault((c.code, c.run, c.channels, c.edges, _is_until(c)), c)
    closer = list(found)
    for c in best.values():
        if c.code == "ac-coupled":
            constants = c.amount * 2.0**FINER
            closer += [s for constant in constants for s in of_amplifiers(reads, left, constant)]
        elif c.run is not None and c.code in OF_A_SIZE:
            closer.append(_with_size(c, reads[c.run], left.in_run(c.run)))
        elif c.run is not None and c.edges:
            closer.append(_with_ends(c, reads[c.run], left.in_run(c.run)))
    zero = next((c for c in found if c.code == "run-offset"), None)
    if zero is not None and zero.run is not None and len(reads) > 1:
        closer += _of_steps(zero, zero.run, reads[zero.run], left)
    return sorted(closer, key=lambda c: -c.reduction)


def _with_ends(c: Candidate, read: ReadRun, left: Beside) -> Candidate:
    """Return a fault of a part of a run with the ends that take most away."""
    part_s = float(read.time_s[-1]) / WINDOWS
    for end in ("first_s", "last_s"):
        at_s = getattr(c, end)
        if at_s is not None:
            others = (replace(c, **{end: at_s + f * part_s}) for f in FINER)
            fitted = [_fitted(other, _of_part(other, read), left) for other in others]
            c = max((c, *fitted), key=lambda other: other.reduction)
    return c


def _with_size(c: Candidate, read: ReadRun, left: Beside) -> Candidate:
    """Return a delay or a lag with the size, and the moment, that take most away."""
    for step in (1.0, 0.25, 0.0625):
        sizes = [replace(c, amount=c.amount * 2.0 ** (step * f)) for f in FINER]
        fitted = [_fitted(size, _of_part(size, read), left) for size in sizes]
        best = max(fitted, key=lambda other: other.reduction)
        c = _with_ends(best, read, left)
    return c


def _fitted(c: Candidate, column: Floats, left: Beside) -> Candidate:
    """Return a fault with the amount that fits best, by its column in its run, shape (r,)."""
    for found in one(c.code, c.run, c.channels, column, left):
        size = c.amount if c.code in OF_A_SIZE else 1.0
        return replace(c, amount=size * found.amount, reduction=found.reduction)
    return replace(c, reduction=0.0)


def _of_part(c: Candidate, read: ReadRun) -> Floats:
    """Return the change of the residuals by one unit of a fault of a part of a run, shape (r,)."""
    parts = []
    for name in c.channels:
        reading = np.ones(read.time_s.size)
        if c.code == "run-gain":
            reading = read.values(name)
        elif c.code == "run-lag":
            reading = read.lagging(name, c.amount)
        elif c.code in OF_A_SIZE:
            reading = read.late(name, c.amount)
        parts.append(read.changed_in(name, reading, c.first_s, c.last_s))
    return np.asarray(np.sum(parts, axis=0))


def _of_steps(zero: Candidate, k: int, read: ReadRun, left: Beside) -> Iterator[Candidate]:
    """Yield several steps of the zero of one channel in run k, one after the other."""
    before, excess = left, left.squares - left.runs[-1].stop
    starts_s = np.linspace(0.0, float(read.time_s[-1]), WINDOWS + 1)[1:-1]
    since = [replace(zero, first_s=float(s), last_s=None, edges=1) for s in starts_s]
    columns = [_of_part(c, read) for c in since]
    steps: list[Candidate] = []
    for _ in range(MOST_STEPS):
        here = left.in_run(k)
        each = [_fitted(c, column, here) for c, column in zip(since, columns, strict=True)]
        step = _with_ends(max(each, key=lambda c: c.reduction), read, here)
        if step.reduction < STEP * excess:
            break
        steps.append(step)
        left = left.without(k, _of_part(step, read))
    if len(steps) > 1:
        products, along = before.in_run(k).seen(np.column_stack([_of_part(c, read) for c in steps]))
        amounts = np.linalg.lstsq(products, along, rcond=HIDDEN)[0].tolist()
        at = sorted((c.first_s or 0.0, d) for c, d in zip(steps, amounts, strict=True))
        yield replace(
            zero,
            code="run-step",
            amount=sum(amount for _, amount in at),
            reduction=before.squares - left.squares,
            edges=len(steps),
            first_s=at[0][0],
            last_s=None,
            steps=tuple(at),
        )
