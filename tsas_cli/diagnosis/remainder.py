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
import numpy.typing as npt

from tsas_cli.diagnosis.evidence import gain
from tsas_cli.diagnosis.held_out import Folds, in_stretches
from tsas_cli.diagnosis.signals import DIRECTION, AtResiduals, signals_at_residuals
from tsas_cli.diagnosis.tolerances import rigs_with_tolerances, tolerances, without_tolerances
from tsas_cli.identification.extension import Bench
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.run_errors import RunErrors
from tsas_cli.physics.rig import Rig
from tsas_cli.support.arrays import Floats
from tsas_cli.support.wording import listed

HATS = 10  # hat functions of each signal and direction
RIDGE = 1.0  # regularisation, in units of noise
DEPENDS = 0.02  # least share of the squares that a signal alone explains
STRUCTURE = 0.05  # of the noise's square, that a complete model leaves unexplained at most
MOST_SLOW = 2.0  # square of slow noise over that of white noise, beyond which it is an error
LEAST_SLOW = 0.15  # the same, below which there is none
FEWEST_STROKES = 4
LATE = 2.0  # mean delay of the strokes of a complete model at most, in units of `delays`
FAR, FARTHEST = 4.0, 10.0  # standard deviations, and where one error counts for no more
FEWEST_FAR = 8  # errors that far: fewer may be a reversal out of place
UPPER_QUARTILE = 0.67449  # of the normal distribution, in standard deviations
BRIEF = 0.15  # mean square of the errors that far, over the variance, of a run with brief errors
LATE_CRITICAL = 4.0  # critical value of the t statistic of that mean
PEAK = 0.3  # share of a run's squares in one narrow band from which the residual is periodic
JERK_S = 0.2  # memory of an error up to which it is no drift
OWN = 2.5  # multiple of the motion's frequency from which an oscillation is not its own


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
    of a run; `oscillates` a phrase on a dominant frequency, if any.
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

    What is plausible on every rig is left out: friction of each run's own, and `tolerated`, changes
    of the residuals by one standard deviation of tolerances, shape (n, m).
    """
    fitted = [bench.rig(trial, k) for k in range(len(bench.rigs))]
    runs = [e.errors(rig) for e, rig in zip(bench.errors_for(trial), fitted, strict=True)]
    errors = {n: [run[n] for run in runs if n in run] for n in bench.channels}
    count = sum(part.size for parts in errors.values() for part in parts)
    squares = {n: sum(float(part @ part) for part in parts) for n, parts in errors.items()}
    signals, channel = at_residuals.signals, at_residuals.channel
    residual = without_tolerances(trial, tolerated, folds.run)
    stretches = in_stretches(folds).fold
    names = [name for name in signals if name != DIRECTION]
    alone = dict.fromkeys(names, 0.0)
    explained: dict[str, float] = {}
    slow: dict[str, SlowPart] = {}
    shares: dict[str, float] = {}
    reducible = structure = 0.0
    for number, name in enumerate(bench.channels):
        here = channel == number
        own, fold = residual[here], stretches[here]
        before = _by_block(own, folds, here)
        used = before > 0.0
        whole = [hats(signals[s][here], signals[DIRECTION][here]) for s in names]
        after = _by_block(own - regressed(np.hstack(whole), own, fold), folds, here)
        best = gain(before[used], after[used])
        # Each residual is a mean of samples, scaled to unit variance.
        samples = sum(part.size for part in errors[name])
        of_mean = float(np.mean(own**2)) * own.size / samples
        explained[name] = max(best.part, 0.0) * of_mean if best.convincing else 0.0
        reducible += explained[name] * samples / count
        shares[name] = best.part if explained[name] > 0.0 else 0.0
        beyond = max(float(own @ own) - own.size, 0.0)
        by_them = float(np.sum(trial.solution.residual[here] ** 2)) - float(own @ own)
        ratio = (squares[name] - by_them) / samples - explained[name] - 1.0
        structure += shares[name] * float(own @ own) if ratio <= MOST_SLOW else beyond
        if ratio > LEAST_SLOW:
            slow[name] = SlowPart(math.sqrt(ratio), _memory_s(bench, name, errors[name]))
        for signal, columns in zip(names, whole, strict=True):
            left = own - regressed(columns, own, fold)
            part = max(float(own @ own) - float(left @ left), 0.0)
            alone[signal] += part / float(residual @ residual)
    found = [s for s, part in sorted(alone.items(), key=lambda a: -a[1]) if part > DEPENDS]
    oscillates = _oscillation(bench, trial)
    depends_on = (*([oscillates] if oscillates else []), *found[:3])
    mean_square = sum(squares.values()) / count
    late, brief = _at_moments(bench, bench.errors_for(trial), fitted)
    if late or brief:  # what tolerances do at reversals has no weight in the fit
        rigs = rigs_with_tolerances(bench, trial, tolerated, folds.run)
        late, brief = _at_moments(bench, bench.meshed, rigs)
    return Remainder(
        mean_square=mean_square,
        explained=explained,
        depends_on=depends_on,
        reducible=reducible,
        structure=structure,
        slow=slow,
        shares=shares,
        late=late,
        brief=brief,
        oscillates=oscillates,
    )


def _is_brief(errors: Floats) -> bool:
    """Return whether what a run's errors exceed the noise by comes at a few moments.

    Noise is as large at any time, and seldom far beyond its own standard deviation.
    """
    sd = float(np.median(np.abs(errors - np.median(errors)))) / UPPER_QUARTILE
    if sd == 0.0:  # most errors are the same, as of a coarse channel
        return False
    size = np.minimum(np.abs(errors) / sd, FARTHEST)
    beyond = np.where(size > FAR, size, 0.0) ** 2
    brief = np.count_nonzero(beyond) >= FEWEST_FAR and float(np.mean(beyond)) > BRIEF
    return bool(brief) and float(np.mean(errors**2)) > 1.0 + LEAST_SLOW


def _at_moments(
    bench: Bench, errors: Sequence[RunErrors], rigs: Sequence[Rig]
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the channels whose strokes lag or lead, and those with errors at a few moments."""
    pairs = list(zip(errors, rigs, strict=True))
    delays, parts = [run.delays(rig) for run, rig in pairs], [run.errors(rig) for run, rig in pairs]
    late, brief = [], []
    for name in bench.channels:
        if _is_late(np.concatenate([run[name] for run in delays if name in run])):
            late.append(name)
        if any(_is_brief(run[name]) for run in parts if name in run):
            brief.append(name)
    return tuple(late), tuple(brief)


