"""Which samples agree with a source, which stretch of them is evidence, and how it is said."""

import math
from itertools import pairwise

import numpy as np
import pytest

from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.pieces import Piece
from tsas_cli.recordings.quality.copies.agreement import (
    Copy,
    RowSpan,
    RunSamples,
    agreement,
    aligned,
    contradictions,
    joined,
    stretches,
)
from tsas_cli.recordings.quality.copies.fingerprint import (
    Fineness,
    _crowd,
    fingerprint,
    side_by_side,
)
from tsas_cli.recordings.quality.copies.lookup import BINS, Lookup, _Bins

T = np.arange(40.0)
CURVES = np.column_stack((np.sin(0.3 * T), 5.0 * np.cos(0.2 * T)))
SOURCE = RunSamples(T, CURVES)
TOLERANCE = np.array([1e-3, 5e-3])


def at(moments):
    return np.column_stack((np.sin(0.3 * moments), 5.0 * np.cos(0.2 * moments)))


@pytest.mark.parametrize("off", [0.0, 0.99, -0.99, 1.01, -1.01])
@pytest.mark.parametrize("channel", [0, 1])
def test_samples_agree_within_the_tolerance_of_every_channel(off, channel):
    """With a sample of the source itself, then with its straight line between two."""
    own = CURVES[3:6].copy()
    between = 0.25 * CURVES[10:13] + 0.75 * CURVES[11:14]
    values = np.vstack((own, between))
    values[:, channel] += off * TOLERANCE[channel]
    moments = np.concatenate((T[3:6], T[10:13] + 0.75))
    found = agreement(SOURCE, RunSamples(moments, values), TOLERANCE)
    expected = abs(off) < 1.0
    assert (found.agrees == expected).all()
    assert (found.differs != expected).all()
    assert found.exact.tolist() == [expected] * 3 + [False] * 3
    assert (found.compared == expected).all()
    if expected:
        assert found.at[:3].tolist() == [3, 4, 5]


def test_a_sample_near_the_next_one_is_that_one_and_beyond_the_ends_there_is_none():
    moments = np.array([-0.4, -0.6, 2.3, 39.4, 39.6])
    values = CURVES[[0, 0, 3, 39, 39]]
    found = agreement(SOURCE, RunSamples(moments, values), TOLERANCE)
    assert found.agrees.tolist() == [True, False, True, True, False]
    assert found.at[found.agrees].tolist() == [0, 3, 39]
    assert found.exact.tolist() == found.agrees.tolist()


def test_beside_a_gap_what_is_left_is_compared_and_where_nothing_is_left_nothing_differs():
    values = CURVES.copy()
    values[5, 0], values[9] = np.nan, np.nan
    gaps = RunSamples(T, values)
    here = RunSamples(T[[5, 8, 9]], CURVES[[5, 8, 9]])
    found = agreement(gaps, here, TOLERANCE)
    assert found.agrees.tolist() == [True, True, False]
    assert not found.differs.any()
    assert found.compared.tolist() == [[False, True], [True, True], [False, False]]


@pytest.mark.parametrize("shift_s", [-0.4, 0.0, 0.3])
def test_a_shift_is_found_by_either_curve(shift_s):
    """A spline through the source is the motion, to within 1e-4; a line goes through its own."""
    moments = T[8:30] + 0.35
    smooth = RunSamples(moments - shift_s, at(moments))
    assert aligned(SOURCE, smooth, TOLERANCE, spline=True) == pytest.approx(shift_s, abs=1e-4)
    line = np.column_stack([np.interp(moments, T, each) for each in CURVES.T])
    straight = RunSamples(moments - shift_s, line)
    assert aligned(SOURCE, straight, TOLERANCE, spline=False) == pytest.approx(shift_s, abs=1e-6)
    moved = smooth.moved(shift_s)
    assert agreement(SOURCE, moved, TOLERANCE, spline=True).agrees.all()
    assert not agreement(SOURCE, moved, TOLERANCE).agrees.all()


