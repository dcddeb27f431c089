"""Single samples are far from the samples before and after them.

A bit error on a line, a sentinel for a missing value, a loose plug. One outlier can dominate a fit
by least squares. Reported are one to three consecutive samples that deviate from both neighbours by
more than 20 times the noise, ten quantisation steps and a twentieth of the span, ten times steeper
than the neighbouring samples; and any implausible value, which every other stage refuses. Many
outliers are a warning: 1 to 10 % of the samples deviate from the median of their neighbours by more
than five times the noise, in all parts of the run, and fewer by a little less; noise with long
tails has more of those. Not reported: a lasting step, a fast reversal.
"""

from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.columns import largest
from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.support.wording import count_of

_BESIDE = 3  # neighbours on each side
_NEAR, _FAR = 3.5, 5.0  # times their usual deviation from their median
_APART = 1.5  # times as many as between these: noise with long tails has fewer
_BEYOND = 3.0  # the same, beyond both neighbours
_RARE, _OFTEN = 0.012, 0.1  # share of all samples
_PARTS, _EVERYWHERE = 20, 0.6  # of the run, and the share of them that holds some


def find(trial: RunSignals) -> Iterator[Remark | CannotTell]:
    """Yield the number of outliers of each channel, and the farthest one."""
    yield from _frequent(trial)
    for name, outlying in trial.outlying.items():
        rows = np.flatnonzero(outlying)
        if rows.size == 0:
            continue
        values = trial.recording.columns[name]
        usual = float(np.nanmedian(values))
        farthest = rows[np.argmax(np.abs(values[rows] / 2.0 - usual / 2.0))]
        plausible = abs(values[farthest]) <= largest(name)
        yield Remark(
            "error",
            f"{name} holds {count_of(rows.size, 'sample')} far from "
            f"{'the samples before and after' if plausible else 'any plausible value'}; the "
            f"farthest is {values[farthest]:.6g} at {trial.time_s[farthest]:.6g} s, "
            f"row {trial.first_row + farthest}",
            "leave these cells empty in the file and ingest again; the stages leave the gap out",
            name,
            float(trial.time_s[rows[0]]),
        )


def _frequent(trial: RunSignals) -> Iterator[Remark]:
    """Yield the channels of which many samples deviate from the median of their neighbours."""
    for name, values in trial.mechanical.items():
        if not trial.is_noisy(name) or not np.isfinite(values).all():
            continue
        window = np.lib.stride_tricks.sliding_window_view(values, 2 * _BESIDE + 1)
        means = 0.5 * (window[:, :_BESIDE] + window[:, :_BESIDE:-1])  # free of a straight motion
        deviation = window[:, _BESIDE] - np.median(means, axis=1)
        noise = 1.4826 * float(np.nanmedian(np.abs(deviation)))
        if not noise > 0.0:
            continue
        # A spike lies beyond both of its neighbours; on a slope one is above, the other below.
        inner = values[_BESIDE:-_BESIDE]
        left = inner - values[_BESIDE - 1 : -_BESIDE - 1]
        right = inner - values[_BESIDE + 1 :][: inner.size]
        spike = (left * right > 0.0) & (np.fmin(np.abs(left), np.abs(right)) > _BEYOND * noise)
        size = np.where(spike, np.abs(deviation) / noise, 0.0)
        far = size > _FAR
        between = np.count_nonzero((size > _NEAR) & ~far)
        parts = [bool(part.any()) for part in np.array_split(far, _PARTS)]
        if np.count_nonzero(far) < _APART * between:
            continue
        if _RARE < float(far.mean()) < _OFTEN and np.mean(parts) > _EVERYWHERE:
            yield Remark(
                "warning",
                f"{100.0 * far.mean():.2g} % of the samples of {name} deviate from the median of "
                f"their neighbours by more than {_FAR:g} times its noise",
                "look for bit errors and loose plugs; leave these cells empty and ingest again",
                name,
            )


CHECK = QualityCheck("outlier", find)
