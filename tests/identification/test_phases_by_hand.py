"""How a stroke is cut, piece by piece: on channels that follow the two laws exactly, or nearly."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.identification import phases as p

N, CUT = 120, 45
TRAVEL = np.linspace(0.0, 12.0, N)


def stroke(channels, travel=TRAVEL):
    n = travel.size
    return p._Stroke(0, n, True, np.arange(n), travel, channels)


def f_in(slip=20.0, dead=100.0, noise=0.0, seed=1):
    """Tension over noise: along the front's law up to the cut, straight after it."""
    D = TRAVEL
    band = 40.0 * np.sqrt(D) + dead * D
    line = band[CUT] + slip * (D - D[CUT])
    return np.where(D[CUT] > D, band, line) + noise * np.random.default_rng(seed).standard_normal(N)


def f_out(noise=0.0, seed=2):
    still = np.where(TRAVEL[CUT] > TRAVEL, 0.0, 15.0 * (TRAVEL - TRAVEL[CUT]))
    return still + noise * np.random.default_rng(seed).standard_normal(N)


@pytest.mark.parametrize("columns", [1, 2, 3])
def test_squares_that_a_fit_to_the_first_samples_leaves(columns):
    basis = np.column_stack([TRAVEL**0.5**k for k in range(columns)])
    basis[:, 0] = 1.0
    values = 7.0 + np.random.default_rng(3).standard_normal(N)
    left = p._residual_squares(basis, values)
    assert left.size == N + 1
    assert left[0] == 0.0
    for k in (1, 2, 5, 40, N):
        fit = np.linalg.lstsq(basis[:k], values[:k], rcond=None)[0]
        direct = np.sum((values[:k] - basis[:k] @ fit) ** 2)
        assert left[k] == pytest.approx(direct, abs=1e-5)


def test_each_channel_has_its_law_on_either_side():
    dead, slip = p._bases("f_in_N", np.array([0.0, 4.0, 9.0]))
    assert dead.tolist() == [[1.0, 0.0, 0.0], [1.0, 2.0, 4.0], [1.0, 3.0, 9.0]]
    assert slip.tolist() == [[1.0, 0.0], [1.0, 4.0], [1.0, 9.0]]
    still, moving = p._bases("x_out_mm", np.array([0.0, 4.0]))
    assert still.tolist() == [[1.0], [1.0]]
    assert moving.tolist() == [[1.0, 0.0], [1.0, 4.0]]


@pytest.mark.parametrize("names", [("f_in_N",), ("f_out_N",), ("f_in_N", "f_out_N")])
def test_the_cut_is_where_both_laws_meet(names):
    channels = {"f_in_N": f_in(noise=1.0), "f_out_N": f_out(noise=1.0)}
    found = p._transition(stroke({name: channels[name] for name in names}))
    assert abs(found - CUT) <= 2


def test_a_stroke_that_one_law_is_enough_for_is_not_cut():
    noise = np.random.default_rng(4).standard_normal(N)
    assert p._transition(stroke({"f_in_N": 20.0 * TRAVEL + noise})) is None
    band = 40.0 * np.sqrt(TRAVEL) + 100.0 * TRAVEL + noise
    assert p._transition(stroke({"f_in_N": band})) is None
    assert p._transition(stroke({"f_out_N": noise})) is None


def test_a_bend_from_gentle_to_steep_is_no_slip():
    bent = np.where(
        TRAVEL[CUT] > TRAVEL, 5.0 * TRAVEL, 5.0 * TRAVEL + 60.0 * (TRAVEL - TRAVEL[CUT])
    )
    assert p._transition(stroke({"f_in_N": bent})) is None


@pytest.mark.parametrize(("slip", "cut"), [(30.0, True), (40.0, False)])
def test_slip_is_a_third_as_steep_at_the_most(slip, cut):
    """After a straight rise of 100 per mm; a law with √D fits that too."""
    D, rng = TRAVEL, np.random.default_rng(5)
    values = np.where(D[CUT] > D, 100.0 * D, 100.0 * D[CUT] + slip * (D - D[CUT]))
    found = p._transition(stroke({"f_in_N": values + rng.standard_normal(N)}))
    assert (found is not None) == cut


def test_a_stroke_with_too_few_samples_or_no_channel_is_not_cut():
    few = slice(CUT - 8, CUT + 8)  # 16: eight for each law would leave none to choose
    whole = f_in()
    assert p._transition(stroke({"f_in_N": whole[few]}, TRAVEL[few] - TRAVEL[few][0])) is None
    assert p._transition(stroke({})) is None


