"""The checks of a run's times."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from tsas_cli.numerics.noise import third_differences
from tsas_cli.recordings.columns import TIME
from tsas_cli.recordings.quality.finding import Finding, Findings, NotChecked, error, warning
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.recordings.run_files import implausible, pauses
from tsas_cli.support.arrays import Floats, Mask
from tsas_cli.support.limits import LONGEST_PAUSE, LONGEST_STEP_S, SHORTEST_STEP_S
from tsas_cli.support.wording import count_of


def time_order(trial: RunSignals) -> Findings:
    """Time stops, decreases, or increases by an implausible step.

    The clock was set, rows are duplicate, or files were joined in the wrong order; or the unit of
    time is wrong by orders of magnitude. Every other stage refuses such a run.
    """
    step = np.diff(trial.time_s)
    wrong, what = step <= 0, "does not increase"
    remedy = "correct the clock or the order of the rows at the source"
    if not wrong.any():
        wrong = implausible(step)
        what = f"increases by less than {SHORTEST_STEP_S:g} s or more than {LONGEST_STEP_S:g} s"
        remedy = "check the unit of the time"
    if not wrong.any():
        wrong, what = (
            pauses(trial.time_s),
            f"pauses {LONGEST_PAUSE:g} times as long as all the rest lasts",
        )
        remedy = "correct the clock, or split the recording there into two runs"
    if wrong.any():
        row = int(wrong.argmax()) + 1
        before, after = trial.time_s[row - 1], trial.time_s[row]
        yield error(
            "time_s",
            f"time {what} at {int(wrong.sum())} of {trial.time_s.size} rows, first at row "
            f"{trial.first_row + row} ({before:.6g} s, then {after:.6g} s)",
            f"{remedy}, then ingest again",
            float(before),
        )


def time_batches(trial: RunSignals) -> Findings:
    """Rows arrive in batches, and their times are those of the arrival.

    A computer reads a buffer of the data acquisition every few samples and stamps the rows then:
    times are near together, or equal, and jump between batches. The channels move on evenly from
    row to row, which tells batches from gaps. Wrong times are a wrong phase of every motion; the
    finding says how much that is beside the noise.
    """
    batches = trial.batches
    if batches is None:
        return
    costs = {
        name: batches.cost(values, trial.sizes[name].noise)
        for name, values in trial.mechanical.items()
    }
    worst = max(costs, key=lambda name: costs[name], default=None)
    cost = "" if worst is None else f"; the wrong times change {worst} by {costs[worst]:.2g}"
    yield error(
        "time_s",
        f"rows come in batches of {batches.rows}: their times are {1e3 * batches.within_s:.3g} ms "
        f"apart, then {1e3 * batches.between_s:.4g} ms"
        + (f"{cost} × its noise level (RMS)" if cost else ""),
        "if no sample is lost, let the rows count at ingest: time_s = { rate_Hz = "
        f"{1.0 / batches.row_s:.5g} }} in the map; record with the clock of the data acquisition",
    )


_TOLERATED = 0.05


def time_jitter(trial: RunSignals) -> Findings:
    """The sample interval scatters.

    A logger on a busy computer, or rounded time stamps. The scatter is the RMS about the usual
    interval, without gaps; it is reported above 5 %. The usual interval is the mean without the
    shortest and longest twentieth: where a logger makes late stamps increase, half are too close.
    """
    interval = np.diff(trial.time_s)
    usual = float(np.mean(np.sort(interval)[interval.size // 20 : -(interval.size // 20) or None]))
    steady = interval < 2.5 * usual
    scatter = float(np.sqrt(np.mean((interval[steady] / usual - 1.0) ** 2)))
    if scatter > _TOLERATED:
        yield warning(
            "time_s",
            f"the sample interval scatters by {100 * scatter:.3g} % about {1e3 * usual:.4g} ms "
            f"(from {1e3 * interval.min():.4g} to {1e3 * interval[steady].max():.4g} ms)",
            "record with the clock of the data acquisition instead of the computer's",
        )


_BLOCK = 16  # rows
_FEWEST_BLOCKS = 30
_MEDIAN = 0.6745  # of |noise| of unit deviation
_SLOW, _FAST = 0.3, 0.7  # quantiles of the speed
_TIMES = 2.0  # the noise of slow motion
_ALIKE = 1.5  # ratio of two times at most


def unsteady_sampling(trial: RunSignals) -> Findings:
    """The samples were taken at other times than those that are written down.

    A busy computer reads its sensors early and late, and writes even times. Each channel then has
    noise in proportion to its speed, all by the same time. Reported where the noise of two channels
    more than doubles from slow to fast motion, by times that agree.
    """
    found: dict[str, float] = {}
    for name, values in trial.noisy.items():
        scatter_s = _scatter_s(trial.time_s, values) if trial.moves(name) else None
        if scatter_s is not None:
            found[name] = scatter_s
    sizes = sorted(found.values())
    pairs = [b for a, b in pairwise(sizes) if b < _ALIKE * a]
    if pairs:
        yield error(
            None,
            f"the noise of {' and '.join(found)} grows with the speed as if the samples were "
            f"taken {1e3 * pairs[0]:.2g} ms (RMS) early or late",
            "record with the clock of the data acquisition, or write down the time of each sample",
        )


def _scatter_s(time_s: Floats, values: Floats) -> float | None:
    """Return the scatter of the times that explains a channel's noise [s]; None if none does."""
    count = (values.size - 3) // _BLOCK
    if count < _FEWEST_BLOCKS:
        return None
    third = [third_differences(values, at)[: count * _BLOCK] for at in (None, time_s)]
    noise = np.median(np.abs(third).reshape(2, count, _BLOCK), axis=2).min(axis=0) / _MEDIAN
    ends = _BLOCK * np.arange(count + 1)
    speed = np.abs(np.diff(values[ends]) / np.diff(time_s[ends]))
    slow, fast = np.quantile(speed, (_SLOW, _FAST))
    calm = float(np.median(noise[speed <= slow]))
    loud, at = float(np.median(noise[speed >= fast])), float(np.median(speed[speed >= fast]))
    if not calm > 0.0 or loud < _TIMES * calm or at == 0.0:
        return None
    return float(np.sqrt(loud**2 - calm**2) / at)


