"""With stiff bristles and slow motion the dynamic chain is the slip chain, whatever acts on it."""

import math
from itertools import pairwise

import numpy as np
import pytest

from tests.physics.references import GROUP_A
from tsas_cli.effects import EFFECTS
from tsas_cli.physics.bristles import Bristles
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.mesh import MOST_NODES
from tsas_cli.physics.phases import SLACK, UNCONVERGED
from tsas_cli.physics.response import simulate
from tsas_cli.physics.rig import with_values

TIME_S = np.arange(0.0, 2.0 * math.pi, 2e-3)
NESTED = 10.0 - 10.0 * np.cos(TIME_S) + 1.5 * np.sin(5.0 * TIME_S)
STIFF = GROUP_A._replace(bristles=Bristles(stiffness_N_per_mm=5e5))
# Their own frequency or their own instability shows where the slip chain has neither.
DYNAMIC = {"load_inertia", "stribeck_friction"}


def apart(rig, drive, *, lumps=50):
    """Return the largest difference of each channel of the two models, over its range."""
    slip = simulate(rig, drive, on_mesh=True, nodes=lumps)
    lugre = simulate(rig, drive, "lugre", nodes=lumps)
    assert not np.any(lugre.phase == UNCONVERGED)
    return {
        name: np.sqrt(np.mean((getattr(slip, name) - getattr(lugre, name)) ** 2))
        / max(np.ptp(getattr(slip, name)), 1e-9)
        for name in ("x_in_mm", "x_out_mm", "f_in_N", "f_out_N")
    }


@pytest.fixture(scope="module")
def slip():
    return simulate(STIFF, DriveInput(NESTED, time_s=TIME_S), on_mesh=True, nodes=50)


@pytest.mark.parametrize("name", [e.name for e in EFFECTS if e.name not in DYNAMIC])
def test_every_effect_acts_as_in_the_slip_chain(name):
    effect = next(e for e in EFFECTS if e.name == name)
    rig = with_values(STIFF, {f"{name}.{p.name}": p.start for p in effect.parameters})
    nominal = simulate(STIFF, DriveInput(NESTED, time_s=TIME_S), "lugre")
    changed = simulate(rig, DriveInput(NESTED, time_s=TIME_S), "lugre")
    assert max(apart(rig, DriveInput(NESTED, time_s=TIME_S)).values()) < 4e-4
    assert any(
        np.max(np.abs(getattr(nominal, c) - getattr(changed, c))) > 1e-3
        for c in ("f_in_N", "f_out_N", "x_out_mm")
    )


def test_a_load_by_force(slip):
    drive = DriveInput(NESTED, load="force", load_values=slip.f_out_N, time_s=TIME_S)
    assert max(apart(STIFF, drive).values()) < 4e-4


def test_a_load_by_displacement(slip):
    drive = DriveInput(NESTED, load="displacement", load_values=slip.x_out_mm, time_s=TIME_S)
    assert max(apart(STIFF, drive).values()) < 2e-3


def test_a_drive_by_force(slip):
    assert max(apart(STIFF, DriveInput(slip.f_in_N, kind="force", time_s=TIME_S)).values()) < 4e-4


def test_a_run_that_begins_in_the_middle_of_a_stroke():
    drive = DriveInput(NESTED + 3.0, time_s=TIME_S, start_f_in_N=22.0)
    assert max(apart(STIFF, drive).values()) < 4e-4
    assert simulate(STIFF, drive, "lugre").f_in_N[0] == pytest.approx(22.0, abs=0.05)


def test_a_tendon_that_hangs_slack_for_a_while():
    drive = DriveInput(NESTED - 18.0, time_s=TIME_S)
    assert max(apart(STIFF, drive).values()) < 4e-4
    slack = simulate(STIFF, drive, "lugre").phase == SLACK
    slip_slack = simulate(STIFF, drive, on_mesh=True).phase == SLACK
    assert np.count_nonzero(slack) > 500
    assert np.count_nonzero(slack != slip_slack) < 10


def test_the_slip_chain_is_approached_with_the_stiffness_of_the_bristles():
    drive = DriveInput(NESTED, time_s=TIME_S)
    off = [
        apart(GROUP_A._replace(bristles=Bristles(stiffness)), drive)["f_in_N"]
        for stiffness in (5e3, 2e4, 8e4)
    ]
    assert off[0] > 3e-3
    for softer, stiffer in pairwise(off):
        assert stiffer < 0.45 * softer  # 4 times as stiff


@pytest.mark.parametrize("lumps", [1, -3, MOST_NODES + 1])
def test_a_number_of_lumps_that_cannot_be_is_refused(lumps):
    with pytest.raises(ValueError, match=f"{lumps} nodes; expected 2 to {MOST_NODES}"):
        simulate(STIFF, DriveInput(NESTED, time_s=TIME_S), "lugre", nodes=lumps)
