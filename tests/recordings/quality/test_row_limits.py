"""Limits of the checks of rows and times: nothing just below, a finding just above."""

from dataclasses import replace

import numpy as np
import pytest

from tests.recordings.quality.bench import trial
from tests.recordings.quality.even_runs import FINE, WHITE, N, are, fine, of
from tsas_cli.recordings.quality.checks import clipping, clock, repeats, rows


@pytest.mark.parametrize(("scatter", "found"), [(0.049, False), (0.051, True)])
def test_intervals_scatter_by_a_twentieth(scatter, found):
    interval = 0.01 * (1.0 + scatter * (-1.0) ** np.arange(N - 1))
    time_s = np.concatenate(([0.0], np.cumsum(interval)))
    said = "scatters by 5.1 % about 10 ms (from 9.49 to 10.51 ms)"
    are(of(clock.time_jitter, time_s), found, said)


@pytest.mark.parametrize(
    ("longest", "count", "found"), [(1.49, 1, 0), (1.51, 1, 1), (9.0, 19, 1), (9.0, 20, 0)]
)
def test_rows_are_missing_beyond_one_and_a_half_intervals_at_a_few_places(longest, count, found):
    interval = np.full(N - 1, 0.01)
    interval[np.arange(1, count + 1) * 15] *= longest
    interval[30] *= 1.0 + 0.01 * (count > 1)
    told = [*clock._missing_rows(trial({"time_s": np.append(0.0, np.cumsum(interval))}))]
    are(told, found, f"at {count} place")
    assert [f.first_s for f in told] == pytest.approx([0.15] * found)


@pytest.mark.parametrize(("copied", "found"), [(3, 0), (4, 1), (40, 1)])
def test_a_buffer_of_four_rows_is_written_twice(copied, found):
    again = np.concatenate((WHITE[:100], WHITE[100 - copied : 400 - copied]))
    said = f"the first has {copied} rows and begins at 1 s, row 100"
    are(of(repeats.repeated_buffer, f_in_N=again), found, said)


@pytest.mark.parametrize(("repeats", "found"), [(10, 0), (11, 1)])
def test_ten_rows_may_repeat_beyond_three_times_their_chance(repeats, found):
    values = WHITE.copy()
    values[1] = values[0] + 1e-6  # so fine that no row repeats by chance
    at = 20 * np.arange(1, repeats + 1)
    values[at] = values[at - 1]
    told = of(rows.repeated_rows, f_in_N=values)
    are(told, found, "11 of 400 rows (2.8 %) repeat")
    assert [f.first_s for f in told] == pytest.approx([0.2] * found)


@pytest.mark.parametrize(
    ("by", "other", "noise_mm", "step_mm", "found"),
    [
        (1.01, 1.0, 0.0, 0.0, 1),
        (0.99, 1.0, 0.0, 0.0, 0),  # ten times what it changes by elsewhere
        (1.01, 3.1, 0.0, 0.0, 0),  # three times, of another channel
        (1.01, 2.9, 0.0, 0.0, 1),
        (1.01, 0.0, 0.0, 0.0, 1),  # which rests all the time
        (1.99, 1.0, 0.1, 0.0, 0),
        (2.01, 1.0, 0.1, 0.0, 1),
        (1.01, 1.0, 0.0, 0.34, 0),
        (1.01, 1.0, 0.0, 0.33, 1),
    ],
)
def test_a_position_jumps_ten_times_as_far_as_elsewhere(by, other, noise_mm, step_mm, found):
    far = np.arange(N) >= 150
    even = 0.1 * np.arange(N)
    told = of(
        rows.jump,
        sizes={"x_in_mm": replace(FINE, noise=noise_mm, step=step_mm)},
        x_in_mm=even + (by - 0.1) * far,
        f_in_N=(even + (0.1 * other - 0.1) * far) * (other > 0.0),
    )
    are(told, found, "row 150")
    assert [f.first_s for f in told] == pytest.approx([1.5] * found)