def test_how_steep_both_sides_of_a_cut_are():
    line = np.where(TRAVEL[CUT] > TRAVEL, 50.0 * TRAVEL, 50.0 * TRAVEL[CUT] + 0.0 * TRAVEL)
    line = line + np.where(TRAVEL[CUT] > TRAVEL, 0.0, -4.0 * (TRAVEL - TRAVEL[CUT]))
    assert p._slopes(stroke({"f_in_N": line}), CUT) == pytest.approx((50.0, 4.0))
    before, after = p._slopes(stroke({"x_out_mm": line}), CUT)
    assert (before, after) == pytest.approx((1.0 / 50.0, 1.0 / 4.0))  # a load that moves slips
    whole, nothing = p._slopes(stroke({"x_out_mm": 0.0 * line, "f_in_N": 3.0 * TRAVEL}), None)
    assert whole == pytest.approx(3.0)
    assert math.isnan(nothing)
    assert np.isnan(p._slopes(stroke({}), None)).all()
    short = stroke({"f_in_N": TRAVEL[:7]}, TRAVEL[:7])
    assert np.isnan(p._slopes(short, None)).all()
    assert np.isnan(p._steepness(np.ones(5), np.arange(5.0)))


def test_the_border_is_the_geometric_mean_of_the_strokes_that_show_both():
    slopes = [(100.0, 4.0), (400.0, 1.0), (100.0, 4.0), (math.nan, 3.0), (50.0, 0.0)]
    assert p._border(slopes) == pytest.approx(20.0)
    assert p._border([(math.nan, 1.0), (5.0, 0.0)]) is None


def test_means_of_blocks_the_last_one_shorter():
    assert p._block_means(np.arange(7.0), 3).tolist() == [1.0, 4.0, 6.0]
    assert p._block_means(np.arange(4.0), 1).tolist() == [0.0, 1.0, 2.0, 3.0]


def resting(way=1.0, noise=0.05, *, channel=True):
    """A drive that goes, rests from sample 50 on and turns at 100; unloading begins at 70."""
    t = np.arange(140)
    x = way * np.interp(t, [0, 50, 100, 139], [0.0, 5.0, 5.0, 1.0])
    tension = way * np.interp(t, [0, 50, 70, 139], [25.0, 45.0, 45.0, 10.0])
    conditioned = SimpleNamespace(
        values=x, sd=np.full(140, 0.01), reversals=np.array([0, 100, 139])
    )
    return SimpleNamespace(
        conditioned={"x_in_mm": conditioned},
        measured={"f_in_N": tension} if channel else {"f_out_N": tension},
        noise={"f_in_N": noise, "f_out_N": noise},
        time_s=0.1 * t,
        drive_column="x_in_mm",
    )


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_resting_drive_has_turned_where_the_tension_does(way):
    """The mean of eight samples falls by 5/√8 of the noise some samples after 70."""
    found = p._start_of_unloading(resting(way), 100)
    assert 62 <= found <= 70
    assert p._start_of_unloading(resting(way, noise=1e6), 100) == 100


def test_elsewhere_the_drive_turns_where_it_says():
    assert p._start_of_unloading(resting(channel=False), 100) == 100
    assert p._start_of_unloading(resting(), 139) == 139
    assert p._start_of_unloading(resting(), 0) == 0


def test_strokes_go_from_turn_to_turn_and_cover_the_run():
    run = resting(channel=False)
    first, second = p._strokes(run)
    assert (first.first, first.end, second.first, second.end) == (0, 100, 100, 140)
    assert (first.up, second.up) == (True, False)
    x = run.conditioned["x_in_mm"].values
    np.testing.assert_allclose(second.travel, np.abs(x[100:] - x[100]))
    expected = run.measured["f_out_N"][100:] / 0.05
    np.testing.assert_allclose(second.channels["f_out_N"], expected)


def test_long_strokes_are_thinned_by_means():
    n = 1300
    x = np.arange(float(n))
    conditioned = SimpleNamespace(values=x, sd=np.full(n, 0.01), reversals=np.array([0, n - 1]))
    run = SimpleNamespace(
        conditioned={"x_in_mm": conditioned},
        measured={"f_out_N": 2.0 * x},
        noise={"f_out_N": 0.5},
        time_s=x,
        drive_column="x_in_mm",
    )
    (whole,) = p._strokes(run)
    assert set(np.diff(whole.at)) == {3}  # 1300 // 400
    np.testing.assert_allclose(whole.channels["f_out_N"][:3], [4.0, 16.0, 28.0])
    (unknown,) = p.segment(SimpleNamespace(drive_column="f_in_N", time_s=x))
    assert (unknown.first, unknown.end, unknown.phase) == (0, n, "unknown")


