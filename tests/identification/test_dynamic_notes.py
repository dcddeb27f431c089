"""What the dynamic model says of its own answer, at each of its limits."""

from types import SimpleNamespace

import numpy as np
import pytest

from tests.physics.references import TABLE_1
from tsas_cli.identification import comparison as d
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model
from tsas_cli.physics.lugre.start import bristles_of
from tsas_cli.physics.phases import UNCONVERGED
from tsas_cli.recordings.manifest import Run

KNOWN = Model((Estimate("bristles.stiffness_N_per_mm", 4e3, "N/mm", "fitted"),))
RUN = SimpleNamespace(
    run=Run(id="a", file="a.parquet", sha256="0" * 64), time_s=0.5 * np.arange(8), drive=None
)


def notes(monkeypatch, *, model=KNOWN, steps=80, unsettled=(), unstable=()):
    monkeypatch.setattr(d, "unstable_sliding", lambda rig, time_s, drive: iter(unstable))
    phase = np.zeros(8)
    phase[list(unsettled)] = UNCONVERGED
    response = SimpleNamespace(step_ends_s=np.zeros(steps), phase=phase)
    return list(d.dynamic_notes(RUN, model, response))


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ({}, []),
        ({"model": Model(())}, ["[bristles.stiffness_N_per_mm]"]),
        ({"steps": 81}, ["81 steps for 8 samples:"]),
        ({"unsettled": [3, 4, 5, 6, 7]}, ["aborted at 1.5 s, after "]),
        ({"unsettled": [7]}, ["aborted at 3.5 s, after "]),
    ],
)
def test_what_the_answer_is_limited_by_is_said_and_nothing_else(monkeypatch, how, said):
    found = notes(monkeypatch, **how)
    assert [part in note for part, note in zip(said, found, strict=True)] == [True] * len(said)


def unstable(damping_times, *, whole=True):
    critical = TABLE_1._replace(bristles=TABLE_1.bristles._replace(damping_N_s_per_mm=float("nan")))
    damping = damping_times * bristles_of(critical).damping
    rig = TABLE_1._replace(bristles=TABLE_1.bristles._replace(damping_N_s_per_mm=damping))
    moment = SimpleNamespace(whole=whole, speed_mm_s=1.234, f_in_N=56.78)
    return d._unstable(SimpleNamespace(moment=moment, growth_per_s=40.0), rig)


def test_how_fast_a_disturbance_grows_is_said():
    """By e in a fortieth of a second."""
    said = unstable(1.0)
    assert said.startswith(
        "sliding is unstable where the whole tendon slides, at 1.23 mm/s and f_in of 56.8 N: "
        "a disturbance grows e-fold in 25 ms"
    )
    assert "unstable in a dead band, at 1.23 mm/s" in unstable(1.0, whole=False)


@pytest.mark.parametrize(("times", "bristles"), [(0.3, False), (2.95, False), (3.05, True)])
def test_more_than_three_times_critical_damping_is_the_bristles_doing(times, bristles):
    said = unstable(times)
    assert (f"damping is {times:.3g} times critical" in said) == bristles
    assert ("friction falls with speed" in said) != bristles
