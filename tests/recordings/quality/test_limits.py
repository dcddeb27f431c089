"""Each check's limits, by its own definition: nothing just below, a finding just above."""

from dataclasses import replace

import numpy as np
import pytest

from tests.recordings.quality.bench import trial
from tsas_cli.recordings.quality.checks import (
    clipping,
    clock,
    extremes,
    motion,
    noise,
    pairs,
    repeats,
    rows,
)
from tsas_cli.recordings.quality.finding import Finding
from tsas_cli.recordings.quality.samples import NoiseSpectrum, Size

N = 400
WHITE = np.random.default_rng(6).standard_normal(N)
FINE = Size(0.0, 0.0, 10.0, 0.0, 10.0)


def fine(time_s=None, sizes=None, load="spring", preload_N=None, **columns):
    """Return a run; each channel has the span 10, no noise and no steps, but for some sizes."""
    time_s = 0.01 * np.arange(N) if time_s is None else np.asarray(time_s)
    found = trial({"time_s": time_s, **columns}, load=load, preload_N=preload_N)
    return replace(found, overall=dict.fromkeys(columns, FINE) | (sizes or {}))


def of(check, *given, **named):
    """Return the findings of a check on such a run."""
    return [f for f in check(fine(*given, **named)) if isinstance(f, Finding)]


def spectrum(power, steady=()):
    frequency = np.arange(1.0, len(power) + 1.0)
    is_steady = np.isin(np.arange(len(power)), steady)
    return NoiseSpectrum(frequency, np.array(power), np.ones(len(power), bool), is_steady)


@pytest.mark.parametrize(
    ("line", "beside", "steady", "found"),
    [
        (20.1, {}, (9,), 10.0),
        (19.9, {}, (9,), None),
        (20.1, {}, (), None),
        (20.1, {8: 5.0, 10: 5.0, 12: 5.0}, (9,), 10.0),  # within a third of its frequency
        *((20.1, {at: 1.01}, (9,), None) for at in (4, 5, 13, 16)),
        (20.1, {3: 9.0, 17: 9.0}, (9,), 10.0),  # two bands below, four above
        (20.1, {15: 25.0}, (9,), None),
    ],
)
def test_a_line_is_twenty_times_what_is_on_both_of_its_sides(line, beside, steady, found):
    power = np.ones(40)
    for at, value in ({9: line} | beside).items():
        power[at] = value
    assert noise._line(spectrum(power, steady)) == found


@pytest.mark.parametrize(("at", "found"), [(0, None), (39, None), (2, 3.0)])
def test_a_line_without_anything_beside_it_is_none(at, found):
    power = np.ones(40)
    power[at] = 99.0
    assert noise._line(spectrum(power, (at,))) == found


@pytest.mark.parametrize(
    ("bands", "top", "rounding", "found"),
    [
        (20, 1.0 / 31.0, 0.02, 20),
        (20, 1.0 / 29.0, 0.02, 0),  # it falls by less than thirty times
        (20, 1.0 / 31.0, 0.0159, 0),  # white noise of its own above, beyond twice the rounding
        (20, 1.0 / 31.0, 0.0163, 20),
        (1, 1e-4, 6e-5, 0),  # what is left of a motion
        (2, 1e-4, 6e-5, 2),
        (2, 1e-4, 1.1e-3, 0),  # nothing is rounded: it was computed
        (3, 1e-4, 1.1e-3, 3),
        (2, 0.0, 0.0, 0),
        (3, 0.0, 0.0, 3),
    ],
)
def test_noise_ends_where_it_falls_thirtyfold_after_two_even_bands(bands, top, rounding, found):
    power = np.where(np.arange(1, 101) <= bands, 1.0, top)
    assert (noise._end_of_noise(spectrum(power), rounding) or 0) == found


def test_a_spectrum_that_is_white_at_the_top_has_no_end():
    power = np.where(np.arange(1, 101) <= 20, 99.0, 1.0)
    power[29:50] = 2.4
    assert noise._end_of_noise(spectrum(power), 0.4) is None
    power[29:50] = 2.6  # it still falls there
    assert noise._end_of_noise(spectrum(power), 0.4) == 20.0


@pytest.mark.parametrize(("scatter", "found"), [(0.049, False), (0.051, True)])
def test_intervals_scatter_by_a_twentieth(scatter, found):
    interval = 0.01 * (1.0 + scatter * (-1.0) ** np.arange(N - 1))
    time_s = np.concatenate(([0.0], np.cumsum(interval)))
    told = of(clock.time_jitter, time_s)
    assert bool(told) == found
    if found:
        assert "scatters by 5.1 % about 10 ms (from 9.49 to 10.51 ms)" in told[0].sentence