def test_segments_in_a_file_end_where_the_next_one_begins():
    segments = [p.Segment(0, 50, "dead_band_up"), p.Segment(50, 140, "contraction")]
    told = p.segment_records(resting(), segments)
    assert [(s.start_s, round(s.end_s, 9), s.phase) for s in told] == [
        (0.0, 5.0, "dead_band_up"),
        (5.0, 13.9, "contraction"),
    ]


def test_a_load_that_stands_quite_still_is_in_the_dead_band():
    """As lazy as can be before the cut, 1/15 after it."""
    before, after = p._slopes(stroke({"f_out_N": f_out()}), CUT)
    assert before > 1e9
    assert after == pytest.approx(1.0 / 15.0)


def at_rest(noise=0.05, sd=0.01, *, peak=70, size=140, turn=100):
    """A drive that rests from sample 50 on, 0.1 mm beyond the one before; f_in falls from `peak`.

    By half a newton a sample, from 45 N that it has reached at sample 40.
    """
    t = np.arange(size)
    x = np.interp(t, [0, 50, turn, turn + 39], [0.0, 5.0, 5.0, 1.0])
    tension = np.interp(t, [0, 40, peak, peak + 80], [25.0, 45.0, 45.0, 5.0])
    conditioned = SimpleNamespace(values=x, sd=np.full(size, sd))
    return SimpleNamespace(
        conditioned={"x_in_mm": conditioned}, measured={"f_in_N": tension}, noise={"f_in_N": noise}
    )


def margin(drop):
    """Return the noise at which five deviations of a mean of eight are that drop."""
    return drop * math.sqrt(8.0) / 5.0


@pytest.mark.parametrize(
    ("noise", "found"),
    [
        (margin(0.99 * 0.5 / 8.0), 63),  # eight samples up to 70 fall by nothing,
        (margin(1.01 * 0.5 / 8.0), 64),  # up to 71 by 1/16 N,
        (margin(0.99 * 1.5 / 8.0), 64),  # up to 72 by 3/16 N
        (margin(1.01 * 1.5 / 8.0), 65),
    ],
)
def test_tension_has_turned_where_the_mean_of_eight_is_five_deviations_lower(noise, found):
    assert p._start_of_unloading(at_rest(noise), 100) == found


@pytest.mark.parametrize(("sd", "rest"), [(0.0249, 50), (0.0251, 49)])
def test_a_drive_rests_within_four_standard_deviations(sd, rest):
    """The tension falls from sample 42 on: where the rest begins it has turned."""
    assert p._start_of_unloading(at_rest(1e-6, sd, peak=42), 100) == rest


def test_eight_samples_are_looked_at_or_none():
    eight = at_rest(1e-6, peak=42, size=58, turn=56)
    assert p._start_of_unloading(eight, 56) == 50
    seven = at_rest(1e-6, peak=42, size=57, turn=55)
    assert p._start_of_unloading(seven, 55) == 55


def test_a_tension_that_is_not_known_tells_no_turn():
    run = at_rest()
    run.measured["f_in_N"][60] = np.nan
    assert p._start_of_unloading(run, 100) == 100


@pytest.mark.parametrize(("samples", "step"), [(1199, 2), (1200, 3), (799, 1), (800, 2)])
def test_strokes_are_thinned_to_four_hundred_points_or_more(samples, step):
    x = np.arange(float(samples))
    values = np.where(np.isin(np.arange(samples), (0, samples - 1)), 3.0 * x, np.nan)
    once = np.where(np.arange(samples) == 7, 1.0, np.nan)
    conditioned = SimpleNamespace(
        values=x, sd=np.full(samples, 0.01), reversals=np.array([0, samples - 1])
    )
    run = SimpleNamespace(
        conditioned={"x_in_mm": conditioned},
        measured={"f_out_N": values, "x_out_mm": once, "f_in_N": 0.0 * x + 2.0},
        noise={"f_out_N": 0.5, "x_out_mm": 1.0, "f_in_N": 0.0},
        time_s=0.1 * x,
    )
    (found,) = p._strokes(run)
    assert set(np.diff(found.at)) == {step}
    assert set(found.channels) == {"f_out_N", "f_in_N"}  # of x_out a single sample is known
    first_mean = 6.0 * (step - 1) / 2.0  # of a line between two samples: 3 x/0.5
    assert found.channels["f_out_N"][:2] == pytest.approx([first_mean, first_mean + 6.0 * step])
    assert found.channels["f_in_N"][0] == pytest.approx(2e12)  # no noise counts as next to none


