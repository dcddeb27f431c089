"""The laws of unnamed origin in the plant: against the simulation, and what they dissipate."""

import numpy as np
import pytest

from tests.physics.plant.open_loop import run
from tests.physics.references import GROUP_A
from tsas_cli.physics.bristles import Bristles
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.plant import laws as module
from tsas_cli.physics.plant.laws import (
    beside_drive,
    friction_of_tendon,
    laws_at_rest,
    plant_laws,
)
from tsas_cli.physics.plant.turntable import Turntable
from tsas_cli.physics.response import simulate
from tsas_cli.physics.rig import with_values

STEP_S, N = 4e-3, 10
TIME_S = STEP_S * np.arange(1501)
WAY = 5.0 - 5.0 * np.cos(2.0 * np.pi * TIME_S / 6.0)  # ends where it begins
STIFF = GROUP_A._replace(bristles=Bristles(stiffness_N_per_mm=5e5))
RANGES = {"travel_mm": 3.0, "low_mm": 0.0, "high_mm": 10.0, "fast_mm_per_s": 20.0}
AT_DRIVE = RANGES | {
    "friction_1_N": 2.0, "friction_4_N": 1.0, "share_2": 0.05, "gap_friction_1_N": 1.0,
    "curve_4_N": 1.5, "speed_3": 0.2, "place_3": 0.3,
}  # fmt: skip
ON_TENDON = RANGES | {"start_1": 0.3, "start_3": 0.3, "curve_4": 0.2, "speed_3": -0.2}


def rig_with(law, values, rig=STIFF):
    return with_values(rig, {f"{law}.{name}": value for name, value in values.items()})


def rms(values):
    return float(np.sqrt(np.mean(values**2)))


@pytest.mark.parametrize("lumped", [False, True])
@pytest.mark.parametrize(
    ("law", "values"), [("drive_law", AT_DRIVE), ("tendon_law", ON_TENDON)], ids=["drive", "tendon"]
)
def test_a_slow_motion_has_the_forces_of_the_simulation(law, values, lumped):
    rig = rig_with(law, values)
    plant, _, unsettled = run(rig, WAY, STEP_S, lumped=lumped, n=N)
    drive = DriveInput(plant["x_in_mm"], time_s=TIME_S)
    ours, without = simulate(rig, drive, nodes=N), simulate(STIFF, drive, nodes=N)
    assert unsettled == 0
    for name in ("f_in_N", "f_out_N") if law == "tendon_law" else ("f_in_N",):
        there = getattr(ours, name)
        assert rms(plant[name] - there) < 0.06 * rms(there - getattr(without, name))


def work_of_law(way, **values):
    """Return the work that the drive has done on the law of a rig up to each sample [N mm]."""
    plant, _, unsettled = run(rig_with("drive_law", values), way, STEP_S, lumped=False, n=N)
    time_s = STEP_S * np.arange(way.size)
    x = plant["x_in_mm"]
    force = plant["f_in_N"] - simulate(STIFF, DriveInput(x, time_s=time_s), nodes=N).f_in_N
    assert unsettled == 0
    return np.concatenate(([0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(x)))), x


def test_an_element_dissipates_the_area_of_its_loop_in_a_closed_cycle():
    """Twice its friction times the stroke less twice its width: 2 · 2 N · (stroke − 2 · 1.5 mm)."""
    work, x = work_of_law(np.tile(WAY[:-1], 2), travel_mm=1.5, friction_1_N=2.0)
    assert work[-1] - work[1499] == pytest.approx(4.0 * (np.ptp(x[1499:]) - 3.0), rel=0.01)


def test_a_law_never_gives_more_than_it_took():
    """Whatever the motion: the elements begin without force."""
    turns = np.random.default_rng(5).uniform(-2.0, 2.0, 61)
    turns[0] = 0.0
    way = np.interp(np.arange(1500) / 25.0, np.arange(61), turns)
    work, _ = work_of_law(
        way, travel_mm=1.0, friction_2_N=2.0, friction_6_N=1.0, gap_friction_1_N=3.0
    )
    assert work.min() > -0.01
    assert work[-1] > 20.0


def test_a_reversal_ofthe_tendon_counts_in_proportion_as_it_moves_back():
    """Wholly from a quarter of 6.4 mm/4³ on, 0.025 mm."""
    laws = plant_laws(rig_with("tendon_law", {"travel_mm": 6.4, "start_1": 0.5}))
    state = laws_at_rest(np.linspace(0.0, 5.0, 101), 30.0, laws)
    way = [4.99, 5.0, 4.9, 4.91, 5.5]
    shares, backs = [0.4, 0.0, 1.0, 1.0, 1.0], [0.01, 0.0, 0.1, 0.09, 0.6]
    expected = 1.0 + np.array(shares) * 0.5 * np.exp(-np.array(backs) / 6.4)
    # 0.01 mm forward from 4.9 mm is 0.4 of a second reversal.
    expected[3] = 1.0 + 0.5 * (0.6 * np.exp(-0.09 / 6.4) + 0.4 * np.exp(-0.01 / 6.4))
    assert [friction_of_tendon(state, p, laws) for p in way] == pytest.approx(expected)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_share_is_of_the_tension_without_the_force_of_the_step_before(way):
    """Of 30 N less the line 2 N + 0.5 N/mm · 4 mm a tenth, once all elements have yielded."""
    laws = plant_laws(rig_with("drive_law", {"travel_mm": 0.01, "share_1": 0.1}))
    state = laws_at_rest(np.linspace(4.0 - way, 4.0, 11), 30.0, laws)
    table = Turntable(4.0, 4.0, 0.0, 0.0, 30.0 + way * 3.0, 5.0 * way)
    line = beside_drive(state.copy(), 4.0, table, 1e-3, laws)
    assert line.ahead + 4.0 * line.slope == pytest.approx(way * 3.0)  # as at rest
    state[module.AHEAD], state[module.SLOPE] = 2.0, 0.5
    line = beside_drive(state, 4.0, Turntable(4.0, 4.0, 0.0, 0.0, 30.0, 5.0 * way), 1e-3, laws)
    assert line.ahead + 4.0 * line.slope == pytest.approx(way * 0.1 * (30.0 - 2.0 - 2.0))
    assert line.slope == pytest.approx(0.0, abs=1e-9)
    assert state[module.SPEED] == pytest.approx(5.0 * way * (1.0 - np.exp(-1e-3 / 0.05)))


def test_the_line_of_a_law_is_its_secant_over_a_step():
    """An element of 2 N over 3 mm yields by 2/3 N/mm; at a turn of the way it is as stiff."""
    laws = plant_laws(rig_with("drive_law", {"travel_mm": 3.0, "friction_1_N": 2.0}))
    state = laws_at_rest(np.linspace(0.0, 1.0, 11), 30.0, laws)
    for speed in (4.0, -4.0, 0.0):
        table = Turntable(1.0, 1.0, 0.0, 0.0, 30.0, speed)
        line = beside_drive(state.copy(), 1.0, table, 1e-2, laws)
        assert (line.ahead + line.slope, line.slope) == pytest.approx((2.0 / 3.0, 2.0 / 3.0))
