"""Recordings of runs that nobody has made, on a rig that answers a constant."""

from datetime import datetime, timedelta
from types import SimpleNamespace

import numpy as np
import pytest

from tests.diagnosis.planned import run
from tsas_cli.diagnosis import simulated_runs
from tsas_cli.diagnosis.further_runs import _clock
from tsas_cli.diagnosis.motions import motion
from tsas_cli.diagnosis.rig_file import Sensors
from tsas_cli.support.errors import InputError

BEGIN = datetime(2001, 2, 3, 4, 5)  # noqa: DTZ001 # a rig has no zone
SENSORS = Sensors(rate_Hz=100.0, x_in_mm=0.02, f_in_N=0.1, x_out_mm=0.5)


@pytest.fixture
def made(monkeypatch):
    def simulate(rig, drive):
        there = np.ones(drive.values.size)
        return SimpleNamespace(f_in_N=30.0 * there, f_out_N=20.0 * there, x_out_mm=3.0 * there)

    monkeypatch.setattr(simulated_runs, "simulate", simulate)
    return lambda *runs, **how: simulated_runs.simulated_recordings(
        runs, SENSORS, lambda run: None, BEGIN, **how
    )


def test_each_channel_has_its_noise_and_what_is_not_measured_is_not_there(made):
    (recording,) = made(run(5.0))
    assert set(recording.columns) == {"time_s", "x_in_mm", "f_in_N", "x_out_mm"}
    t, x = motion(
        "sine", amplitude_mm=10.0, speed_mm_per_s=5.0, periods=6, dwell_s=0.0, rate_Hz=100.0
    )
    np.testing.assert_array_equal(recording.columns["time_s"], t)
    noises = {
        "x_in_mm": recording.columns["x_in_mm"] - x,
        "f_in_N": recording.columns["f_in_N"] - 30.0,
        "x_out_mm": recording.columns["x_out_mm"] - 3.0,
    }
    for (name, noise), sd in zip(noises.items(), (0.02, 0.1, 0.5), strict=True):
        assert noise.std() == pytest.approx(sd, rel=0.05), name
        assert abs(noise.mean()) < 0.1 * sd
    alike = np.corrcoef(list(noises.values())) - np.eye(3)
    assert np.abs(alike).max() < 0.05


def test_runs_follow_each_other_five_minutes_apart(made):
    """A sine of 10 mm at 5 mm/s takes 2π · 10/5 s, in whole hundredths."""
    first, second = made(run(5.0, periods=1), run(5.0, "b", periods=1))
    assert first.run.started == BEGIN
    assert second.run.started == BEGIN + timedelta(seconds=12.56, minutes=5)
    assert (first.run.id, second.run.file) == ("a", "runs/b.parquet")
    assert second.run.preload_N == 25.0


def test_the_same_plan_gives_the_same_numbers_and_another_seed_others(made):
    (first,), (again,) = made(run(5.0, periods=1)), made(run(5.0, periods=1))
    (other,) = made(run(5.0, periods=1), seed=5)
    np.testing.assert_array_equal(first.columns["f_in_N"], again.columns["f_in_N"])
    assert not np.array_equal(first.columns["f_in_N"], other.columns["f_in_N"])


def planned(speed, **other):
    return run(speed, **{"periods": 2} | other)


@pytest.mark.parametrize(
    ("runs", "fits"),
    [
        # 80 mm at 100 Hz, for half sines twice there and back: a million samples at 0.0251 mm/s.
        (planned(0.0252), True),
        (planned(0.0251), False),
        (planned(0.0126, periods=1), True),
        (planned(0.0125, periods=1), False),
        # Two periods of eight rests at the most, each below 625 s.
        (planned(80000.0, dwell_s=624.9), True),
        (planned(80000.0, dwell_s=625.1), False),
    ],
)
def test_a_run_that_would_take_too_many_samples_is_refused(runs, fits):
    if fits:
        t, x = simulated_runs._moved(runs, 100.0)
        assert t.size == x.size < 1_000_000
    else:
        with pytest.raises(InputError, match="run a would take more than 1000000 samples"):
            simulated_runs._moved(runs, 100.0)


def test_a_further_run_begins_five_minutes_after_the_last_one_ended():
    """The second of two runs began an hour after the first, and lasted 90 s."""

    def recorded(session_s, started=BEGIN + timedelta(hours=1)):
        times = np.array([3.0, 93.0])
        return SimpleNamespace(
            session_s=session_s, time_s=times, run=SimpleNamespace(started=started)
        )

    first, last = recorded(0.0, BEGIN), recorded(3600.0)
    for runs in ((first, last), (last, first)):
        assert _clock(runs) == (BEGIN, BEGIN + timedelta(hours=1, seconds=90, minutes=5))
    assert _clock((first,))[0] is None
    assert _clock((recorded(60.0, None),))[0] is None