def test_what_is_steeper_counts_more_for_a_shift():
    """Two lines that ask for shifts of 1 and 0 at slopes of 2 and 1: (4·1 + 1·0)/5."""
    ramps = RunSamples(T, np.column_stack((2.0 * T, T)))
    asked = RunSamples(T[9:12], np.column_stack((2.0 * (T[9:12] + 0.1), T[9:12])))
    assert aligned(ramps, asked, np.ones(2), spline=False) == pytest.approx(0.08)
    flat = RunSamples(T, np.ones((40, 1)))
    assert aligned(flat, flat.part(slice(3, 9)), np.ones(1), spline=False) == 0.0


def test_a_stretch_is_evidence_by_what_its_changing_samples_say():
    """Each channel by 1 nat, 2.5 per sample at most; 40 are asked for."""
    rows = 60
    values = np.column_stack((np.arange(rows), np.arange(rows), np.arange(rows), np.zeros(rows)))
    samples = RunSamples(0.1 * np.arange(rows), values.astype(float))
    source = RunSamples(samples.time_s, samples.values.copy())
    source.values[33] += 9.0

    def found(*nats):
        told = agreement(source, samples, np.full(4, 0.1))
        return [(s.first, s.end) for s, _ in stretches(100, samples, told, np.array([*nats, 9.0]))]

    assert found(1.0, 0.3, 0.0) == [(100, 133)]  # 32 changes of 1.3; of the other part 26
    assert found(1.0, 0.24, 0.0) == []
    assert found(1.0, 0.6, 0.0) == [(100, 133), (134, 160)]
    assert found(9.0, 0.0, 0.0) == [(100, 133), (134, 160)]
    (first, every), _ = stretches(
        100, samples, agreement(source, samples, np.full(4, 0.1)), np.full(4, 1.0)
    )
    assert (first.begin_s, first.end_s, every) == (0.0, pytest.approx(3.2), 1)
    third = samples.part(slice(1, None, 3))
    told = agreement(source, third, np.full(4, 0.1))
    assert [e for _, e in stretches(0, third, told, np.full(4, 9.0))] == [3]


def test_stretches_are_one_if_a_hundredth_differs_between_them():
    spans = [RowSpan(0, 99, 0.0, 9.8), RowSpan(101, 202, 10.1, 20.1), RowSpan(206, 306, 20.6, 30.5)]
    found = joined([(span, k) for k, span in enumerate(spans, 1)])
    assert [(s.first, s.end, s.begin_s, s.end_s, e) for s, e in found] == [
        (0, 202, 0.0, 20.1, 1),
        (206, 306, 20.6, 30.5, 3),
    ]
    assert (spans[1].rows, spans[1].duration_s) == (101, pytest.approx(10.0))


def run(name, **told):
    return Run(id=name, file=f"{name}.parquet", sha256="0" * 64, **told)


def test_conditions_differ_by_more_than_a_thousandth():
    one = run("a", preload_N=25.0, total_bend_rad=3.1416)
    assert contradictions(one, run("b", preload_N=25.02, total_bend_rad=math.pi)) == ()
    other = run("b", preload_N=25.03, load="force", temperature_C=20.0)
    assert contradictions(one, other) == ("preload_N", "load")
    said = Copy(one, other, *[RowSpan(0, 9, 0.0, 8.0)] * 3, contradicts=("preload_N",))
    assert said.contradiction == (", but the manifest says preload_N = 25 here and 25.03 there")


WHOLE = RowSpan(0, 1000, 0.0, 10.0)


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ({}, "holds the samples of run b"),
        ({"shift_s": 0.0099}, "holds the samples of run b"),  # less than a sample
        ({"shift_s": 0.0101}, "holds the samples of run b, its time shifted by -0.0101 s"),
        ({"shift_s": -2.5}, "holds the samples of run b, its time shifted by 2.5 s"),
        ({"every": 2}, "holds every 2nd sample of run b"),
        ({"every": 4}, "holds every 4th sample of run b"),
        ({"every": 11}, "holds every 11th sample of run b"),
        ({"every": 112}, "holds every 112th sample of run b"),
        ({"every": 0}, "holds the samples of run b, resampled at 99.9 Hz"),
        (
            {"span": RowSpan(100, 1000, 1.0, 10.0), "shift_s": 3.0},
            "holds, from 1 s to 10 s, the samples of run b from 4 s to 13 s",
        ),
        (
            {"all_of_other": RowSpan(0, 2000, 0.0, 20.0), "shift_s": 3.0},
            "holds the samples of run b from 3 s to 13 s",
        ),
    ],
)
def test_a_copy_is_said_with_what_it_holds(how, said):
    told = {"span": WHOLE, "all_of_run": WHOLE, "all_of_other": WHOLE} | how
    assert Copy(run("a"), run("b"), **told).sentence == said