def test_a_drive_that_comes_back_to_where_it_was_goes_up():
    x = np.zeros(20)
    conditioned = SimpleNamespace(values=x, sd=x, reversals=np.array([0, 19]))
    run = SimpleNamespace(
        conditioned={"x_in_mm": conditioned}, measured={}, noise={}, time_s=np.arange(20.0)
    )
    assert [s.up for s in p._strokes(run)] == [True]


@pytest.fixture
def cut_as(monkeypatch):
    """Cut strokes of ten samples, up and down in turns, as told; a run goes 0, 2, 4 … inside."""

    def cut(*told):
        n = len(told)
        made = [
            p._Stroke(10 * k, 10 * k + 10, k % 2 == 0, 10 * k + 2 * np.arange(5), np.zeros(5), {})
            for k in range(n)
        ]
        by = {id(s): answer for s, answer in zip(made, told, strict=True)}
        monkeypatch.setattr(p, "_strokes", lambda run: made)
        monkeypatch.setattr(p, "_transition", lambda s: by[id(s)][0])
        monkeypatch.setattr(p, "_slopes", lambda s, cut: by[id(s)][1])
        run = SimpleNamespace(drive_column="x_in_mm", time_s=np.arange(10.0 * n))
        return [(s.first, s.end, s.phase) for s in p.segment(run)]

    return cut


BOTH = (2, (100.0, 4.0))  # cut at its third sample; between them lies 20


def test_a_stroke_that_is_cut_has_both_phases_of_its_way(cut_as):
    assert cut_as(BOTH, BOTH) == [
        (0, 4, "dead_band_up"),
        (4, 10, "contraction"),
        (10, 14, "dead_band_down"),
        (14, 20, "loosening"),
    ]


def test_a_whole_stroke_is_what_its_slope_says(cut_as):
    steep, gentle, just = ((None, (slope, math.nan)) for slope in (20.1, 19.9, 20.0))
    found = cut_as(BOTH, steep, steep, gentle, gentle, just)
    assert [phase for *_, phase in found[2:]] == [
        "dead_band_down",
        "dead_band_up",
        "loosening",
        "contraction",
        "loosening",
    ]
    assert [(a, b) for a, b, _ in found[2:]] == [(k, k + 10) for k in (10, 20, 30, 40, 50)]


def test_what_no_slope_tells_is_unknown(cut_as):
    alone = (None, (math.nan, math.nan))
    assert cut_as(BOTH, alone)[-1] == (10, 20, "unknown")
    steep = (None, (200.0, math.nan))
    assert cut_as(steep, steep) == [(0, 10, "unknown"), (10, 20, "unknown")]


def saved_by_a_cut(channels):
    """Return what two laws save at the best cut, in mean squares of what they leave."""

    def left(basis, values):
        return np.sum((values - basis @ np.linalg.lstsq(basis, values, rcond=None)[0]) ** 2)

    bases = {name: p._bases(name, TRAVEL) for name in channels}
    cuts = [
        sum(
            left(bases[n][0][:k], values[:k]) + left(bases[n][1][k:], values[k:])
            for n, values in channels.items()
        )
        for k in range(8, N - 8)
    ]
    whole = min(sum(left(bases[n][law], v) for n, v in channels.items()) for law in (0, 1))
    return (whole - min(cuts)) / (min(cuts) / (N * len(channels)))


@pytest.mark.parametrize(
    "names", [("f_in_N",), ("f_out_N",), ("f_out_N", "x_out_mm")], ids="-".join
)
def test_a_cut_has_to_save_thirty_mean_squares(names):
    noise = np.random.default_rng(8).standard_normal((2, N))

    def of_size(size):
        law = {"f_in_N": f_in(slip=-5.0), "f_out_N": f_out(), "x_out_mm": f_out()}
        return {name: size * law[name] + of for name, of in zip(names, noise, strict=False)}

    low, high = 1e-4, 1.0
    for _ in range(14):
        middle = math.sqrt(low * high)
        low, high = (low, middle) if saved_by_a_cut(of_size(middle)) > 30.0 else (middle, high)
    assert saved_by_a_cut(of_size(low)) == pytest.approx(30.0, rel=5e-3)
    assert p._transition(stroke(of_size(0.995 * low))) is None
    assert p._transition(stroke(of_size(1.005 * high))) is not None