_COMMON = 0.05  # share of long intervals from which on they are jitter
_GAP_REMEDY = "look for lost samples at the source; the stages leave the gap out"


def gap(trial: RunSignals) -> Findings:
    """Samples are missing: rows that were not recorded, or cells that are empty.

    An interval is a gap if it exceeds 1.5 times the median and the scatter of the others. Gaps are
    never filled; each stage leaves them out.
    """
    if trial.batches is not None:
        yield NotChecked("rows come in batches, so missing rows cannot be seen")
    elif trial.increases:
        yield from _missing_rows(trial)
    else:
        yield NotChecked("time does not increase, so missing rows cannot be seen")
    for name, values in trial.recording.columns.items():
        empty = ~np.isfinite(values)
        if name != TIME and empty.any():
            yield _empty_cells(trial, name, empty)


def _missing_rows(trial: RunSignals) -> Iterator[Finding]:
    interval = np.diff(trial.time_s)
    median = float(np.median(interval))
    scatter = 1.4826 * float(np.median(np.abs(interval - median)))
    gaps = np.flatnonzero(interval > max(1.5 * median, median + 8.0 * scatter))
    if 0 < gaps.size < _COMMON * interval.size:
        longest = gaps[np.argmax(interval[gaps])]
        yield warning(
            TIME,
            f"rows are missing at {count_of(gaps.size, 'place')}; the longest gap is "
            f"{interval[longest]:.4g} s at {trial.time_s[longest]:.6g} s "
            f"(the sample interval is {1e3 * median:.4g} ms)",
            _GAP_REMEDY,
            float(trial.time_s[gaps[0]]),
        )


def _empty_cells(trial: RunSignals, name: str, empty: Mask) -> Finding:
    if empty.all() and (trial.overall is None or name not in trial.overall):
        return error(name, f"{name} holds no value at all", "leave the column out")
    edges = np.flatnonzero(np.diff(np.concatenate(([False], empty, [False])).astype(np.int8)))
    starts, lengths = edges[::2], edges[1::2] - edges[::2]
    longest = int(np.argmax(lengths))
    return warning(
        name,
        f"{name} is empty in {int(empty.sum())} of {empty.size} rows, at "
        f"{count_of(starts.size, 'place')}; the longest has {lengths[longest]} rows "
        f"at {trial.time_s[starts[longest]]:.6g} s",
        _GAP_REMEDY,
        float(trial.time_s[starts[0]]),
    )
