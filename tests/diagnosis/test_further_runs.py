"""Runs that might be added: when, on which rig and with which sensors they are recorded."""

from datetime import datetime, timedelta
from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.diagnosis import further_runs as f

NOON = datetime(2001, 2, 3, 12)  # noqa: DTZ001 # a rig has no zone


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
