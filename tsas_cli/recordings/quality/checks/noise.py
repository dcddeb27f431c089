"""The checks of a channel's noise: outliers, interference from the mains."""

from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.columns import largest
from tsas_cli.recordings.quality.finding import Finding, Findings, error, warning
from tsas_cli.recordings.quality.samples import NoiseSpectrum, noise_spectrum
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.support.wording import count_of

_ASIDE = 3  # neighbours on each side
_NEAR, _FAR = 3.5, 5.0  # times their usual deviation from their median
_APART = 1.5  # times as many as between these: noise with long tails has fewer
_BEYOND = 3.0  # the same, beyond the neighbours
_RARE, _OFTEN = 0.012, 0.1  # share of all samples
_PARTS, _EVERYWHERE = 20, 0.6  # of the run, and the share of them that holds some


def outlier(trial: RunSignals) -> Findings:
    """Single samples are far from the samples before and after them.

    A bit error on a line, a sentinel for a missing value, a loose plug. One outlier can dominate a
    fit by least squares. Reported are one to three consecutive samples that deviate from both
    neighbours by more than 20 times the noise, ten quantisation steps and a twentieth of the span,
    ten times steeper than the neighbouring samples; and any implausible value, which every other
    stage refuses. Many outliers are a warning: 1 to 10 % of the samples deviate from the median of
    their neighbours by more than five times the noise, in all parts of the run, and fewer by a
    little less; noise with long tails has more of those. Not reported: a lasting step, a fast
    reversal.
    """
    yield from _frequent(trial)
    for name, outlying in trial.outlying.items():
        rows = np.flatnonzero(outlying)
        if rows.size == 0:
            continue
        values = trial.recording.columns[name]
        usual = float(np.nanmedian(values))
        farthest = rows[np.argmax(np.abs(values[rows] / 2.0 - usual / 2.0))]
        plausible = abs(values[farthest]) <= largest(name)
        yield error(
            name,
            f"{name} holds {count_of(rows.size, 'sample')} far from "
            f"{'the samples before and after' if plausible else 'any plausible value'}; the "
            f"farthest is {values[farthest]:.6g} at {trial.time_s[farthest]:.6g} s, "
            f"row {trial.first_row + farthest}",
            "leave these cells empty in the file and ingest again; the stages leave the gap out",
            float(trial.time_s[rows[0]]),
        )


def _frequent(trial: RunSignals) -> Iterator[Finding]:
    """Yield the channels of which many samples deviate from the median of their neighbours."""
    for name, values in trial.noisy.items():
        window = np.lib.stride_tricks.sliding_window_view(values, 2 * _ASIDE + 1)
        means = 0.5 * (window[:, :_ASIDE] + window[:, :_ASIDE:-1])  # free of a straight motion
        deviation = window[:, _ASIDE] - np.median(means, axis=1)
        noise = 1.4826 * float(np.nanmedian(np.abs(deviation)))
        if not noise > 0.0:
            continue
        # A spike lies beyond both of its neighbours, and beyond the lines through two on each side:
        # on a slope one neighbour is above, the other below, and a corner lies on the lines.
        near = window[:, [_ASIDE - 1, _ASIDE + 1]]
        lines = 2.0 * near - window[:, [_ASIDE - 2, _ASIDE + 2]]
        beyond = window[:, [_ASIDE]] - np.hstack((near, lines))
        spike = np.maximum(beyond.min(axis=1), -beyond.max(axis=1)) > _BEYOND * noise
        size = np.where(spike, np.abs(deviation) / noise, 0.0)
        far = size > _FAR
        between = np.count_nonzero((size > _NEAR) & ~far)
        parts = [bool(part.any()) for part in np.array_split(far, _PARTS)]
        if np.count_nonzero(far) < _APART * between:
            continue
        if _RARE < float(far.mean()) < _OFTEN and np.mean(parts) > _EVERYWHERE:
            yield warning(
                name,
                f"{100.0 * far.mean():.2g} % of the samples of {name} deviate from the median of "
                f"their neighbours by more than {_FAR:g} times its noise",
                "look for bit errors and loose plugs; leave these cells empty and ingest again",
            )


_HUM_S = 2.0
_LINE_TIMES = 20.0  # the power beside the line
_BESIDE_LINE = 0.35  # of the line's frequency: how far to the sides that is taken


def hum(trial: RunSignals) -> Findings:
    """A channel oscillates at one frequency all the time, whatever the motion.

    Mains hum aliased into the band, an inverter, a fan. Reported where the noise of a channel has
    one narrow line, twenty times as strong as beside it and as strong in every part of the run.
    """
    for name, values in trial.noisy.items():
        spectrum = noise_spectrum(trial.time_s, values, _HUM_S)
        line = None if spectrum is None else _line(spectrum)
        if line is not None:
            yield warning(
                name,
                f"{name} oscillates at about {line:.2g} Hz all the time, whatever the motion",
                "look for hum, aliased perhaps, and for what runs at this frequency; shield the "
                "cable, filter before sampling",
            )


def _line(spectrum: NoiseSpectrum) -> float | None:
    """Return the frequency of a line that stands out from the noise on both of its sides [Hz]."""
    frequency, power = spectrum.frequency_Hz, spectrum.power
    at = int(np.argmax(np.where(spectrum.is_steady, power, 0.0)))
    apart = np.abs(frequency / frequency[at] - 1.0) > _BESIDE_LINE
    below = np.flatnonzero(apart & (frequency < frequency[at]))[-2:]
    above = np.flatnonzero(apart & (frequency > frequency[at]))[:4]
    if not spectrum.is_steady[at] or not below.size or not above.size:
        return None
    stands_out = power[at] > _LINE_TIMES * max(power[below].max(), power[above].max())
    return float(frequency[at]) if stands_out else None