@pytest.mark.parametrize(
    ("longest", "count", "found"), [(1.49, 1, 0), (1.51, 1, 1), (9.0, 19, 1), (9.0, 20, 0)]
)
def test_rows_are_missing_beyond_one_and_a_half_intervals_at_a_few_places(longest, count, found):
    interval = np.full(N - 1, 0.01)
    interval[np.arange(1, count + 1) * 15] *= longest
    interval[30] *= 1.0 + 0.01 * (count > 1)
    told = [*clock._missing_rows(trial({"time_s": np.append(0.0, np.cumsum(interval))}))]
    assert len(told) == found
    if told:
        assert f"at {count} place" in told[0].sentence
        assert told[0].first_s == pytest.approx(0.15)


@pytest.mark.parametrize(
    ("step", "said"), [(0.0199, None), (0.0201, "note"), (0.199, "note"), (0.201, "warning")]
)
def test_steps_are_coarse_from_a_500th_of_the_span_on(step, said):
    size = replace(FINE, step=step)
    told = of(extremes.quantised, sizes={"f_out_N": size}, f_out_N=WHITE)
    assert [f.severity for f in told] == [said] * bool(said)
    for noise_N, found in ((0.49 * step, bool(said)), (0.51 * step, False)):
        sizes = {"f_out_N": replace(size, noise=noise_N)}
        assert bool(of(extremes.quantised, sizes=sizes, f_out_N=WHITE)) == found
    forced = of(extremes.quantised, sizes={"f_out_N": size}, load="force", f_out_N=WHITE)
    assert [f.severity for f in forced] == ["note"] * bool(said)
    if told:
        assert f"steps of {step:.4g} N, {10 * step:.2g} % of its range of 10 N" in told[0].sentence


@pytest.mark.parametrize(
    ("low", "high", "noise_N", "found"),
    [
        (-0.21, 9.0, 0.0, True),
        (-0.19, 9.0, 0.0, False),
        (-0.59, 9.0, 0.1, False),
        (-0.61, 9.0, 0.1, True),
        (-5.0, -0.61, 0.1, False),  # it has the wrong sign
        (-5.0, -0.59, 0.1, True),
    ],
)
def test_a_tension_is_negative_beyond_what_a_slack_tendon_reads(low, high, noise_N, found):
    values = np.where(np.arange(N) < 100, low, high)
    told = of(
        motion.negative_tension, sizes={"f_in_N": replace(FINE, noise=noise_N)}, f_in_N=values
    )
    assert len(told) == found
    if found and high > 0.0:
        assert "negative in 25 % of the samples" in told[0].sentence


@pytest.mark.parametrize(("rig", "found"), [({}, 1), ({"antagonist_preload_N": 20.0}, 0)])
def test_a_difference_of_two_tendons_may_be_negative(rig, found):
    time_s = np.arange(N) / 100.0
    values = {"time_s": time_s, "x_in_mm": time_s, "f_in_N": 2.0 + 7.0 * np.sin(time_s)}
    told = motion.negative_tension(trial(values, rig))
    assert sum(isinstance(one, Finding) for one in told) == found


X = np.interp(np.arange(N), [0, 100, 200, 300, 399], [0.0, 10.0, 0.0, 10.0, 0.0])
WAY = np.sign(np.gradient(X))


@pytest.mark.parametrize(("friction", "found"), [(0.31, False), (-0.29, False), (-0.31, True)])
def test_tensions_are_exchanged_where_friction_is_negative_by_a_thirtieth(friction, found):
    """f_in = 3 + 1.5 f_out ± half of it; a gain and an offset do not matter."""
    f_out = 20.0 + X + 0.3 * np.sin(0.7 * np.arange(N))
    f_in = 3.0 + 1.5 * f_out + 0.5 * friction * WAY
    told = of(motion.exchanged, x_in_mm=X, f_in_N=f_in, f_out_N=f_out)
    assert len(told) == found
    assert all(f"f_in_N is {-friction:.3g} N lower in contraction" in f.sentence for f in told)


@pytest.mark.parametrize(("part", "found"), [(0.77, 0), (0.79, 2)])
def test_motion_is_steady_where_the_load_moves_in_a_fifth_of_a_stroke(part, found):
    """It rests over a part of each stroke."""
    x_out = np.where(
        WAY > 0.0, np.maximum(X - 10.0 * part, 0.0), np.minimum(X, 10.0 * (1.0 - part))
    )
    told = of(motion.no_steady_motion, x_in_mm=X, x_out_mm=x_out)
    assert len(told) == found
    assert [f.sentence.split(":")[0] for f in told] == [
        f"no steady {way}" for way in ("contraction", "loosening")
    ][:found]