def test_the_scatter_of_times_is_what_a_fast_motion_has_more_noise_by():
    """Noise of √(0.1² + (v σ)²): σ of 3 ms, at speeds of 0 and 100 per second."""
    rng = np.random.default_rng(1)
    speed = np.where(np.arange(40_000) // 400 % 2, 100.0, 1.0)
    values = np.cumsum(0.01 * speed) + 0.1 * rng.standard_normal(40_000)
    values += 3e-3 * speed * rng.standard_normal(40_000)
    found = clock._scatter_s(0.01 * np.arange(40_000), values)
    assert found == pytest.approx(3e-3, rel=0.05)
    calm = np.cumsum(0.01 * speed) + 0.1 * rng.standard_normal(40_000)
    assert clock._scatter_s(0.01 * np.arange(40_000), calm) is None
    short = np.where(np.arange(483) // 48 % 2, 100.0, 1.0)  # thirty blocks of 16 rows
    moved = np.cumsum(0.01 * short) + (0.1 + 3e-3 * short) * rng.standard_normal(483)
    assert clock._scatter_s(0.01 * np.arange(483), moved) == pytest.approx(4e-3, rel=0.3)
    assert clock._scatter_s(0.01 * np.arange(482), moved[:482]) is None


@pytest.mark.parametrize(
    ("by", "other", "found"), [(10.1, 3.1, [150]), (9.9, 3.1, []), (10.1, 2.9, [])]
)
def test_a_run_is_torn_where_the_drive_goes_ten_times_and_another_three_times_as_far(
    by, other, found
):
    """As the least of the twenty largest jumps, those of the tear among them."""
    far = np.arange(N) > 150
    jerky = 0.1 * (np.arange(N) // 2) + np.arange(N)  # each change is 0.1 from the next
    columns = {
        "x_in_mm": jerky + 0.1 * (1.0 - by) * far,
        "f_in_N": jerky + 0.1 * (1.0 - other) * far,
    }
    assert rows._torn(fine(**columns), list(columns)) == found


@pytest.mark.parametrize(
    ("held", "per_row", "found"), [(4, 0.2, 0), (5, 0.2, 1), (5, 0.11, 0), (6, 0.11, 1)]
)
def test_five_rows_at_an_end_are_clipped_if_the_drive_moves_on_by_a_twentieth(held, per_row, found):
    x = 5.0 + per_row * (np.abs(np.mod(np.arange(N), 80) - 40.0) - 20.0)
    f_in = x.copy()
    f_in[50 : 50 + held] = 20.0
    sizes = {"f_in_N": replace(FINE, highest=20.0)}
    told = of(clipping.clipped, x_in_mm=x, f_in_N=f_in, sizes=sizes)
    are(told, found, f"highest value 20 for {0.01 * (held - 1):.3g} s in 1 plateau")


@pytest.mark.parametrize(
    ("zeros", "twos", "more"), [(1150, 410, False), (1250, 410, True), (1250, 390, False)]
)
@pytest.mark.parametrize("from_zero", [0.0, -900.0])
def test_a_channel_repeats_where_it_does_so_more_often_than_it_changes_by_one_step(
    zeros, twos, more, from_zero
):
    """By a fifth, in both halves of its span; a single step is rare beside two, or it rests."""
    turns = np.array([1.0, -1.0])
    changes = np.concatenate((np.zeros(zeros), np.tile(turns, 1000), np.tile(2.0 * turns, twos)))
    values = np.concatenate((np.cumsum(changes), 50.0 + np.cumsum(changes))) + from_zero
    expected = (zeros / changes.size, 1000.0 / changes.size) if more else (0.0, 0.0)
    assert repeats._beside_one_step(0.25 * values, 0.25) == pytest.approx(expected, abs=1e-3)
    clipped = np.concatenate((values[: changes.size], from_zero + 50.0 + 2.0 * np.arange(4000.0)))
    assert repeats._beside_one_step(clipped, 1.0) == (0.0, 0.0)
