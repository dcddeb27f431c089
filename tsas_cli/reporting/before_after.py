"""The first picture: measured and both models in the run and the channels with the largest gain."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from tsas_cli.identification.prepared import CHANNELS
from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.recordings.recording import Recording
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.content import Picture
from tsas_cli.reporting.drawing import kept_samples, legend, noise_bounds, picture, stacked
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.names import X_IN, in_words, quantity_of
from tsas_cli.reporting.numbers import plain
from tsas_cli.reporting.simulation import channels_of, rms
from tsas_cli.reporting.sources import diagnosed_models
from tsas_cli.support.arrays import Floats, Indices

_FEWEST = 10  # samples that make a picture
_MATTERS = 1.0  # noise levels by which the residual of a second channel falls, to be shown
_CYCLES = 3  # of a longer recording those with the largest gain
_NEAR = 0.25  # of the largest gain, down to which it is shown enlarged
Box = tuple[float, float, float, float]  # x from and to, y from and to
_POINTS = 3000  # of each curve
_VISIBLE = 0.01  # residual over the channel's range, to show in its whole loop


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
    def residuals(self) -> list[Floats]:
        """The residual of each model, shape (n,) each."""
        return [self.measured - values for _, _, values in self.models]

    @property
    def gain(self) -> float:
        """By how many noise levels the residual falls; with one model how many it has."""
        sizes = [rms(residual) / self.noise for residual in self.residuals]
        return sizes[0] - (sizes[1] if len(sizes) > 1 else 0.0)

    def gains(self) -> Floats:
        """Return by how much the residual's size falls at each sample, smoothed, shape (n,)."""
        sizes = [np.abs(residual) for residual in self.residuals]
        fall = sizes[0] - (sizes[1] if len(sizes) > 1 else 0.0)
        width = max(fall.size // 200, 3)
        return np.convolve(fall, np.full(width, 1.0 / width), mode="same")

    def part(self, start_s: float, end_s: float) -> "ShownFit":
        """Return the samples between two times [s]."""
        at = slice(*np.searchsorted(self.time_s, (start_s, end_s)))
        models = tuple((label, role, values[at]) for label, role, values in self.models)
        cut = self.time_s[at], self.x[at], self.driven[at], self.measured[at]
        return ShownFit(self.run, self.channel, self.noise, *cut, models)


def pictures(inputs: Inputs) -> tuple[Picture, ...]:
    """Return the loop and its enlargement, or a second channel's; none without a diagnosis.

    InputError: a recording or what the diagnosis has written of it cannot be read.
    """
    found = best_fits(inputs)
    if found is None:
        return ()
    first, second = found
    if second is not None:
        seen_in_loop = _VISIBLE * float(np.ptp(second.measured))
        if rms(second.residuals[0]) > seen_in_loop:
            return _picture(first, first), _picture(second, second)
    window = near(first)
    return _picture(first, first, mark=window), _picture(first, second, window=window)


def _picture(
    loop: ShownFit, below: ShownFit | None, *, mark: Box | None = None, window: Box | None = None
) -> Picture:
    loops = f"Run {loop.run}, {quantity_of(loop.channel)} over x_in"
    if window:
        loops += (
            f", enlarged where the {'models differ' if loop.models[1:] else 'residual is'} most"
        )
    under = "" if below is None else f" Below: residual of {quantity_of(below.channel)} over time."
    fit = below or loop
    sizes = ", ".join(f"{label} {plain(rms(fit.measured - v), 3)}" for label, _, v in fit.models)
    noise = f"noise level {plain(fit.noise, 3)} {BY_NAME[fit.channel].unit}"
    errors = f"RMS: {sizes}, {noise} (dashed: twice that)."
    channels = dict.fromkeys(fit.channel for fit in (loop, below) if fit is not None)
    words = "; ".join(f"{quantity_of(name)} is the {in_words(name)}" for name in channels)
    return picture(
        partial(draw_before_after, loop=loop, below=below, mark=mark, window=window),
        key=f"first-{loop.channel}-{'near' if window else 'whole'}",
        alt=f"{loops}, measured and simulated.{under} {errors} Here {words}.",
        caption=f"{loops}.{under} {errors}",
        height_in=4.4,
        every_point=True,
    )


def draw_before_after(
    figure: Any, *, loop: ShownFit, below: ShownFit | None, mark: Box | None, window: Box | None
) -> None:
    """Draw a loop over x_in, or the `window` of it, and a channel's residuals over time below.

    `mark` is framed in the loop.
    """
    heights = (1,) if below is None else (3, 2)
    rows = stacked(figure, len(heights), height_ratios=heights)
    draw_loop(rows[0], loop, mark=mark, window=window)
    if below is not None:
        draw_residuals(rows[1], below)
    legend(figure, rows[0], ncols=3)


def draw_loop(
    axes: Any, fit: ShownFit, *, mark: Box | None = None, window: Box | None = None
) -> None:
    """Draw the loop as measured and by each model, the whole or a `window` of it."""
    curves = [("measured", "measured", fit.x, fit.measured)]
    curves += [(label, role, fit.driven, values) for label, role, values in fit.models]
    kept = _kept(fit) if window is None else _inside(fit, window)
    steps = np.diff(kept, prepend=kept[:1])  # where evenly chosen samples go on after a gap
    gaps = False if window is None else steps > 2 * np.median(steps)
    for label, role, x, values in curves:
        width = 3.0 if role == "measured" else 1.3
        style = {"color": STAND_IN[role], "linewidth": width, "label": label}
        axes.plot(x[kept], np.where(gaps, np.nan, values[kept]), **style)
    axes.set(xlabel="x_in [mm]", ylabel=f"{quantity_of(fit.channel)} [{BY_NAME[fit.channel].unit}]")
    if window is not None:
        axes.set(xlim=window[:2], ylim=window[2:])
    if mark is not None:
        left, right, bottom, top = mark
        corners = [left, right, right, left, left], [bottom, bottom, top, top, bottom]
        axes.plot(*corners, color=STAND_IN["ink"], linewidth=0.8)


def draw_residuals(axes: Any, fit: ShownFit) -> None:
    """Draw the residual of each model over time, between bounds of twice the noise level."""
    kept = _kept(fit)
    for (_, role, _), residual in zip(fit.models, fit.residuals, strict=True):
        axes.plot(fit.time_s[kept], residual[kept], color=STAND_IN[role], linewidth=0.9)
    noise_bounds(axes, fit.noise)
    unit = BY_NAME[fit.channel].unit
    axes.set_xlabel("time [s]")
    axes.set_ylabel(f"residual {quantity_of(fit.channel)} [{unit}]", fontsize=9)


def _kept(fit: ShownFit) -> Indices:
    return kept_samples(fit.x, fit.measured, *fit.residuals, points=_POINTS)


def _inside(fit: ShownFit, window: Box) -> Indices:
    """Return the samples in and near a window; its curves are cut at its edges."""
    left, right, bottom, top = window
    wide, high = right - left, top - bottom
    inside = (np.abs(fit.x - 0.5 * (left + right)) < wide) & (
        np.abs(fit.measured - 0.5 * (bottom + top)) < high
    )
    at = np.flatnonzero(inside)
    return at[:: max(math.ceil(at.size / _POINTS), 1)]


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
    driven = models[0].driven(recording) if models else None
    if x is None or driven is None:
        return
    for it in channels_of(inputs, recording, models):
        series = [it.time_s, x, driven, it.measured, *it.by_model.values()]
        finite = np.isfinite(np.sum(series, axis=0))
        if it.noise is None or it.by_model.keys() < set(models):
            continue
        if np.count_nonzero(finite) > _FEWEST:
            time_s, x_in, x_driven, measured, *predicted = (one[finite] for one in series)
            named = tuple((m.label, m.role, v) for m, v in zip(models, predicted, strict=True))
            kept = time_s, x_in, x_driven, measured
            yield ShownFit(it.run, it.channel, it.noise, *kept, named)


def _cycles(fit: ShownFit) -> tuple[float, float]:
    """Return start and end of the cycles with the largest gain [s]; infinite takes all."""
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
    ends = []
    for values in (fit.x[span], curves):
        room = 0.08 * float(np.ptp(values)) or 1.0
        ends += [float(values.min()) - room, float(values.max()) + room]
    left, right, bottom, top = ends
    return left, right, bottom, top