def test_the_share_of_a_stroke_in_which_the_load_moves():
    for x_out, share in ((X, 0.98), (np.maximum(X - 4.0, 0.0), 0.58)):
        one = fine(x_in_mm=X, x_out_mm=x_out)
        assert motion._moving(one, "x_out_mm", one.strokes[0]) == pytest.approx(share, abs=0.011)


@pytest.mark.parametrize("size", [0.5, -0.5])
def test_an_interference_is_the_jump_at_each_reversal_with_the_drive(size):
    """The load rests while the drive turns, on a straight line before."""
    t = 0.002 * np.arange(3001)
    x = 5.0 + 5.0 * np.interp(np.mod(t, 2.0), [0.0, 1.0, 2.0], [-1.0, 1.0, -1.0])
    way = np.where(np.mod(t, 2.0) < 1.0, 1.0, -1.0)
    load = np.where(way > 0.0, np.maximum(x - 2.0, 0.0), np.minimum(x, 8.0))
    found = fine(t, x_in_mm=x, f_out_N=load + 0.5 * size * way)
    jumps = motion._jumps(found, found.channels["f_out_N"], 0.0)
    assert jumps == pytest.approx(np.full(5, size), abs=1e-9)


@pytest.mark.parametrize(
    ("step_s", "stroke_s", "said"),
    [
        (0.21, 501.0, "millisecond"),
        (0.19, 501.0, None),
        (0.21, 499.0, None),
        (200.0, 9e5, "microsecond"),
        (199.0, 9e5, "millisecond"),
    ],
)
def test_times_look_like_another_unit_where_steps_and_strokes_are_long(step_s, stroke_s, said):
    turn = round(stroke_s / step_s)
    k = np.arange(2 * turn + 1)
    x = 10.0 * np.minimum(k, 2 * turn - k) / turn
    stroke_s = turn * step_s
    told = [f for f in of(pairs.unit, step_s * k, x_in_mm=x) if f.column == "time_s"]
    expected = said if stroke_s > 500.0 else None
    assert [f.sentence.rpartition(" ")[2] for f in told] == [expected] * bool(expected)


@pytest.mark.parametrize(("copied", "found"), [(3, 0), (4, 1), (40, 1)])
def test_a_buffer_of_four_rows_is_written_twice(copied, found):
    again = np.concatenate((WHITE[:100], WHITE[100 - copied : 400 - copied]))
    told = of(repeats.repeated_buffer, f_in_N=again)
    assert len(told) == found
    if told:
        assert f"the first has {copied} rows and begins at 1 s, row 100" in told[0].sentence


@pytest.mark.parametrize(("repeats", "found"), [(10, 0), (11, 1)])
def test_ten_rows_may_repeat_beyond_three_times_their_chance(repeats, found):
    values = WHITE.copy()
    values[1] = values[0] + 1e-6  # so fine that no row repeats by chance
    at = 20 * np.arange(1, repeats + 1)
    values[at] = values[at - 1]
    told = of(rows.repeated_rows, f_in_N=values)
    assert len(told) == found
    if told:
        assert told[0].sentence.startswith("11 of 400 rows (2.8 %) repeat")
        assert told[0].first_s == pytest.approx(0.2)


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
    assert len(told) == found
    assert all(f.first_s == pytest.approx(1.5) and "row 150" in f.sentence for f in told)


@pytest.mark.parametrize(("late", "found"), [(0.16, False), (0.14, True)])
def test_a_tension_is_coupled_to_ac_where_its_mean_falls_to_a_seventh_of_its_span(late, found):
    swing = 3.0 * (-1.0) ** np.arange(N)
    f_in = np.where(np.arange(N) < 150, 6.0, 10.0 * late) + swing
    told = of(extremes.ac_coupled, x_in_mm=X, f_in_N=f_in, preload_N=25.0)
    assert len(told) == found
    assert all(f"a mean of {10.0 * late:.2g} N" in f.sentence for f in told)


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
    ("by", "other", "found"),
    [(10.1, 3.1, [150]), (9.9, 3.1, []), (10.1, 2.9, [])],
)
def test_a_run_is_torn_where_the_drive_goes_ten_times_and_another_three_times_as_far(
    by, other, found
):
    """As the least of the twenty largest steps, those of the tear among them."""
    far = np.arange(N) > 150
    even = 0.1 * np.arange(N)
    columns = {"x_in_mm": even + (0.1 * by - 0.1) * far, "f_in_N": even + (0.1 * other - 0.1) * far}
    assert rows._torn(fine(**columns), list(columns)) == found


