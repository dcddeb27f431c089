"""Phases against the rig's own knowledge of when the load end moves."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from tests.identification.recorded import ALL, clean, prepared, ran
from tsas_cli.identification import phases as p
from tsas_cli.identification.phases import segment
from tsas_studies.challenge.rig.motions import chirp, nested, sine, triangle, two_sines
from tsas_studies.challenge.rig.sensors import Sensor, Sensors
from tsas_studies.challenge.rig.tendon import Rig

RATE_HZ = 250.0
FINE = Sensors(rate_Hz=RATE_HZ)
COARSE = Sensors(
    rate_Hz=RATE_HZ,
    x_in_mm=Sensor(0.01, 0.01),
    x_out_mm=Sensor(0.01, 0.01),
    f_in_N=Sensor(0.3, 0.1),
    f_out_N=Sensor(0.3, 0.1),
)


def labels(run):
    out = np.full(run.time_s.size, "", dtype="U16")
    for part in segment(run):
        out[part.first : part.end] = part.phase
    return out


def truth(motion, rig):
    """Return what the load end does, and which way the drive goes."""
    columns = clean(rig, motion).columns
    up = np.gradient(columns["x_in_mm"]) > 0.0
    x_out, x_in = (np.abs(np.gradient(columns[name])) for name in ("x_out_mm", "x_in_mm"))
    moves = x_out > 0.02 * x_in
    slip = np.where(up, "contraction", "loosening")
    return np.where(moves, slip, np.where(up, "dead_band_up", "dead_band_down"))


@pytest.mark.parametrize(
    ("make", "sensors", "channels", "part"),
    [
        *((make, FINE, ALL, 0.96) for make in (sine, triangle, two_sines, chirp)),
        *((make, COARSE, ALL, 0.96) for make in (sine, triangle, two_sines, chirp)),
        (
            nested,
            FINE,
            ALL,
            0.93,
        ),  # where its loops turn in the dead band, nothing slips as a whole
        *((sine, FINE, (name,), 0.95) for name in ALL),  # one channel is enough
    ],
)
def test_phases_are_those_of_the_rig(make, sensors, channels, part):
    motion = make(rate_Hz=RATE_HZ)
    run = prepared(Rig(), motion, channels=channels, sensors=sensors)
    assert np.mean(labels(run) == truth(motion, Rig())) > part


def test_noise_does_not_make_phases_chatter():
    """Two cycles have at most nine segments, whatever the noise."""
    motion = sine(rate_Hz=RATE_HZ)
    for seed in range(5):
        assert len(segment(prepared(Rig(), motion, sensors=COARSE, seed=seed))) <= 9


def test_motion_inside_the_dead_band_is_not_called_slip():
    small = sine(amplitude_mm=0.02, rate_Hz=RATE_HZ)
    sensors = Sensors(rate_Hz=RATE_HZ, x_in_mm=Sensor(2e-4))
    run = prepared(Rig(), small, channels=ALL, sensors=sensors)
    assert not {"contraction", "loosening"} & set(labels(run))


@pytest.mark.parametrize("seed", range(3))
def test_a_drive_that_stands_still_while_it_unloads_is_in_the_dead_band(seed):
    """At the top of a sine the encoder creeps on by less than shows; the tension falls already."""
    motion = sine(periods=1.0)
    run = prepared(Rig(), motion)
    top = int(np.argmax(motion.x_in_mm))
    order = np.r_[:top, np.repeat(top, 1000), top : motion.time_s.size]
    rests = slice(top, top + 1000)
    x_in = motion.x_in_mm[order] + np.random.default_rng(seed + 4).normal(0.0, 0.005, order.size)
    x_in[rests] += np.linspace(0.0, 1e-3, 1000)
    f_in = run.measured["f_in_N"][order]
    f_in[rests] -= np.linspace(0.0, 10.0, 1000)
    columns = {"time_s": np.arange(order.size) / 1000.0, "x_in_mm": x_in, "f_in_N": f_in}
    found = labels(ran(columns, preload_N=25.0))
    assert np.mean(found[rests] == "dead_band_down") > 0.7
    assert np.mean(found[top - 700 : top - 50] == "contraction") > 0.9


@pytest.mark.parametrize("left", range(2, 12))
def test_a_run_may_end_right_after_a_reversal(left):
    """The last stroke has fewer samples than a law is fitted to, and the tension has peaked."""
    x_in = np.concatenate((np.linspace(0.0, 5.0, 100), 5.0 - 0.3 * np.arange(1, left)))
    f_in = 20.0 + 4.0 * x_in + np.random.default_rng(1).normal(0.0, 0.01, x_in.size)
    columns = {"time_s": np.arange(x_in.size) / 100.0, "x_in_mm": x_in, "f_in_N": f_in}
    parts = segment(ran(columns, preload_N=25.0))
    assert [part.end for part in parts] == [*(part.first for part in parts[1:]), x_in.size]
    assert all(part.first < part.end for part in parts)
    assert abs(parts[-1].first - 99) <= 1


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
    phases = ("dead_band_down", "dead_band_up", "loosening", "contraction", "loosening")
    assert found[2:] == [(10 * k, 10 * k + 10, phase) for k, phase in enumerate(phases, start=1)]


def test_what_no_slope_tells_is_unknown(cut_as):
    alone = (None, (math.nan, math.nan))
    assert cut_as(BOTH, alone)[-1] == (10, 20, "unknown")
    steep = (None, (200.0, math.nan))
    assert cut_as(steep, steep) == [(0, 10, "unknown"), (10, 20, "unknown")]


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


@pytest.mark.parametrize(
    ("x", "up"), [([0, -1, -2, 1], True), ([0, 1, 2, -1], False), ([0, 1, 2, 0], True)]
)
def test_the_way_of_the_last_stroke_is_told_by_the_last_sample(x, up):
    """A drive that comes back to where it was goes up."""
    assert [s.up for s in p._strokes(run_of(x, (0, 3)))] == [up]


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


def test_a_drive_that_slows_down_slips_along_a_line_too():
    """Samples that lie closer and closer: what is straight is so over travel, not over time."""
    travel = 12.0 * np.sin(np.linspace(0.0, 1.4, N))
    values = np.where(np.arange(N) < CUT, 0.0, 40.0 * (travel - travel[CUT]))
    assert abs(p._transition(stroke({"f_out_N": values}, travel)) - CUT) <= 1


def test_a_load_that_moves_slips():
    """Its slope counts inverted: a load that stands quite still is in the dead band."""
    load = np.where(TRAVEL[CUT] > TRAVEL, 0.0, -4.0 * (TRAVEL - TRAVEL[CUT]))
    before, after = p._slopes(stroke({"x_out_mm": load}), CUT)
    assert before > 1e9
    assert after == pytest.approx(1.0 / 4.0)
