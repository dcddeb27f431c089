"""Rows that arrive in batches, and clocks that only look so."""

import numpy as np
import pytest

from tests.recordings.quality.test_faults import GOOD, TIME, N, changed, codes, found, kept


def arrived(sizes, within_s, late_s=0.0, seed=0):
    """Return the times at which batches of rows arrive, their rows `within_s` apart."""
    rng = np.random.default_rng(seed)
    ends = np.cumsum(rng.integers(sizes[0], sizes[1] + 1, N)) - 1
    ends = np.append(ends[ends < N - 1], N - 1)
    batch = np.searchsorted(ends, np.arange(N))
    late = late_s * rng.random(ends.size)
    return (TIME[ends] + late)[batch] - (ends[batch] - np.arange(N)) * within_s


@pytest.mark.parametrize("rows", [2, 3, 4, 10, 25, 50, 200])
@pytest.mark.parametrize("within_s", [1e-9, 1e-6, 1e-4, 1e-3])
def test_rows_that_arrive_in_batches(rows, within_s):
    remark = found(changed(time_s=arrived((rows, rows), within_s)), "time-batches", "time_s")
    assert remark.severity == "error"
    between = 5.0 * rows - 1e3 * (rows - 1) * within_s
    assert f"in batches of {rows}: their times are {1e3 * within_s:.3g} ms" in remark.sentence
    assert f"then {between:.4g} ms; the wrong times change x_in_mm by" in remark.sentence
    assert "time_s = { rate_Hz = 200 }" in remark.remedy
    # Half of a batch at 16 mm/s, evenly spread: 1/√12 of its duration, 0.01 mm of noise.
    wrong = (0.005 - within_s) * np.sqrt((rows**2 - 1) / 12.0) * 16.0 / np.sqrt(2.0) / 0.01
    times = float(remark.sentence.split("x_in_mm by ")[1].split(" ×")[0])
    assert times == pytest.approx(wrong, rel=0.15)


@pytest.mark.parametrize("sizes", [(2, 7), (3, 40)])
def test_batches_of_any_size(sizes):
    remark = found(changed(time_s=arrived(sizes, 1e-4, 0.002)), "time-batches", "time_s")
    rate_Hz = float(remark.remedy.split("rate_Hz = ")[1].split(" ")[0])
    assert rate_Hz == pytest.approx(200.0, rel=1e-3)


def test_batches_of_equal_times_are_told_too():
    assert codes(changed(time_s=arrived((4, 4), 0.0))) == {"time-order", "time-batches"}


@pytest.mark.parametrize(
    ("every", "lost"), [(3, 2), (5, 4), (10, 3), (10, 7), (25, 10), (50, 20), (100, 90)]
)
def test_rows_that_are_lost_at_regular_intervals_are_no_batches(every, lost):
    there = np.arange(N) % every >= lost if every - lost > 1 else np.arange(N) % every != 1
    assert "time-batches" not in codes(kept(there))


@pytest.mark.parametrize("seed", range(5))
def test_clocks_that_scatter_or_change_their_pace_are_no_batches(seed):
    rng = np.random.default_rng(seed)
    uneven = np.cumsum(rng.exponential(0.005, N))
    slower = np.cumsum(np.where(np.arange(N) < N // 2, 0.005, 0.05))
    for time in (uneven, slower, TIME + 0.2 * 0.005 * rng.random(N)):
        moved = {n: np.interp(time, TIME, v) for n, v in GOOD.items() if n != "time_s"}
        assert "time-batches" not in codes({"time_s": time, **moved})
