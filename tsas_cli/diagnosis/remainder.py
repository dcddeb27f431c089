"""The remaining residual with the named causes: its size, its dependence, the attainable residual.

A regression on the recorded signals, each by hat functions and with separate weights for both
directions, estimates the residual that any model of these signals could attain on held-out data. It
shows that a model lacks something, not the cause. What it leaves beyond the white noise repeats
with no signal: slow noise.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from tsas_cli.diagnosis.evidence import gain
from tsas_cli.diagnosis.held_out import Folds, in_stretches
from tsas_cli.diagnosis.moments import at_moments, oscillation, ripple
from tsas_cli.diagnosis.regression import hats, regressed
from tsas_cli.diagnosis.signals import DIRECTION, AtResiduals, signals_at_residuals
from tsas_cli.diagnosis.tolerances import (
    rigs_with_tolerances,
    tolerances,
    with_scale_and_zeros,
    without_tolerances,
)
from tsas_cli.identification.extension import Bench
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.numerics.covariance import autocovariance
from tsas_cli.support.arrays import Floats

DEPENDS = 0.02  # least share of the squares that a signal alone explains
STRUCTURE = 0.05  # of the noise's square, that a complete model leaves unexplained at most
MOST_SLOW = 2.0  # square of slow noise over that of white noise, beyond which it is an error
LEAST_SLOW = 0.15  # the same, below which there is none
LINEAR = 2e-4  # of a channel's range: RMS by which good sensors are off the line
JERK_S = 0.2  # memory of an error up to which it is no drift


@dataclass(frozen=True)
class SlowPart:
    """Coloured noise of a channel: its standard deviation over the white noise's, its memory."""

    ratio: float
    time_s: float


@dataclass(frozen=True)
class Remainder:
    """The remaining residual of a trial.

    `mean_square` is that of the weighted residuals; `explained` the reduction of each channel's
    mean square by a regression on held-out stretches, `shares` the part of it, `reducible` the
    reduction of the whole, `structure` that of the sum of the fit's squares,
    all of the excess where that is too large for noise; `depends_on` the
    signals that explain most of it; `slow` what of a channel repeats with no signal; `late` the
    channels in which each stroke lags behind the model; `brief` those that deviate at a few moments
    of a run; `oscillates` a phrase on a dominant frequency or period of displacement, if any.
    """

    mean_square: float
    explained: dict[str, float]
    depends_on: tuple[str, ...]
    reducible: float = 0.0
    structure: float = 0.0
    slow: dict[str, SlowPart] = field(default_factory=dict)
    shares: dict[str, float] = field(default_factory=dict)
    late: tuple[str, ...] = ()
    brief: tuple[str, ...] = ()
    oscillates: str | None = None

    @property
    def complete(self) -> bool:
        """Whether only noise remains, white or slow, and nothing that a cause could explain."""
        return not (
            self.oscillates
            or self.late
            or self.brief
            or any(part > STRUCTURE for part in self.explained.values())
            or any(slow.ratio**2 > MOST_SLOW for slow in self.slow.values())
        )

    @property
    def wanders(self) -> str | None:
        """The channel with a slow error that is too large for noise, and that follows no signal.

        What lasts as briefly as a jerk, a catch or a burst is no drift.
        """
        follows = any(part > STRUCTURE for part in self.explained.values())
        if self.depends_on or self.late or follows or not self.slow:
            return None
        name = max(self.slow, key=lambda n: self.slow[n].ratio)
        slow = self.slow[name]
        return name if slow.ratio**2 > MOST_SLOW and slow.time_s > JERK_S else None


def remainder_of(bench: Bench, trial: HypothesisFit, folds: Folds) -> Remainder:
    """Return what a trial leaves, with the tolerances of a rig at it."""
    at_residuals = signals_at_residuals(bench, trial)
    return remainder(bench, trial, folds, at_residuals, tolerances(bench, trial))


def share_left(start: Remainder, after: Remainder) -> float:
    """Return the share of what could be explained at first that remains, 0 to 1."""
    floor = after.mean_square - after.reducible
    first = max(start.mean_square - floor, 0.0)
    return min(after.reducible / first, 1.0) if first > 0.0 else 0.0