def test_a_rest_that_a_run_begins_with_tells_no_turn():
    run = at_rest(1e-6)
    run.conditioned["x_in_mm"].values[:100] = 5.0
    assert p._start_of_unloading(run, 100) == 100


def test_the_last_sample_is_no_turn_however_long_the_drive_rests():
    assert p._start_of_unloading(at_rest(1e-6, size=101), 100) == 100


def strokes_of(x, *turns):
    conditioned = SimpleNamespace(values=x, sd=0.01 + 0.0 * x, reversals=np.array(turns))
    run = SimpleNamespace(
        conditioned={"x_in_mm": conditioned},
        measured={},
        noise={},
        time_s=np.arange(float(x.size)),
    )
    return p._strokes(run)


def test_each_stroke_is_thinned_by_its_own_length():
    x = np.concatenate((np.arange(1000.0), 1000.0 - np.arange(500.0)))
    first, second = strokes_of(x, 0, 1000, 1499)
    assert (set(np.diff(first.at)), set(np.diff(second.at))) == ({2}, {1})


def test_the_way_of_the_last_stroke_is_told_by_the_last_sample():
    assert [s.up for s in strokes_of(np.array([0.0, -1.0, -2.0, 1.0]), 0, 3)] == [True]
    assert [s.up for s in strokes_of(np.array([0.0, 1.0, 2.0, -1.0]), 0, 3)] == [False]


def test_a_tension_without_noise_has_turned_after_its_peak():
    assert 50 <= p._start_of_unloading(at_rest(0.0), 100) <= 63


def test_a_short_stroke_is_cut_where_more_than_eight_samples_are_on_either_side():
    for half in (10, 9):
        few = slice(CUT - half, CUT + half)
        cut = p._transition(stroke({"f_out_N": 50.0 * f_out()[few]}, TRAVEL[few] - TRAVEL[few][0]))
        assert abs(cut - half) <= 1


def test_a_drive_that_slows_down_slips_along_a_line_too():
    """Samples that lie closer and closer: what is straight is so over travel, not over time."""
    travel = 12.0 * np.sin(np.linspace(0.0, 1.4, N))
    values = np.where(np.arange(N) < CUT, 0.0, 40.0 * (travel - travel[CUT]))
    assert abs(p._transition(stroke({"f_out_N": values}, travel)) - CUT) <= 1


@pytest.mark.parametrize("bend", [4, N - 4])
def test_a_bend_in_the_first_or_last_eight_samples_is_no_cut(bend):
    values = np.where(np.arange(N) < bend, 0.0, 900.0 * (TRAVEL - TRAVEL[bend]))
    found = p._transition(stroke({"f_out_N": values}))
    assert found is None or 8 <= found < N - 8


def test_a_cut_that_leaves_nothing_needs_to_save_next_to_nothing():
    assert abs(p._transition(stroke({"f_out_N": 1e-3 * f_out()})) - CUT) <= 1


def test_squares_are_never_negative():
    basis = np.column_stack((np.ones(N), TRAVEL))
    for values in (1e6 * TRAVEL, 0.1 * TRAVEL - 7e5):
        assert p._residual_squares(basis, values).min() == 0.0


@pytest.mark.parametrize("cut", [None, 20, CUT])
def test_slopes_are_those_of_lines_through_all_samples_of_a_side(cut):
    values = np.random.default_rng(6).standard_normal(N)
    sides = (slice(0, cut), slice(cut, N))
    steep = [abs(np.polyfit(TRAVEL[side], values[side], 1)[0]) for side in sides]
    found = p._slopes(stroke({"f_out_N": -values, "f_in_N": values}), cut)
    assert found[0] == pytest.approx(steep[0])
    assert math.isnan(found[1]) if cut is None else found[1] == pytest.approx(steep[1])


def test_eight_samples_have_a_slope():
    eight = stroke({"f_in_N": 3.0 * TRAVEL[:8]}, TRAVEL[:8])
    assert p._slopes(eight, None)[0] == pytest.approx(3.0)