def _is_late(delays: Floats) -> bool:
    """Return whether strokes with these delays lag behind the model, or lead it, on average."""
    if delays.size < FEWEST_STROKES:
        return False
    scatter = float(delays.std(ddof=1)) / math.sqrt(delays.size)
    return abs(float(delays.mean())) > max(LATE, LATE_CRITICAL * scatter)


def _memory_s(bench: Bench, name: str, errors: list[Floats]) -> float:
    """Return the time in which the autocorrelation of a channel's slow errors falls to 1/e [s]."""
    times = []
    recorded = [run for run in bench.closed if name in run.samples]
    for run, part in zip(recorded, errors, strict=True):
        centred = part - part.mean()
        power = np.abs(np.fft.rfft(centred, 2 * part.size)) ** 2
        covariance = np.fft.irfft(power)[1 : part.size]
        lost = np.flatnonzero(covariance < covariance[0] / math.e)
        step_s = float(np.median(np.diff(run.run.time_s[run.samples[name]])))
        times.append(step_s * (1 + (int(lost[0]) if lost.size else covariance.size)))
    return float(np.median(times))


def _by_block(residual: Floats, folds: Folds, here: npt.NDArray[np.bool_]) -> Floats:
    squares = np.bincount(folds.block[here], residual**2, minlength=folds.blocks)
    return squares.astype(np.float64)


def hats(signal: Floats, direction: Floats) -> Floats:
    """Return linear interpolation weights of a signal, for both directions, shape (n, p)."""
    knots = np.unique(np.quantile(signal, np.linspace(0.0, 1.0, HATS)))
    if knots.size < 2:
        return np.zeros((signal.size, 0))
    weights = np.array([np.interp(signal, knots, row) for row in np.eye(knots.size)]).T
    pulling = (direction > 0.0)[:, None]
    return np.hstack((weights * pulling, weights * ~pulling))


def regressed(columns: Floats, residual: Floats, fold: npt.NDArray[np.int64]) -> Floats:
    """Return the ridge regression's prediction in each fold, fitted to all others, shape (n,)."""
    out = np.zeros(residual.size)
    gram, score = columns.T @ columns, columns.T @ residual
    ridge = RIDGE * np.eye(columns.shape[1])
    for number in np.unique(fold):
        here = fold == number
        own = columns[here]
        rest = gram - own.T @ own + ridge
        out[here] = own @ np.linalg.solve(rest, score - own.T @ residual[here])
    return out


def _oscillation(bench: Bench, trial: HypothesisFit) -> str | None:
    """Return a phrase on a dominant frequency of the residuals of most runs, or None."""
    found = []
    for k, run in enumerate(bench.errors_for(trial)):
        strokes = run.run.conditioned[run.run.drive_column].reversals.size - 1
        for name, errors in run.errors(bench.rig(trial, k)).items():
            time_s = run.run.time_s[run.samples[name]]
            even = np.linspace(time_s[0], time_s[-1], errors.size)
            power = np.abs(np.fft.rfft(np.interp(even, time_s, errors - errors.mean()))) ** 2
            peak = int(np.argmax(power))
            band = power[max(peak - 1, 0) : peak + 2].sum() / power.sum()
            if band > PEAK and peak > OWN * 0.5 * strokes:
                found.append((name, peak / (even[-1] - even[0])))
    if len(found) < max(2, len(bench.rigs) // 2):
        return None
    frequency = float(np.median([f for _, f in found]))
    names = sorted({name for name, _ in found})
    verb = "oscillates" if len(names) == 1 else "oscillate"
    return f"time_s ({listed(names)} {verb} at {frequency:.3g} Hz)"
