"""Runs that might be added: when, on which rig and with which sensors they are recorded."""

from datetime import datetime, timedelta
from types import SimpleNamespace

import numpy as np
import pytest

from tests.physics.references import GROUP_A
from tsas_cli.diagnosis import further_runs as f
from tsas_cli.diagnosis.candidates import candidates
from tsas_cli.diagnosis.rig_file import Limits, Sensors
from tsas_cli.recordings.manifest import Run

NOON = datetime(2001, 2, 3, 12)  # noqa: DTZ001 # a rig has no zone
CANDIDATES = candidates(Limits(amplitude_mm=10.0, speed_mm_per_s=24.0), GROUP_A)


def recorded(run_id="a", started=NOON, session_s=0.0, time_s=(3.0, 3.1, 3.3, 63.0), **other):
    return SimpleNamespace(
        **{
            "run": SimpleNamespace(id=run_id, started=started, load="spring"),
            "session_s": session_s,
            "time_s": np.array(time_s),
            "drive_column": "x_in_mm",
            "noise": {"f_in_N": 0.2, "x_out_mm": 0.0},
            "conditioned": {"x_in_mm": SimpleNamespace(noise=0.04)},
        }
        | other
    )


def test_the_clock_goes_on_after_the_last_run():
    """It begins at 12 h, an hour after the session did, lasts a minute, and five follow."""
    runs = [recorded(session_s=3600.0), recorded("b", None, 100.0)]
    assert f._clock(runs) == (NOON - timedelta(hours=1), NOON + timedelta(minutes=6))
    assert f._clock(runs[::-1]) == f._clock(runs)


@pytest.mark.parametrize("last", [recorded(session_s=0.0), recorded(started=None, session_s=9.0)])
def test_without_a_clock_there_is_none(last):
    began, goes_on = f._clock([last])
    assert began is None
    assert isinstance(goes_on, datetime)


def test_each_is_recorded_right_after_the_last_run_with_noise_of_its_own(monkeypatch):
    asked = []

    def made(runs, sensors, rig_of, started, *, seed):
        asked.append((runs[0], sensors, rig_of, started, seed))
        return [f"recorded {runs[0].id}"]

    monkeypatch.setattr(f, "simulated_recordings", made)
    monkeypatch.setattr(f, "prepare", lambda recording, began: (recording, began))
    sensors = Sensors(rate_Hz=100.0, x_in_mm=0.02, f_in_N=0.1)
    out = f.simulated_candidates(CANDIDATES, sensors, GROUP_A, [recorded(session_s=60.0)])
    assert [candidate for candidate, _ in out] == CANDIDATES
    began = NOON - timedelta(minutes=1)
    assert [run for _, run in out] == [(f"recorded {c.run.id}", began) for c in CANDIDATES]
    assert {started for *_, started, _ in asked} == {NOON + timedelta(minutes=6)}
    assert [run for run, *_ in asked] == [c.run for c in CANDIDATES]
    assert len({seed for *_, seed in asked}) == len(CANDIDATES)

    rig_of = asked[0][2]
    said = {"sheath_length_mm": 500.0, "total_bend_rad": 0.0, "preload_N": 9.0}
    there = Run(id="a", file="a", sha256="0" * 64, **said)
    assert rig_of(there) == GROUP_A._replace(**said)
    nothing = Run(id="a", file="a", sha256="0" * 64)
    assert rig_of(nothing) == GROUP_A