@pytest.mark.parametrize(
    ("held", "per_row", "found"), [(4, 0.2, 0), (5, 0.2, 1), (5, 0.11, 0), (6, 0.11, 1)]
)
def test_five_rows_at_an_end_are_clipped_if_the_drive_moves_on_by_a_twentieth(held, per_row, found):
    x = 5.0 + per_row * (np.abs(np.mod(np.arange(N), 80) - 40.0) - 20.0)
    f_in = x.copy()
    f_in[50 : 50 + held] = 20.0
    told = of(
        clipping.clipped, x_in_mm=x, f_in_N=f_in, sizes={"f_in_N": replace(FINE, highest=20.0)}
    )
    assert len(told) == found
    if told:
        assert f"highest value 20 for {0.01 * (held - 1):.3g} s in 1 plateau" in told[0].sentence


@pytest.mark.parametrize("gain", [1.5, -0.5])
def test_friction_beside_any_gain_is_told_and_a_negative_gain_is_none(gain):
    f_out = 20.0 + X
    made = fine(x_in_mm=X, f_out_N=f_out, f_in_N=40.0 + gain * f_out + 0.35 * WAY)
    travel = np.abs(np.gradient(X))
    up, down = (
        np.average(f_out[at], weights=travel[at])
        for at in (made.direction == 1.0, made.direction == -1.0)
    )
    shift = gain * (up - down) if gain < 0.0 else 0.0  # what the directions differ by themselves
    assert motion._excess_while_pulling(made) == pytest.approx(0.7 + shift, abs=1e-9)


@pytest.mark.parametrize("delay_s", [-0.02, 0.0, 0.05])
def test_a_delay_is_what_follows_the_speed_beside_a_bent_spring_and_friction(delay_s):
    """y = 3 + 2 x + 0.1 x² + 0.4 sgn(v) − 2 τ v, x from the middle of what is moving."""
    t = np.linspace(0.0, 6.0, 600)
    x = 4.0 * np.sin(t) + 0.5 * np.sin(2.7 * t)
    v = np.gradient(x, t)
    x -= x[np.abs(v) > 0.3 * np.sqrt(np.mean(v**2))].mean()
    y = 3.0 + 2.0 * x + 0.1 * x**2 + 0.4 * np.sign(v) - 2.0 * delay_s * v
    assert pairs._remaining_delay(t, x, y) == pytest.approx(delay_s, abs=1e-9)
    loud = np.random.default_rng(3).standard_normal(600) * np.std(y)
    assert pairs._remaining_delay(t, x, y + 0.03 * loud) == pytest.approx(delay_s, abs=0.01)
    assert np.isnan(pairs._remaining_delay(t, x, y + 0.06 * loud))
    ramp = 2.0 * t  # its speed is the constant
    assert np.isnan(pairs._remaining_delay(t, ramp, 3.0 * ramp))


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


@pytest.mark.parametrize(
    ("times", "blocks", "found"), [(4.1, 2, 1), (3.9, 2, 0), (4.1, 1, 0), (4.1, 3, 1), (4.1, 4, 0)]
)
def test_noise_bursts_by_four_times_in_two_blocks_and_few_of_all(times, blocks, found):
    """Of 24 blocks of 16 rows a seventh at most."""
    size = np.ones(N)
    size[160 : 160 + 16 * blocks + 3] = times
    loud = (-1.0) ** np.arange(N) * size
    told = of(noise.bursts, sizes={"f_in_N": replace(FINE, noise=1.0)}, f_in_N=loud)
    assert len(told) == found
    assert all(
        "rises to 4.1 times its level in 1 burst, the first at 1.6 s" in f.sentence for f in told
    )


@pytest.mark.parametrize(("held", "found"), [(19, 0), (20, 1)])
def test_a_noisy_channel_is_stuck_that_misses_twenty_updates(held, found):
    f_in = 2.0 * X + 0.1 * WHITE
    f_in[40 : 40 + held] = f_in[40]
    told = of(
        extremes.stuck,
        sizes={"f_in_N": replace(FINE, highest=30.0, lowest=-9.0)},
        x_in_mm=X,
        f_in_N=f_in,
    )
    assert [f.column for f in told] == ["f_in_N"] * found
    assert [f.first_s for f in told] == pytest.approx([0.4] * found)


@pytest.mark.parametrize(("back", "found"), [(3.0, 1), (4.0, 0)])
def test_a_sign_is_wrong_where_most_of_the_way_is_against_the_drive(back, found):
    """Three strokes of 10 mm against it, one with it: (30 − 3.3)/(30 + 3.3) is 0.8."""
    rate = np.where(np.arange(N) < 300, -1.0, 0.1 * back)
    x_out = np.cumsum(rate * np.diff(X, prepend=X[0]))
    told = of(motion.sign, x_in_mm=X, x_out_mm=x_out)
    assert [f.column for f in told] == ["x_out_mm"] * found
