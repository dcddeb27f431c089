"""Stretches of samples that agree for longer than any repeat of the motion would."""

from collections.abc import Iterable

import numpy as np

from tsas_cli.recordings.quality.copies.agreement import Agreement, Floats, Samples
from tsas_cli.recordings.quality.copies.copy import Span

NEWS = 40.0  # nats: by chance in one of 10¹⁷ places
MOST_OF_A_SAMPLE = 2.5  # of them: noise may have a memory
BETWEEN = 0.01  # of two stretches, that may differ between them for them to be one
MOSTLY = 0.9  # of a stretch's samples, that have to be the other's to be taken for every k-th


def stretches(row: int, samples: Samples, found: Agreement, news: Floats) -> list[tuple[Span, int]]:
    """Return the stretches in which consecutive samples agree, and how many steps each one makes.

    Parameters
    ----------
    row
        The number of the first sample.
    samples, found
        The samples, and how they lie on a source.
    news
        How unlikely it is that a repeat meets a sample of each channel that changes [nats], (d,).
    """
    changed = np.zeros(samples.values.shape, dtype=np.bool_)
    changed[1:] = samples.values[1:] != samples.values[:-1]
    told = np.minimum((found.compared & changed) @ news, MOST_OF_A_SAMPLE)
    edges = np.concatenate(([-1], np.flatnonzero(found.differs), [told.size]))
    sums = np.concatenate(([0.0], np.cumsum(np.where(found.agrees, told, 0.0))))
    out = []
    for k in np.flatnonzero(sums[edges[1:]] - sums[edges[:-1] + 1] >= NEWS).tolist():
        first, end = int(edges[k]) + 1, int(edges[k + 1])
        times = samples.time_s[first], samples.time_s[end - 1]
        span = Span(row + first, row + end, float(times[0]), float(times[1]))
        out.append((span, _every(found, slice(first, end))))
    return out


def _every(found: Agreement, rows: slice) -> int:
    """Return how many of the source's samples lie from one to the next, 0 where they are others."""
    exact = found.exact[rows]
    if np.count_nonzero(exact) < MOSTLY * np.count_nonzero(found.agrees[rows]):
        return 0
    return max(int(np.median(np.diff(found.at[rows][exact]))), 1)


def joined(parts: Iterable[tuple[Span, int]]) -> list[tuple[Span, int]]:
    """Return stretches in order, those as one between which a few single samples differ."""
    out: list[tuple[Span, int]] = []
    for span, every in parts:
        before = out[-1][0] if out else None
        if before and span.first - before.end <= BETWEEN * (before.rows + span.rows):
            out[-1] = Span(before.first, span.end, before.begin_s, span.end_s), out[-1][1]
        else:
            out.append((span, every))
    return out
