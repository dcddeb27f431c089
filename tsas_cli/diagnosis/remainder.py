"""The remaining residual with the named causes: its size, its dependence, the attainable residual.

A regression on the recorded signals, each by hat functions and with separate weights for both
directions, estimates the residual that any model of these signals could attain on held-out runs. It
shows that a model lacks something, not the cause.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from tsas_cli.diagnosis.evidence import gain
from tsas_cli.diagnosis.held_out import Folds
from tsas_cli.diagnosis.signals import DIRECTION, signals_of
from tsas_cli.identification.extension import Bench, HypothesisFit
from tsas_cli.identification.samples import mean_edges

Floats = npt.NDArray[np.float64]

HATS = 10  # hat functions of each signal and direction
RIDGE = 1.0  # regularisation, in units of noise
DEPENDS = 0.02  # least share of the squares that a signal alone explains
PEAK = 0.3  # share of a run's squares in one narrow band from which the residual is periodic


@dataclass(frozen=True)
class Remainder:
    """The remaining residual of a trial.

    `mean_square` is that of the weighted residuals; `explained` the reduction of each channel's
    mean square by a regression on held-out data; `depends_on` the signals that explain most of it.
    """

    mean_square: float
    explained: dict[str, float]
    depends_on: tuple[str, ...]


def remainder(bench: Bench, trial: HypothesisFit, folds: Folds) -> Remainder:
    """Return the remaining residual of a trial."""
    errors = np.concatenate(
        [
            np.concatenate(list(e.errors(bench.rig(trial, k)).values()))
            for k, e in enumerate(bench.errors_for(trial))
        ]
    )
    signals, channel = _signals(bench, trial)
    residual = trial.solution.residual
    names = [name for name in signals if name != DIRECTION]
    alone: dict[str, float] = {}
    samples = {
        name: sum(run.samples[name].size for run in bench.closed if name in run.samples)
        for name in bench.channels
    }
    explained: dict[str, float] = {}
    for number, name in enumerate(bench.channels):
        here = channel == number
        before = _by_block(residual[here], folds, here)
        used = before > 0.0
        whole = [hats(signals[s][here], signals[DIRECTION][here]) for s in names]
        remaining = residual[here] - regressed(np.hstack(whole), residual[here], folds.fold[here])
        after = _by_block(remaining, folds, here)
        best = gain(before[used], after[used])
        # Each residual is a mean of samples, scaled to unit variance.
        of_mean = float(np.mean(residual[here] ** 2)) * here.sum() / samples[name]
        explained[name] = max(best.part, 0.0) * of_mean if best.convincing else 0.0
        for signal, columns in zip(names, whole, strict=True):
            own = residual[here] - regressed(columns, residual[here], folds.fold[here])
            part = 1.0 - float(own @ own) / float(residual[here] @ residual[here])
            share = float(residual[here] @ residual[here]) / float(residual @ residual)
            alone[signal] = alone.get(signal, 0.0) + max(part, 0.0) * share
    found = [s for s, part in sorted(alone.items(), key=lambda a: -a[1]) if part > DEPENDS]
    periodic = _periodic(bench, trial)
    return Remainder(
        float(np.mean(errors**2)), explained, tuple(([periodic] if periodic else []) + found[:3])
    )


def _by_block(residual: Floats, folds: Folds, here: npt.NDArray[np.bool_]) -> Floats:
    squares = np.bincount(folds.block[here], residual**2, minlength=folds.blocks)
    return squares.astype(np.float64)


def _signals(bench: Bench, trial: HypothesisFit) -> tuple[dict[str, Floats], Floats]:
    """Return all signals, and the number of the channel, at each residual, shape (n,)."""
    out: dict[str, list[Floats]] = {}
    channel = []
    for k, run in enumerate(bench.errors_for(trial)):
        predicted = run.predict(bench.rig(trial, k))
        signals = signals_of(run.run, predicted["f_in_N"])
        for name, at in run.samples.items():
            edges = mean_edges(at.size)
            middle = at[np.minimum(edges + (edges[1] - edges[0]) // 2, at.size - 1)]
            channel.append(np.full(edges.size, bench.channels.index(name)))
            for signal, values in signals.items():
                out.setdefault(signal, []).append(values[middle])
    return {name: np.concatenate(v) for name, v in out.items()}, np.concatenate(channel)


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


def _periodic(bench: Bench, trial: HypothesisFit) -> str | None:
    """Return a phrase on a dominant frequency of the residuals of most runs, or None."""
    found = []
    for k, run in enumerate(bench.errors_for(trial)):
        for name, errors in run.errors(bench.rig(trial, k)).items():
            time_s = run.run.time_s[run.samples[name]]
            even = np.linspace(time_s[0], time_s[-1], errors.size)
            power = np.abs(np.fft.rfft(np.interp(even, time_s, errors - errors.mean()))) ** 2
            peak = int(np.argmax(power))
            band = power[max(peak - 1, 0) : peak + 2].sum() / power.sum()
            if band > PEAK:
                found.append((name, peak / (even[-1] - even[0])))
    if len(found) < max(2, len(bench.rigs) // 2):
        return None
    frequency = float(np.median([f for _, f in found]))
    names = " and ".join(sorted({name for name, _ in found}))
    return f"time_s ({names} oscillates at {frequency:.3g} Hz)"
