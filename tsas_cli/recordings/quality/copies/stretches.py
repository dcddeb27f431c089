"""Stretches of samples that agree for longer than any repeat of the motion could."""

from collections.abc import Iterable

import numpy as np

from tsas_cli.recordings.quality.copies.agreement import Agreement, Floats, RunSamples
from tsas_cli.recordings.quality.copies.copy import RowSpan

LEAST_INFORMATION = 40.0  # nats: by chance at one of 10¹⁷ shifts
MOST_PER_SAMPLE = 2.5  # nats: noise may be correlated
GAP_SHARE = 0.01  # of two stretches that may differ between them if they are one
EXACT_SHARE = 0.9  # of a stretch's samples that are the source's own, not interpolated


def stretches(
    row: int, samples: RunSamples, found: Agreement, information: Floats
) -> list[tuple[RowSpan, int]]:
    """Return the stretches of agreeing consecutive samples, each with its `every` (see `Copy`).

    Parameters
    ----------
    row
        The number of the first sample.
    samples, found
        The samples, and their agreement with a source.
    information
        −ln of the probability that a repeat agrees with a changing sample [nats], shape (d,).
    """
    changed = np.zeros(samples.values.shape, dtype=np.bool_)
    changed[1:] = samples.values[1:] != samples.values[:-1]
    nats = np.minimum((found.compared & changed) @ information, MOST_PER_SAMPLE)
    edges = np.concatenate(([-1], np.flatnonzero(found.differs), [nats.size]))
    sums = np.concatenate(([0.0], np.cumsum(np.where(found.agrees, nats, 0.0))))
    out = []
    for k in np.flatnonzero(sums[edges[1:]] - sums[edges[:-1] + 1] >= LEAST_INFORMATION).tolist():
        first, end = int(edges[k]) + 1, int(edges[k + 1])
        times = samples.time_s[first], samples.time_s[end - 1]
        span = RowSpan(row + first, row + end, float(times[0]), float(times[1]))
        out.append((span, _every(found, slice(first, end))))
    return out


def _every(found: Agreement, rows: slice) -> int:
    """Return the rows of the source from one sample to the next; 0 if they are interpolated."""
    exact = found.exact[rows]
    if np.count_nonzero(exact) < EXACT_SHARE * np.count_nonzero(found.agrees[rows]):
        return 0
    return max(int(np.median(np.diff(found.at[rows][exact]))), 1)


def joined(parts: Iterable[tuple[RowSpan, int]]) -> list[tuple[RowSpan, int]]:
    """Return stretches in order, merged if only a few samples differ between them."""
    out: list[tuple[RowSpan, int]] = []
    for span, every in parts:
        before = out[-1][0] if out else None
        if before and span.first - before.end <= GAP_SHARE * (before.rows + span.rows):
            out[-1] = RowSpan(before.first, span.end, before.begin_s, span.end_s), out[-1][1]
        else:
            out.append((span, every))
    return out
