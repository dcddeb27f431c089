"""A channel that swings at one frequency in all runs, whatever the motion is."""

from collections.abc import Iterator, Sequence

import numpy as np

from tsas_cli.diagnosis.faults.shapes import ReadRun
from tsas_cli.support.arrays import Floats

MOTIONS_OWN = 2.5  # multiple of the fastest motion's frequency, below which it may be the motion's
PER_RESOLUTION = 4  # frequencies that are tried in the resolution of a run


def swings(
    reads: Sequence[ReadRun], names: Sequence[str]
) -> Iterator[tuple[str, float, list[Floats]]]:
    """Yield each channel with the frequency [Hz] that most of its errors swing at, and columns.

    The columns are what the residuals of each run change by with the channel's sine and cosine,
    shape (r, 2). Frequencies are tried up to half the sampling rate.
    """
    lengths = [float(read.time_s[-1]) for read in reads]
    fastest = max(
        0.5 * (read.errors.run.conditioned[read.errors.run.drive_column].reversals.size - 1) / s
        for read, s in zip(reads, lengths, strict=True)
    )
    weighted = [read.errors.weighted(read.predicted) for read in reads]
    for name in names:
        parts = [
            (read.time_s[read.errors.samples[name]], own[name])
            for read, own in zip(reads, weighted, strict=True)
        ]
        step_s = max(float(np.median(np.diff(time_s))) for time_s, _ in parts)
        count = round(PER_RESOLUTION * max(lengths) / step_s)
        tried = np.fft.rfftfreq(count, step_s)
        faster = tried > MOTIONS_OWN * fastest
        if not faster.any():
            continue
        power = sum(_power(time_s, errors, step_s, count) for time_s, errors in parts)
        frequency = float(tried[np.argmax(power * faster)])
        columns = []
        for read in reads:
            phase = 2.0 * np.pi * frequency * read.time_s
            columns.append([read.changed(name, wave) for wave in (np.sin(phase), np.cos(phase))])
        yield name, frequency, [np.column_stack(own) for own in columns]


def _power(time_s: Floats, errors: Floats, step_s: float, count: int) -> Floats:
    """Return the squares of errors at the frequencies of `count` even samples."""
    even = np.interp(np.arange(time_s[0], time_s[-1], step_s), time_s, errors)
    return np.abs(np.fft.rfft(even, count)) ** 2
