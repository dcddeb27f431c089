"""The first picture: measured, nominal and extended model where the gain is largest."""

import math
from functools import partial
from typing import Any

import numpy as np

from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.reporting.channels import in_words
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.content import Picture
from tsas_cli.reporting.decimation import kept_samples
from tsas_cli.reporting.drawing import picture
from tsas_cli.reporting.figures import legend, noise_bounds
from tsas_cli.reporting.fits import Box, ShownFit, best_fits, near
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.numbers import plain
from tsas_cli.reporting.simulated import rms
from tsas_cli.support.arrays import Indices, Mask

_POINTS = 3000  # of each curve
_VISIBLE = 0.01  # residual over the channel's range, to show in its whole loop


def pictures(inputs: Inputs) -> tuple[Picture, ...]:
    """Return the loop and its enlargement, or a second channel's; none without a diagnosis.

    InputError: a recording or what the diagnosis has written of it cannot be read.
    """
    found = best_fits(inputs)
    if found is None:
        return ()
    first, second = found
    if second is not None and _stands_out(second):
        return _picture(first, first), _picture(second, second)
    window = near(first)
    return _picture(first, first, mark=window), _picture(first, second, window=window)


def _stands_out(fit: ShownFit) -> bool:
    """Return whether the nominal model's residual can be seen in the whole loop."""
    residual = rms(fit.measured - fit.models[0][2])
    return residual > _VISIBLE * float(np.ptp(fit.measured))


def _picture(
    loop: ShownFit, below: ShownFit | None, *, mark: Box | None = None, window: Box | None = None
) -> Picture:
    loops = f"Run {loop.run}, {_short(loop.channel)} over x_in"
    if window:
        loops += (
            f", enlarged where the {'models differ' if loop.models[1:] else 'residual is'} most"
        )
    under = "" if below is None else f" Below: residual of {_short(below.channel)} over time."
    said = _in_words(below or loop)
    channels = dict.fromkeys(fit.channel for fit in (loop, below) if fit is not None)
    words = "; ".join(f"{_short(name)} is the {in_words(name)}" for name in channels)
    return picture(
        partial(draw_before_after, loop=loop, below=below, mark=mark, window=window),
        key=f"first-{loop.channel}-{'near' if window else 'whole'}",
        alt=f"{loops}, measured and simulated.{under} {said} Here {words}.",
        caption=f"{loops}.{under} {said}",
        height_in=4.4,
        every_point=True,
    )


def _short(channel: str) -> str:
    return channel.rsplit("_", 1)[0]


def _in_words(fit: ShownFit) -> str:
    unit = BY_NAME[fit.channel].unit
    sizes = ", ".join(f"{label} {plain(rms(fit.measured - v), 3)}" for label, _, v in fit.models)
    return f"RMS: {sizes}, noise level {plain(fit.noise, 3)} {unit} (dashed: twice that)."


def draw_before_after(
    figure: Any, *, loop: ShownFit, below: ShownFit | None, mark: Box | None, window: Box | None
) -> None:
    """Draw a loop over x_in, or the `window` of it, and a channel's residuals over time below.

    `mark` is framed in the loop.
    """
    heights = (1,) if below is None else (3, 2)
    rows = figure.subplots(len(heights), 1, squeeze=False, height_ratios=heights)[:, 0]
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
    gaps = False if window is None else _breaks(kept)
    for label, role, x, values in curves:
        width = 3.0 if role == "measured" else 1.3
        style = {"color": STAND_IN[role], "linewidth": width, "label": label}
        axes.plot(x[kept], np.where(gaps, np.nan, values[kept]), **style)
    axes.set(xlabel="x_in [mm]", ylabel=f"{_short(fit.channel)} [{BY_NAME[fit.channel].unit}]")
    if window is not None:
        axes.set(xlim=window[:2], ylim=window[2:])
    if mark is not None:
        left, right, bottom, top = mark
        corners = [left, right, right, left, left], [bottom, bottom, top, top, bottom]
        axes.plot(*corners, color=STAND_IN["ink"], linewidth=0.8)


def draw_residuals(axes: Any, fit: ShownFit) -> None:
    """Draw the residual of each model over time, between bounds of twice the noise level."""
    kept = _kept(fit)
    for _, role, values in fit.models:
        residual = (fit.measured - values)[kept]
        axes.plot(fit.time_s[kept], residual, color=STAND_IN[role], linewidth=0.9)
    noise_bounds(axes, fit.noise)
    unit = BY_NAME[fit.channel].unit
    axes.set_xlabel("time [s]")
    axes.set_ylabel(f"residual {_short(fit.channel)} [{unit}]", fontsize=9)


def _kept(fit: ShownFit) -> Indices:
    residuals = [fit.measured - values for _, _, values in fit.models]
    return kept_samples(fit.x, fit.measured, *residuals, points=_POINTS)


def _inside(fit: ShownFit, window: Box) -> Indices:
    """Return the samples in and near a window; its curves are cut at its edges."""
    left, right, bottom, top = window
    wide, high = right - left, top - bottom
    inside = (np.abs(fit.x - 0.5 * (left + right)) < wide) & (
        np.abs(fit.measured - 0.5 * (bottom + top)) < high
    )
    at = np.flatnonzero(inside)
    return at[:: max(math.ceil(at.size / _POINTS), 1)]


def _breaks(kept: Indices) -> Mask:
    """Return where a curve of evenly chosen samples, shape (n,), goes on after a gap."""
    steps = np.diff(kept, prepend=kept[:1])
    return np.asarray(steps > 2 * np.median(steps))
