"""The check for a tendon, or a drive, that sticks and slips."""

from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from tsas_cli.numerics.turning_points import turning_points
from tsas_cli.recordings.quality.finding import Findings, warning
from tsas_cli.recordings.quality.trial import FEWEST, RunSignals
from tsas_cli.support.arrays import Floats

_STROKES, _IN_A_STROKE = 2, 3  # strokes with so many drops, at least
_LARGER = 1.4  # than the largest rise in as short a time: 0.8 to 1.2 where real drives are unsteady


class _Drop(NamedTuple):
    """A fall of the force against the motion of the drive, and the most that it rises as fast."""

    at_s: float
    size_N: float
    lasts_s: float
    rise_N: float


def stick_slip(trial: RunSignals) -> Findings:
    """The force at the drive drops again and again while the drive goes on one way.

    The tendon or the drive sticks, is wound up, and slips. Reported where several strokes have
    several drops beyond the noise, larger than what the force rises by in as short a time before
    each. Noise, a ripple, a load that swings or a motor that hunts rises as steeply as it falls.
    """
    by_stroke = list(_drops(trial))
    drops = [drop for of_stroke in by_stroke for drop in of_stroke]
    if sum(len(of_stroke) >= _IN_A_STROKE for of_stroke in by_stroke) < _STROKES:
        return
    size_N, lasts_s, rise_N = np.median([drop[1:] for drop in drops], axis=0)
    if size_N > _LARGER * rise_N:
        yield warning(
            "f_in_N",
            f"f_in_N drops {len(drops)} times while the drive goes on one way, by "
            f"{size_N:.2g} N within {lasts_s:.2g} s: the tendon or the drive sticks and slips",
            "move faster, stiffen the drive or lubricate; no model here jumps, so that what a "
            "diagnosis says of friction over the speed is a mean",
            drops[0].at_s,
        )


def _drops(trial: RunSignals) -> Iterator[list[_Drop]]:
    """Yield the drops of the force in each stroke of the drive, the small strokes too."""
    x_in, f_in = trial.channels["x_in_mm"], trial.channels["f_in_N"]
    valid = np.flatnonzero(np.isfinite(x_in) & np.isfinite(f_in))
    far, visible = trial.visible("x_in_mm"), trial.visible("f_in_N")
    for start, end in pairwise(turning_points(x_in[valid], far)):
        rows = valid[start : end + 1]
        direction = np.sign(x_in[rows[-1]] - x_in[rows[0]])
        if rows.size < FEWEST:
            continue
        x, f, t = direction * x_in[rows], direction * f_in[rows], trial.time_s[rows]
        extremes = turning_points(f, visible)
        yield [
            _Drop(t[b], f[b] - f[c], t[c] - t[b], _most_risen(f[a : b + 1], c - b))
            for a, b, c in zip(extremes, extremes[1:], extremes[2:], strict=False)
            if f[b] > f[a] and x[c] - x[a] >= far
        ]


def _most_risen(values: Floats, within: int) -> float:
    """Return the largest rise over so many samples, or over all if there are fewer."""
    lag = min(within, values.size - 1)
    return float(np.max(values[lag:] - values[:-lag]))
