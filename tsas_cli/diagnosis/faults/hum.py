"""A channel that swings at one frequency in all runs, whatever the motion is."""

from collections.abc import Iterator

import numpy as np

from tsas_cli.diagnosis.signals import AtResiduals
from tsas_cli.identification.extension import Bench
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.support.arrays import Floats, Indices

MOTIONS_OWN = 2.5  # multiple of the fastest motion's frequency, below which it may be the motion's
PER_RESOLUTION = 4  # frequencies that are tried in the resolution of a run


def swings(
    bench: Bench, trial: HypothesisFit, at: AtResiduals, residual: Floats, run: Indices
) -> Iterator[tuple[str, float, Floats]]:
    """Yield each channel with the frequency [Hz] that most of its residual swings at, and columns.

    The columns are the sine and the cosine in each run, shape (n, 2 runs), by the mean of the
    samples of each residual; `residual` and `run` belong to those, shape (n,).
    """
    time_s = at.signals["time_s"]
    runs = [e.run for e in bench.errors_for(trial)]
    lengths = [float(np.ptp(r.time_s)) for r in runs]
    motions = [
        0.5 * (r.conditioned[r.drive_column].reversals.size - 1) / length
        for r, length in zip(runs, lengths, strict=True)
    ]
    for number, name in enumerate(bench.channels):
        parts = [np.flatnonzero((at.channel == number) & (run == k)) for k in range(len(runs))]
        parts = [part for part in parts if part.size]
        step_s = max(float(np.median(np.diff(time_s[part]))) for part in parts)
        count = round(PER_RESOLUTION * max(lengths) / step_s)
        tried = np.fft.rfftfreq(count, step_s)
        faster = tried > MOTIONS_OWN * max(motions)
        if not faster.any():
            continue
        power = sum(_power(time_s[part], residual[part], step_s, count) for part in parts)
        frequency = float(tried[np.argmax(power * faster)])
        columns = np.zeros((time_s.size, 2 * len(parts)))
        for k, part in enumerate(parts):
            phase = 2.0 * np.pi * frequency * time_s[part]
            columns[part, 2 * k : 2 * k + 2] = np.column_stack((np.sin(phase), np.cos(phase)))
        yield name, frequency, columns


def _power(time_s: Floats, residual: Floats, step_s: float, count: int) -> Floats:
    """Return the squares of a residual at the frequencies of `count` even samples."""
    even = np.interp(np.arange(time_s[0], time_s[-1], step_s), time_s, residual)
    return np.abs(np.fft.rfft(even, count)) ** 2