@pytest.mark.parametrize(("step", "rounding"), [(0.0, 0.0), (0.1, 0.05), (0.2, 0.1), (0.21, 0.0)])
def test_a_tolerance_is_a_twentieth_of_the_noise_and_half_a_step_below_it(step, rounding):
    fine = Fineness(noise=0.2, step=0.01, largest=5e3, span=9.0, noisy=True)
    assert fine.tolerance(step) == pytest.approx(0.01 + 1e-3 + rounding)


@pytest.mark.parametrize("step", [0.0, 0.1])
def test_a_repeat_agrees_by_chance_as_noise_does(step):
    """Two normal deviates are within d of each other by 2 d/(2 √π σ), at three candidates."""
    fine = Fineness(noise=0.4, step=step, largest=1.0, span=9.0, noisy=True)
    rng = np.random.default_rng(3)
    apart = np.abs(0.4 * np.diff(rng.standard_normal((2, 400_000)), axis=0))
    within = max(0.02, 0.5 * step)
    assert math.exp(-fine.information(0.02)) == pytest.approx(
        3.0 * float(np.mean(apart < within)), rel=0.03
    )
    silent = Fineness(0.4, step, 1.0, 9.0, noisy=False)
    assert silent.information(0.02) == pytest.approx(-math.log(0.95))
    assert fine.information(9.0) == pytest.approx(-math.log(0.95))


def test_a_crowd_is_how_many_samples_share_a_level():
    """Of 1024 levels over the span."""
    values = np.array([0.0, 0.0005, 0.5, 0.5004, 0.5, 1.0])
    assert _crowd(values).tolist() == [2, 2, 3, 3, 3, 1]
    assert _crowd(np.full(4, 7.0)).tolist() == [4] * 4


