"""Three lumps on stiff bristles that go slowly are the slip chain, whatever acts on them."""

import math
from itertools import pairwise

import numpy as np
import pytest

from tests.physics.references import GROUP_A
from tsas_cli.effects import EFFECTS
from tsas_cli.physics.bristles import Bristles
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.phases import SLACK, UNCONVERGED
from tsas_cli.physics.response import simulate
from tsas_cli.physics.rig import with_values

N = 3


def motion(time_s):
    return 3.0 - 3.0 * np.cos(time_s) + 0.3 * np.sin(3.0 * time_s)


TIME_S, FINER_S = (np.linspace(0.0, 2.0 * math.pi, samples) for samples in (41, 61))
MOTION = motion(TIME_S)
STIFF = GROUP_A._replace(bristles=Bristles(stiffness_N_per_mm=2e5))
NOT_HERE = {"load_inertia", "stribeck_friction", "antagonist"}  # own motions; it is refused
CHANNELS = ("x_in_mm", "x_out_mm", "f_in_N", "f_out_N")


def apart(exact, found):
    """Return the largest difference of each channel of two runs over its range."""
    pairs = {name: (getattr(exact, name), getattr(found, name)) for name in CHANNELS}
    return {name: np.max(np.abs(b - a)) / np.ptp(a) for name, (a, b) in pairs.items()}


def both(rig, drive):
    """Return both answers, and how far they are apart."""
    slip = simulate(rig, drive, nodes=N)
    lugre = simulate(rig, drive, "lugre", nodes=N, tolerance=2e-4)
    assert not np.any(lugre.phase == UNCONVERGED)
    return slip, lugre, apart(slip, lugre)


# What depends on speed or time is so much larger that it shows in a slow motion of six seconds.
LARGER = {"drive_damping": 20.0, "drive_inertia": 200.0}
LARGER |= dict.fromkeys(("viscous_friction", "bend_drift", "friction_drift"), 10.0)


@pytest.mark.parametrize("name", [e.name for e in EFFECTS if e.name not in NOT_HERE])
def test_every_effect(name):
    """What it changes is many times as large as the difference of the two models."""
    effect = next(e for e in EFFECTS if e.name == name)
    nominal = DriveInput(motion(FINER_S), time_s=FINER_S)
    sizes = {p.name: min(LARGER.get(name, 1.0) * p.start, p.upper) for p in effect.parameters}
    rig = with_values(STIFF, {f"{name}.{p}": size for p, size in sizes.items()})
    _, lugre, off = both(rig, nominal)
    plain = simulate(STIFF, nominal, "lugre", nodes=N, tolerance=2e-4)
    assert max(off.values()) < 5e-3, (
        f"physics/lugre/ has another {name} than physics/slip/, or none"
    )
    assert max(off.values()) < 0.25 * max(apart(plain, lugre).values())
    assert {-1, 0, 1} == set(lugre.phase.tolist())


def test_the_slip_chain_is_approached_with_the_stiffness_of_the_bristles():
    off = [
        both(GROUP_A._replace(bristles=Bristles(stiffness)), DriveInput(MOTION, time_s=TIME_S))[2]
        for stiffness in (5e3, 2e4, 8e4)
    ]
    assert off[0]["f_in_N"] > 3e-3
    for softer, stiffer in pairwise(off):
        assert stiffer["f_in_N"] < 0.45 * softer["f_in_N"]  # 4 times as stiff


def test_what_is_given_at_the_ends():
    slip = simulate(STIFF, DriveInput(MOTION, time_s=TIME_S), nodes=N)
    for given in (
        {"values": MOTION, "load": "force", "load_values": slip.f_out_N},
        {"values": MOTION, "load": "displacement", "load_values": slip.x_out_mm},
        {"values": slip.f_in_N, "kind": "force"},
    ):
        assert max(both(STIFF, DriveInput(**given, time_s=TIME_S))[2].values()) < 5e-3


@pytest.mark.parametrize("lost_N_per_s", [0.0, 0.5])
def test_a_tendon_that_hangs_slack_at_first_and_at_last(lost_N_per_s):
    """It is pulled again where the spring, without its preload, has left the load."""
    rig = with_values(STIFF, {"preload_loss.rate_N_per_s": lost_N_per_s})
    slip, lugre, off = both(rig, DriveInput(MOTION - 18.0, time_s=TIME_S))
    assert max(off.values()) < 1e-3
    # At the first sample nothing has moved, and the dynamic chain says no more than that.
    np.testing.assert_array_equal(slip.phase[1:] == SLACK, lugre.phase[1:] == SLACK)
    assert 10 < np.count_nonzero(lugre.phase == SLACK) < 35
    assert not np.any(lugre.f_in_N[lugre.phase == SLACK])


def test_a_run_that_begins_in_the_middle_of_a_stroke():
    drive = DriveInput(MOTION + 3.0, time_s=TIME_S, start_f_in_N=26.0)
    _, lugre, off = both(STIFF, drive)
    assert max(off.values()) < 2e-3
    assert lugre.f_in_N[0] == pytest.approx(26.0, abs=0.05)
