"""A run made ready: gaps, noise, steps and what drives it, on columns of a few samples."""

import math
from datetime import UTC, datetime
from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.identification import prepared as p
from tsas_cli.numerics.noise import recorded
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.recording import Recording

NAN = math.nan


def entry(**told):
    return Run(id="a", file="a.parquet", sha256="0" * 64, **told)


@pytest.mark.parametrize(("apart_s", "gap"), [(2.0, [3]), (1.49, []), (1.51, [3])])
def test_a_gap_is_longer_than_one_and_a_half_samples_and_holds_its_rows(apart_s, gap):
    time_s = np.arange(8.0)
    time_s[4:] += apart_s - 2.0
    values = np.array([1.0, 2.0, 3.0, NAN, 5.0, 6.0, 7.0, 8.0])
    assert np.flatnonzero(p._in_gap(time_s, values)).tolist() == gap


@pytest.mark.parametrize(
    ("known", "gap"),
    [
        (slice(2, 5), [0, 1, *range(5, 12)]),  # before the first value and after the last
        (slice(None, None, 3), [10, 11]),  # a slow column has none between its samples
    ],
)
def test_where_a_column_is_known_there_is_no_gap(known, gap):
    values = np.full(12, NAN)
    values[known] = 1.0
    assert np.flatnonzero(p._in_gap(np.arange(12.0), values)).tolist() == gap


def test_a_run_begins_at_the_line_through_its_first_twenty_samples():
    """3 + 2 t from t = 5 s on: what comes later, and what is missing, does not count."""
    time_s = 5.0 + 0.1 * np.arange(40)
    values = 3.0 + 2.0 * (time_s - 5.0)
    values[20:] = 100.0
    values[[0, 7]] = NAN
    assert p._start_value(time_s, values) == pytest.approx(3.0)
    values[19] += 1.0
    assert p._start_value(time_s, values) != pytest.approx(3.0)
    values[2:] = NAN
    assert p._start_value(time_s, values) is None
    values[0] = 3.0
    assert p._start_value(time_s, values) == pytest.approx(3.0)


CONDITIONED = {
    "x_in_mm": SimpleNamespace(
        values=np.arange(30.0), noise=0.1, window_s=0.25, reversals=np.array([0, 9, 29])
    ),
    "f_out_N": SimpleNamespace(
        values=7.0 * np.ones(30), noise=0.0, window_s=0.0, reversals=np.array([0])
    ),
}
F_IN = {"f_in_N": 5.0 + np.zeros(30)}


def ready(*, run=None, drive="x_in_mm", conditioned=CONDITIONED, measured=F_IN, noise=None):
    return p.Prepared(
        run or entry(load="force"),
        10.0 + 0.1 * np.arange(30),
        drive,
        conditioned,
        measured,
        np.zeros(30, bool),
        session_s=60.0,
        all_noise=noise,
    )


def test_what_drives_a_run():
    drive = ready().drive
    assert drive.values.tolist() == list(range(30))
    assert (drive.kind, drive.load, drive.session_s) == ("displacement", "force", 60.0)
    assert drive.load_values.tolist() == [7.0] * 30
    assert drive.start_f_in_N == pytest.approx(5.0)
    assert drive.time_s[[0, 1]] == pytest.approx([0.0, 0.1])
    by_force = {"f_in_N": SimpleNamespace(values=np.ones(30))}
    forced = ready(run=entry(), drive="f_in_N", conditioned=by_force).drive
    assert (forced.kind, forced.load, forced.load_values) == ("force", "spring", None)
    assert forced.start_f_in_N is None  # a tension that drives tells no start
    assert ready(measured={"x_out_mm": np.ones(30)}).drive.start_f_in_N is None


def test_a_run_begins_seconds_after_the_first_of_its_dataset():
    first, later = datetime(2025, 1, 1, tzinfo=UTC), datetime(2025, 1, 1, 0, 2, tzinfo=UTC)
    assert p.seconds_into(first, later) == 120.0
    assert p.seconds_into(None, later) == p.seconds_into(first, None) == 0.0


def recording(**columns):
    n = 40
    rng = np.random.default_rng(1)
    usual = {
        "time_s": 0.1 * np.arange(n),
        "x_in_mm": np.sin(np.arange(n)) + 0.01 * rng.standard_normal(n),
        "f_in_N": rng.standard_normal(n),
        "x_out_mm": rng.standard_normal(n),
        "motor_speed_rpm": np.ones(n),
    }
    return Recording(entry(), {k: v for k, v in (usual | columns).items() if v is not None})


def test_channels_that_hold_anything_outside_gaps_are_measured():
    only_in_gap = np.full(40, NAN)
    only_in_gap[[5, 6]] = 1.0
    x = recording().columns["x_in_mm"].copy()
    x[4:8] = NAN
    run = p.prepare(recording(x_in_mm=x, f_out_N=only_in_gap))
    assert list(run.measured) == ["f_in_N", "x_out_mm"]
    assert np.flatnonzero(run.in_gap).tolist() == [4, 5, 6, 7]
    assert (run.drive_column, list(run.conditioned)) == ("x_in_mm", ["x_in_mm"])
    assert (run.every, run.all_rows, run.session_s) == (1, 0, 0.0)


def test_two_numbers_are_enough_to_drive():
    two = np.full(40, NAN)
    two[[3, 9]] = 1.0, 2.0
    assert p.prepare(recording(x_in_mm=two)).drive_column == "x_in_mm"
    two[9] = NAN
    with pytest.raises(p.InputError, match="column x_in_mm is empty"):
        p.prepare(recording(x_in_mm=two))


def test_what_drives_a_tendon_and_its_load():
    assert p.driving_columns(entry(), ["f_in_N", "x_in_mm"]) == ["x_in_mm"]
    assert p.driving_columns(entry(), ["f_in_N", "f_out_N"]) == ["f_in_N"]
    assert p.driving_columns(entry(load="force"), ["x_in_mm", "f_out_N"]) == ["x_in_mm", "f_out_N"]
    both = p.driving_columns(entry(load="displacement"), ["f_in_N", "x_out_mm"])
    assert both == ["f_in_N", "x_out_mm"]


def test_what_was_laid_between_samples_is_nothing_recorded():
    values = np.interp(np.arange(60), np.arange(0, 60, 3), np.random.default_rng(2).random(20))
    found = recorded(values)
    assert np.isnan(found).any()
    kept = np.isfinite(found)
    np.testing.assert_array_equal(found[kept], values[kept])
    white = np.random.default_rng(2).random(60)
    np.testing.assert_array_equal(recorded(white), white)


@pytest.mark.parametrize(("other", "drives"), [(0.19, True), (0.21, False)])
def test_a_motor_drives_where_its_angle_explains_all_but_a_fifth(other, drives):
    """x_in = 0.2 times the angle, and a wave of its own of so much of its standard deviation."""
    turn = 2.0 * np.pi * np.arange(400) / 200.0
    angle, own = 5.0 + 30.0 * np.sin(turn), 6.0 * other / math.sqrt(1.0 - other**2)
    time_s, x_in = turn.copy(), SimpleNamespace(values=6.0 * np.sin(turn) + own * np.cos(turn))
    found = p._motor(time_s, angle, x_in)
    assert (found is not None) == drives
    if drives:
        np.testing.assert_allclose(found, 0.2 * angle, atol=0.01)
    unknown = np.where(np.arange(400) == 7, NAN, angle)
    for none in ((None, x_in), (angle, None), (unknown, x_in), (np.ones(400), x_in)):
        assert p._motor(time_s, *none) is None