@pytest.mark.parametrize("wide", [0.0, 0.05, 2.0])
def test_the_segment_of_a_value_is_found_in_its_bin(wide):
    """Each of the two values in the emptiest bins with every segment that covers it."""
    rng = np.random.default_rng(2)
    lower = np.concatenate(([-3.0], 10.0 * rng.random(500)))
    upper = lower + wide + 0.01 * rng.random(501)
    bins = _Bins(lower, upper, 7 * np.arange(501))
    values = rng.uniform(lower.min(), upper.max(), (40, 5))
    values[0], values[1], values[2] = lower[0], -3.1, 99.0
    found = {}
    for stretch, row, piece in bins.looked_up(values):
        for s, r, p in zip(stretch.tolist(), row.tolist(), piece.tolist(), strict=True):
            found.setdefault((s, r), []).append(p // 7)
    for (s, r), segments in found.items():
        assert len(set(segments)) == len(segments)
        covers = np.flatnonzero((lower <= values[s, r]) & (values[s, r] <= upper))
        assert set(covers.tolist()) <= set(segments)
        apart = np.maximum(lower[segments] - values[s, r], values[s, r] - upper[segments])
        assert apart.max() <= bins.width
    assert found[0, 0] == [0]  # the lowest of all
    assert not any((s, r) in found for s in (1, 2) for r in range(5))
    assert bins.width >= (upper.max() - lower.min()) / BINS
    assert np.bincount([s for s, _ in found], minlength=40).max() <= 2


@pytest.mark.parametrize("shift_s", [-7.3, 0.0, 11.6])
def test_stretches_are_found_at_their_shift_alone(shift_s):
    rng = np.random.default_rng(4)
    t = 0.1 * np.arange(4000)
    noise = np.full(2, 0.1)
    values = 20.0 * np.column_stack((np.sin(t), np.cos(0.7 * t)))
    values += 0.1 * rng.standard_normal((4000, 2))
    lookup = Lookup(RunSamples(t, values), 0.05 * noise, noise)
    rows = np.array([300, 2200])[:, None] + np.arange(16)
    ours, strange = values[rows], values[rows] + 0.1 * rng.standard_normal((2, 16, 2))
    found = list(lookup.shifts(t[rows] - shift_s, ours))
    assert sorted(number for number, _ in found) == [0, 1]
    assert [s.seconds for _, s in found] == pytest.approx([shift_s] * 2, abs=1e-6)
    assert not any(s.spline for _, s in found)
    assert list(lookup.shifts(t[rows], strange)) == []


def piece(start=0, stop=2000, **changes):
    """Return rows of a run at 100 Hz: a noisy channel, one with coarse steps, one at rest."""
    rng = np.random.default_rng(9)
    t = 5.0 + 0.01 * np.arange(2000)
    columns = {"time_s": t, "x_in_mm": 4.0 * np.sin(t) - 20.0 + 0.1 * rng.standard_normal(2000)}
    columns["f_in_N"] = 0.5 * np.round(2.0 * (30.0 + np.cos(t) + 0.12 * rng.standard_normal(2000)))
    columns |= {"f_out_N": np.full(2000, 7.0)} | changes
    return Piece(start, {name: values[start:stop] for name, values in columns.items()})


@pytest.mark.parametrize("cuts", [(), (700,), (512, 1500)])
def test_a_fingerprint_is_that_of_the_run_however_it_is_cut(cuts):
    ends = [0, *cuts, 2000]
    found = fingerprint(run("a"), [piece(a, b) for a, b in pairwise(ends)])
    whole = piece().columns
    assert (found.all.rows, found.all.begin_s, found.all.end_s) == (2000, 5.0, pytest.approx(24.99))
    assert found.interval_s == pytest.approx(0.01)
    assert (set(found.channels), set(found.dense)) == ({"x_in_mm", "f_in_N"},) * 2
    assert found.increases
    assert not found.interpolated
    x, f = found.channels["x_in_mm"], found.channels["f_in_N"]
    assert x.noise == pytest.approx(0.1, rel=0.1)
    assert (x.largest, x.span) == (np.abs(whole["x_in_mm"]).max(), np.ptp(whole["x_in_mm"]))
    assert (f.step, f.largest) == (pytest.approx(0.5), whole["f_in_N"].max())
    assert (x.noisy, f.noisy, found.noisy) == (True, False, True)
    assert found.stretches.shape == (3 * len(ends) - 3, 16, 2)
    rows = np.rint((found.stretches_s - 5.0) / 0.01).astype(int)
    first = found.dense.index("x_in_mm")
    np.testing.assert_array_equal(found.stretches[:, :, first], whole["x_in_mm"][rows])
    assert (rows[0, 0], rows[-1, -1]) == (0, 1999)


def test_a_run_whose_time_stands_still_or_that_was_interpolated_is_known_as_such():
    still = piece().columns["time_s"].copy()
    still[900] = still[899]
    assert not fingerprint(run("a"), [piece(time_s=still)]).increases
    line = np.interp(np.arange(2000.0), np.arange(0, 2001, 10), WALK)
    assert fingerprint(run("a"), [piece(x_in_mm=line)]).interpolated


WALK = np.cumsum(np.random.default_rng(2).standard_normal(201))


@pytest.mark.parametrize(
    ("ours", "theirs"), [((), ()), ((700,), (300, 1100)), ((90, 1800), (1000,))]
)
def test_every_sample_meets_those_of_the_source_around_it(ours, theirs):
    """Cut in any way; by 32 rows on either side, where there are so many."""
    cut = [[piece(a, b) for a, b in pairwise([0, *cuts, 2000])] for cuts in (ours, theirs)]
    met = list(side_by_side(iter(cut[0]), iter(cut[1]), ("f_in_N", "x_in_mm"), 0.5))
    times = np.concatenate([now.time_s for _, now, _ in met])
    np.testing.assert_allclose(times, piece().columns["time_s"] + 0.5)
    values = np.concatenate([now.values for _, now, _ in met])
    np.testing.assert_array_equal(values[:, 1], piece().columns["x_in_mm"])
    assert [row for row, _, _ in met] == np.cumsum([0, *(n.time_s.size for _, n, _ in met)])[
        :-1
    ].tolist()
    last = piece().columns["time_s"][-1]
    for _, now, near in met:
        begin, end = now.time_s[[0, -1]]
        assert near.time_s[0] <= min(max(begin - 0.31, 5.0), last)
        assert near.time_s[-1] >= min(end + 0.3, last) - 1e-9
