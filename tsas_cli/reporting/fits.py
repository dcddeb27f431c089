"""The run and the channels with the largest gain of a diagnosis, and where in the loop it is."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from tsas_cli.identification.prepared import CHANNELS
from tsas_cli.recordings.recording import Recording
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.simulated import X_IN, diagnosed_models, rms
from tsas_cli.support.arrays import Floats

_FEWEST = 10  # samples that make a picture
_MATTERS = 1.0  # noise levels by which the residual of a second channel falls, to be shown
_CYCLES = 3  # of a longer recording those with the largest gain
_NEAR = 0.25  # of the largest gain, down to which it is shown enlarged

Box = tuple[float, float, float, float]  # x from and to, y from and to


@dataclass(frozen=True, eq=False)
class ShownFit:
    """One channel of one run, measured and by each model (label, role, values), shape (n,) each.

    `x` is x_in as measured, `driven` as it drives the models [mm].
    """

    run: str
    channel: str
    noise: float
    time_s: Floats
    x: Floats
    driven: Floats
    measured: Floats
    models: tuple[tuple[str, str, Floats], ...]

    @property
    def gain(self) -> float:
        """By how many noise levels the residual falls; with one model how many it has."""
        sizes = [rms(self.measured - values) / self.noise for _, _, values in self.models]
        return sizes[0] - (sizes[1] if len(sizes) > 1 else 0.0)

    def gains(self) -> Floats:
        """Return by how much the residual's size falls at each sample, smoothed, shape (n,)."""
        sizes = [np.abs(self.measured - values) for _, _, values in self.models]
        fall = sizes[0] - (sizes[1] if len(sizes) > 1 else 0.0)
        width = max(fall.size // 200, 3)
        return np.convolve(fall, np.full(width, 1.0 / width), mode="same")

    def part(self, start_s: float, end_s: float) -> "ShownFit":
        """Return the samples between two times [s]."""
        at = slice(*np.searchsorted(self.time_s, (start_s, end_s)))
        models = tuple((label, role, values[at]) for label, role, values in self.models)
        cut = self.time_s[at], self.x[at], self.driven[at], self.measured[at]
        return ShownFit(self.run, self.channel, self.noise, *cut, models)


def best_fits(inputs: Inputs) -> tuple[ShownFit, ShownFit | None] | None:
    """Return the run's channel with the largest gain, and another one with a gain.

    f_in comes first where its gain is at least half of the largest one. None without a diagnosis.

    InputError: a recording or what the diagnosis has written of it cannot be read.
    """
    gains = {
        (fit.channel, fit.run): fit.gain
        for recording in inputs.recordings
        for fit in _fits(inputs, recording)
    }
    if not gains:
        return None
    largest = max(gains.values())
    enough = min(0.5 * largest, largest)
    channel = min((name for (name, _), gain in gains.items() if gain >= enough), key=CHANNELS.index)
    _, run = max((at for at in gains if at[0] == channel), key=lambda at: gains[at])
    (recording,) = (one for one in inputs.recordings if one.run.id == run)
    fits = {fit.channel: fit for fit in _fits(inputs, recording)}
    first = fits.pop(channel)
    shown = _cycles(first)
    others = [fit.part(*shown) for fit in fits.values() if fit.gain > _MATTERS]
    return first.part(*shown), max(others, key=lambda fit: fit.gain, default=None)


def _fits(inputs: Inputs, recording: Recording) -> Iterator[ShownFit]:
    models = diagnosed_models(inputs)
    x = recording.get(X_IN)
    driven = models[0].driven(inputs, recording) if models else None
    if x is None or driven is None:
        return
    for channel in CHANNELS:
        measured, noise = recording.get(channel), inputs.noise(channel)
        simulated = (model.predicted(inputs, recording, channel) for model in models)
        predicted = [values for values in simulated if values is not None]
        if measured is None or noise is None or len(predicted) < len(models):
            continue
        series = [recording.time_s, x, driven, measured, *predicted]
        there = np.isfinite(np.sum(series, axis=0))
        if np.count_nonzero(there) > _FEWEST:
            time_s, at, moved, felt, *values = (one[there] for one in series)
            named = tuple((m.label, m.role, v) for m, v in zip(models, values, strict=True))
            yield ShownFit(recording.run.id, channel, noise, time_s, at, moved, felt, named)


def _cycles(fit: ShownFit) -> tuple[float, float]:
    """Return from when to when the gain is largest [s]: a few cycles, all of them if few."""
    middle, reach = float(np.mean(fit.x)), 0.1 * float(np.ptp(fit.x))
    side = np.where(fit.x > middle + reach, 1, np.where(fit.x < middle - reach, -1, 0))
    known = np.flatnonzero(side)
    begins = known[1:][np.diff(side[known]) > 0]
    if begins.size <= _CYCLES + 1:
        return -math.inf, math.inf
    total = np.concatenate(([0.0], np.cumsum(fit.gains())))
    sums = total[begins[_CYCLES:]] - total[begins[:-_CYCLES]]
    first = int(np.argmax(sums))
    start_s, end_s = fit.time_s[begins[[first, first + _CYCLES]]]
    return float(start_s), float(end_s)


def near(fit: ShownFit) -> Box:
    """Return the part of the plane in which the gain is largest."""
    gains = fit.gains()
    at, n = int(np.argmax(gains)), gains.size
    low = np.flatnonzero(gains[:at] < _NEAR * gains[at])
    high = np.flatnonzero(gains[at:] < _NEAR * gains[at])
    start = int(low[-1]) if low.size else 0
    end = at + int(high[0]) if high.size else n
    more = max((end - start) // 2, n // 100)
    span = slice(max(start - more, 0), min(end + more, n))
    curves = np.array([fit.measured[span], *(values[span] for _, _, values in fit.models)])
    (left, right), (bottom, top) = (_padded(part) for part in (fit.x[span], curves))
    return left, right, bottom, top


def _padded(values: Floats) -> tuple[float, float]:
    more = 0.08 * float(np.ptp(values)) or 1.0
    return float(values.min()) - more, float(values.max()) + more
