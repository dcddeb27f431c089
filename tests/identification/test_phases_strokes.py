"""Strokes of a run: where they begin, how they are thinned, where a resting drive has turned."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.identification import phases as p


def test_means_of_blocks_the_last_one_shorter():
    assert p._block_means(np.arange(7.0), 3).tolist() == [1.0, 4.0, 6.0]
    assert p._block_means(np.arange(4.0), 1).tolist() == [0.0, 1.0, 2.0, 3.0]


def run_of(x, turns=(), *, sd=0.01, noise=0.05, **measured):
    x = np.asarray(x, dtype=float)
    conditioned = SimpleNamespace(values=x, sd=np.full(x.size, sd), reversals=np.array(turns))
    return SimpleNamespace(
        conditioned={"x_in_mm": conditioned},
        measured=measured,
        noise=dict.fromkeys(measured, noise),
        time_s=0.1 * np.arange(x.size),
        drive_column="x_in_mm",
    )


def resting(way=1.0, noise=0.05, *, channel="f_in_N"):
    """A drive that goes, rests from sample 50 on and turns at 100; unloading begins at 70."""
    t = np.arange(140)
    x = way * np.interp(t, [0, 50, 100, 139], [0.0, 5.0, 5.0, 1.0])
    tension = way * np.interp(t, [0, 50, 70, 139], [25.0, 45.0, 45.0, 10.0])
    return run_of(x, (0, 100, 139), noise=noise, **{channel: tension})


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_resting_drive_has_turned_where_the_tension_does(way):
    """The mean of eight samples falls by 5/√8 of the noise some samples after 70."""
    found = p._start_of_unloading(resting(way), 100)
    assert 62 <= found <= 70
    assert p._start_of_unloading(resting(way, noise=1e6), 100) == 100


def test_elsewhere_the_drive_turns_where_it_says():
    assert p._start_of_unloading(resting(channel="f_out_N"), 100) == 100
    assert p._start_of_unloading(resting(), 139) == 139
    assert p._start_of_unloading(at_rest(1e-6, size=101), 100) == 100  # the last sample is no turn
    assert p._start_of_unloading(resting(), 0) == 0
    unknown, rests_at_once = at_rest(), at_rest(1e-6)
    unknown.measured["f_in_N"][60] = np.nan
    rests_at_once.conditioned["x_in_mm"].values[:100] = 5.0
    assert p._start_of_unloading(unknown, 100) == 100
    assert p._start_of_unloading(rests_at_once, 100) == 100


def test_strokes_go_from_turn_to_turn_and_cover_the_run():
    run = resting(channel="f_out_N")
    first, second = p._strokes(run)
    assert (first.first, first.end, second.first, second.end) == (0, 100, 100, 140)
    assert (first.up, second.up) == (True, False)
    x = run.conditioned["x_in_mm"].values
    np.testing.assert_allclose(second.travel, np.abs(x[100:] - x[100]))
    expected = run.measured["f_out_N"][100:] / 0.05
    np.testing.assert_allclose(second.channels["f_out_N"], expected)


def test_segments_in_a_file_end_where_the_next_one_begins():
    segments = [p.Segment(0, 50, "dead_band_up"), p.Segment(50, 140, "contraction")]
    told = p.segment_records(resting(), segments)
    assert [(s.start_s, round(s.end_s, 9), s.phase) for s in told] == [
        (0.0, 5.0, "dead_band_up"),
        (5.0, 13.9, "contraction"),
    ]


def at_rest(noise=0.05, sd=0.01, *, peak=70, size=140, turn=100):
    """A drive that rests from sample 50 on, 0.1 mm beyond the one before; f_in falls from `peak`.

    By half a newton a sample, from 45 N that it has reached at sample 40.
    """
    t = np.arange(size)
    x = np.interp(t, [0, 50, turn, turn + 39], [0.0, 5.0, 5.0, 1.0])
    tension = np.interp(t, [0, 40, peak, peak + 80], [25.0, 45.0, 45.0, 5.0])
    return run_of(x, sd=sd, noise=noise, f_in_N=tension)


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


@pytest.mark.parametrize(("samples", "step"), [(1199, 2), (1200, 3), (799, 1), (800, 2)])
def test_strokes_are_thinned_to_four_hundred_points_or_more(samples, step):
    x = np.arange(float(samples))
    values = np.where(np.isin(np.arange(samples), (0, samples - 1)), 3.0 * x, np.nan)
    once = np.where(np.arange(samples) == 7, 1.0, np.nan)
    run = run_of(x, (0, samples - 1), f_out_N=values, x_out_mm=once, f_in_N=0.0 * x + 2.0)
    run.noise = {"f_out_N": 0.5, "x_out_mm": 1.0, "f_in_N": 0.0}
    (found,) = p._strokes(run)
    assert set(np.diff(found.at)) == {step}
    assert set(found.channels) == {"f_out_N", "f_in_N"}  # of x_out a single sample is known
    first_mean = 6.0 * (step - 1) / 2.0  # of a line between two samples: 3 x/0.5
    assert found.channels["f_out_N"][:2] == pytest.approx([first_mean, first_mean + 6.0 * step])
    assert found.channels["f_in_N"][0] == pytest.approx(2e12)  # no noise counts as next to none


def test_a_tension_without_noise_has_turned_after_its_peak():
    assert 50 <= p._start_of_unloading(at_rest(0.0), 100) <= 63


def test_each_stroke_is_thinned_by_its_own_length():
    first, second = p._strokes(run_of([*range(1000), *range(1000, 500, -1)], (0, 1000, 1499)))
    assert (set(np.diff(first.at)), set(np.diff(second.at))) == ({2}, {1})


@pytest.mark.parametrize(
    ("x", "up"), [([0, -1, -2, 1], True), ([0, 1, 2, -1], False), ([0, 1, 2, 0], True)]
)
def test_the_way_of_the_last_stroke_is_told_by_the_last_sample(x, up):
    """A drive that comes back to where it was goes up."""
    assert [s.up for s in p._strokes(run_of(x, (0, 3)))] == [up]