def remainder(
    bench: Bench,
    trial: HypothesisFit,
    folds: Folds,
    at_residuals: AtResiduals,
    tolerated: Floats,
) -> Remainder:
    """Return the remaining residual of a trial, with the signals at its residuals.

    What is plausible on every rig is left out: friction and zeros of each run's own, and
    `tolerated`, changes of the residuals by one standard deviation of tolerances, shape (n, m).
    """
    fitted = [bench.rig(trial, k) for k in range(len(bench.rigs))]
    runs = bench.errors_for(trial)
    by_run = [run.errors(rig) for run, rig in zip(runs, fitted, strict=True)]
    errors = {n: [of_run[n] for of_run in by_run if n in of_run] for n in bench.channels}
    beside = with_scale_and_zeros(bench, trial, tolerated)
    residual = without_tolerances(trial, beside, folds.run)
    by_channel = _by_channel(bench, trial, folds, at_residuals, residual, errors)
    count = sum(part.samples for part in by_channel.values())
    alone = {s: 0.0 for s in at_residuals.signals if s != DIRECTION}
    for part in by_channel.values():
        for signal, squares in part.by_signal.items():
            alone[signal] += squares / float(residual @ residual)
    found = [s for s, part in sorted(alone.items(), key=lambda a: -a[1]) if part > DEPENDS]
    oscillates = oscillation(runs, by_run) or ripple(runs, by_run)
    late, brief = at_moments(bench, runs, fitted)
    if late or brief:  # what tolerances do at reversals has no weight in the fit
        rigs = rigs_with_tolerances(bench, trial, beside, folds.run)
        late, brief = at_moments(bench, bench.meshed, rigs)
    return Remainder(
        mean_square=sum(part.squares for part in by_channel.values()) / count,
        explained={name: part.explained for name, part in by_channel.items()},
        depends_on=_said(oscillates, found[:3]),
        reducible=sum(part.explained * part.samples / count for part in by_channel.values()),
        structure=sum(part.structure for part in by_channel.values()),
        slow={
            name: SlowPart(math.sqrt(part.slow), _memory_s(bench, name, errors[name]))
            for name, part in by_channel.items()
            if part.slow > LEAST_SLOW
        },
        shares={name: part.share for name, part in by_channel.items()},
        late=late,
        brief=brief,
        oscillates=oscillates,
    )


def _said(oscillates: str | None, signals: Sequence[str]) -> tuple[str, ...]:
    """Return the signals, the one that a residual repeats over with the phrase that says so."""
    if oscillates is None:
        return tuple(signals)
    over = oscillates.partition(" ")[0]
    return (oscillates, *(signal for signal in signals if signal != over))


@dataclass(frozen=True)
class _OfChannel:
    """What a regression on the signals explains of one channel on held-out stretches.

    `squares` are those of its `samples`, `explained` is the reduction of their mean, `share` that
    of the residuals, `structure` their squares that it explains, or all beyond the noise where too
    much is left; `slow` the square of slow noise over that of white noise, `by_signal` the squares
    that each signal alone explains.
    """

    samples: int
    squares: float
    explained: float
    share: float
    structure: float
    slow: float
    by_signal: dict[str, float]


def _by_channel(
    bench: Bench,
    trial: HypothesisFit,
    folds: Folds,
    at_residuals: AtResiduals,
    residual: Floats,
    errors: dict[str, list[Floats]],
) -> dict[str, _OfChannel]:
    """Return what the signals explain of each channel; `errors` are those of its samples."""
    signals, stretches = at_residuals.signals, in_stretches(folds).fold
    out = {}
    for number, (name, parts) in enumerate(errors.items()):
        here = at_residuals.channel == number
        own, fold, block = residual[here], stretches[here], folds.block[here]
        columns = {
            signal: hats(values[here], signals[DIRECTION][here])
            for signal, values in signals.items()
            if signal != DIRECTION
        }
        left = own - regressed(np.hstack(list(columns.values())), own, fold)
        before, after = (np.bincount(block, r**2).astype(np.float64) for r in (own, left))
        used = before > 0.0
        best = gain(before[used], after[used])
        total = float(own @ own)
        # Each residual is a mean of samples, scaled to unit variance.
        samples = sum(part.size for part in parts)
        squares = sum(float(part @ part) for part in parts)
        of_mean = float(np.mean(own**2)) * own.size / samples
        explained = max(best.part, 0.0) * of_mean if best.convincing else 0.0
        if explained < _linear_over_noise(bench, name) ** 2:
            explained = 0.0
        share = best.part if explained > 0.0 else 0.0
        by_tolerances = float(np.sum(trial.solution.residual[here] ** 2)) - total
        slow = (squares - by_tolerances) / samples - explained - 1.0
        structure = share * total if slow <= MOST_SLOW else max(total - own.size, 0.0)
        by_signal = {}
        for signal, of_signal in columns.items():
            rest = own - regressed(of_signal, own, fold)
            by_signal[signal] = max(total - float(rest @ rest), 0.0)
        out[name] = _OfChannel(samples, squares, explained, share, structure, slow, by_signal)
    return out


def _linear_over_noise(bench: Bench, name: str) -> float:
    """Return to how many times its noise a channel is linear, as no sensor is better."""
    recorded = [run.run for run in bench.closed if name in run.samples]
    values = np.concatenate([run.measured[name] for run in recorded])
    noise = float(np.median([run.noise[name] for run in recorded]))
    span = float(np.nanmax(values) - np.nanmin(values))
    return LINEAR * span / noise if noise > 0.0 else 0.0


def _memory_s(bench: Bench, name: str, errors: list[Floats]) -> float:
    """Return the time in which the autocorrelation of a channel's slow errors falls to 1/e [s]."""
    times = []
    recorded = [run for run in bench.closed if name in run.samples]
    for run, part in zip(recorded, errors, strict=True):
        covariance = autocovariance(part)[1:]
        lost = np.flatnonzero(covariance < covariance[0] / math.e)
        step_s = float(np.median(np.diff(run.run.time_s[run.samples[name]])))
        times.append(step_s * (1 + (int(lost[0]) if lost.size else covariance.size)))
    return float(np.median(times))
