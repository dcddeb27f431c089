"""Samples are missing: rows that were not recorded, or cells that are empty.

An interval is a gap if it exceeds 1.5 times the median and the scatter of the others. Gaps are
never filled; each stage leaves them out.
"""

from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.columns import TIME
from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.support.arrays import Mask
from tsas_cli.support.wording import count_of

_COMMON = 0.05  # share of long intervals from which on they are jitter
_REMEDY = "look for lost samples at the source; the stages leave the gap out"


def find(trial: RunSignals) -> Iterator[Remark | CannotTell]:
    """Yield the missing rows, then the empty cells of each column."""
    if trial.batches is not None:
        yield CannotTell("rows come in batches, so missing rows cannot be seen")
    elif trial.increases:
        yield from _missing_rows(trial)
    else:
        yield CannotTell("time does not increase, so missing rows cannot be seen")
    for name, values in trial.recording.columns.items():
        empty = ~np.isfinite(values)
        if name != TIME and empty.any():
            yield _empty_cells(trial, name, empty)


def _missing_rows(trial: RunSignals) -> Iterator[Remark]:
    interval = np.diff(trial.time_s)
    median = float(np.median(interval))
    scatter = 1.4826 * float(np.median(np.abs(interval - median)))
    gaps = np.flatnonzero(interval > max(1.5 * median, median + 8.0 * scatter))
    if 0 < gaps.size < _COMMON * interval.size:
        longest = gaps[np.argmax(interval[gaps])]
        yield Remark(
            "warning",
            f"rows are missing at {count_of(gaps.size, 'place')}; the longest gap is "
            f"{interval[longest]:.4g} s at {trial.time_s[longest]:.6g} s "
            f"(the sample interval is {1e3 * median:.4g} ms)",
            _REMEDY,
            TIME,
            float(trial.time_s[gaps[0]]),
        )


def _empty_cells(trial: RunSignals, name: str, empty: Mask) -> Remark:
    if empty.all() and (trial.overall is None or name not in trial.overall):
        return Remark("error", f"{name} holds no value at all", "leave the column out", name)
    edges = np.flatnonzero(np.diff(np.concatenate(([False], empty, [False])).astype(np.int8)))
    starts, lengths = edges[::2], edges[1::2] - edges[::2]
    longest = int(np.argmax(lengths))
    return Remark(
        "warning",
        f"{name} is empty in {int(empty.sum())} of {empty.size} rows, at "
        f"{count_of(starts.size, 'place')}; the longest has {lengths[longest]} rows "
        f"at {trial.time_s[starts[longest]]:.6g} s",
        _REMEDY,
        name,
        float(trial.time_s[starts[0]]),
    )


CHECK = QualityCheck("gap", find)
