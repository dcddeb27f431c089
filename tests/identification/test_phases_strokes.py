"""Strokes of a run: where they begin, how they are thinned, where a resting drive has turned."""

from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.identification import phases as p


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
