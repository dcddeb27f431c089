"""A run that is followed in pieces has the answer of the whole run."""

from dataclasses import replace

import numpy as np
import pytest

from tests.physics.references import GROUP_A, branches
from tests.physics.slip.test_any_effect import any_effects
from tests.physics.test_any_rig import any_motion, any_rig
from tsas_cli.effects import EFFECTS
from tsas_cli.physics.by_pieces import simulate_pieces
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.phases import UNCONVERGED
from tsas_cli.physics.response import simulate
from tsas_cli.physics.rig import with_values

CHANNELS = ("x_in_mm", "x_out_mm", "f_in_N", "f_out_N")
TIME_S = np.concatenate((np.arange(900) * 0.01, 9.0 + np.arange(600) * 0.013))
MOTION = 9.0 + 8.0 * np.sin(1.7 * TIME_S) + 3.0 * np.sin(5.3 * TIME_S) + 3.0  # nested strokes
RIG = GROUP_A._replace(x_in_zero_mm=3.0, x_out_zero_mm=-7.0)
DRIVE = DriveInput(MOTION, time_s=TIME_S, start_f_in_N=35.0)
DELAYS = {
    "channel_delay.f_in_delay_s": 0.031,
    "channel_delay.f_out_delay_s": -0.047,
    "channel_delay.x_out_delay_s": 0.02,
}
REMEMBERED = {
    "drive_inertia.mass_kg": 2.0,
    "force_crosstalk.f_in_of_f_out": 0.05,
    "force_sensor_hysteresis.f_in_share": 0.1,
    "force_sensor_hysteresis.f_out_share": 0.2,
    "force_sensor_curvature.f_out_per_N": 1e-3,
    "sensor_lag.f_in_lag_s": 0.7,
    "sensor_lag.f_out_lag_s": 0.05,
    "sensor_lag.x_out_lag_s": 0.02,
    "drive_law.friction_2_N": 1.5,
    "drive_law.share_3": 0.1,
    "drive_law.gap_friction_2_N": 0.7,
    "drive_law.speed_3": 0.3,
    "drive_law.place_3": 0.4,
    "load_law.lost_1_mm": 0.3,
    "tendon_law.start_1": 0.4,
}


def parts(drive, rows):
    """Cut a run into pieces of so many samples."""
    for first in range(0, drive.values.size, rows):
        cut = slice(first, first + rows)
        load = None if drive.load_values is None else drive.load_values[cut]
        yield replace(drive, values=drive.values[cut], load_values=load, time_s=drive.time_s[cut])


def in_pieces(rig, drive, rows, dynamics="slip", **how):
    answers = list(simulate_pieces(rig, parts(drive, rows), dynamics, **how))
    joined = {n: np.concatenate([getattr(a, n) for a in answers]) for n in (*CHANNELS, "phase")}
    return replace(answers[0], **joined)


def assert_same(found, whole, rtol=1e-9):
    assert found.solver == whole.solver
    np.testing.assert_array_equal(found.phase, whole.phase)
    for name in CHANNELS:
        scale = np.abs(getattr(whole, name)).max()
        np.testing.assert_allclose(getattr(found, name), getattr(whole, name), atol=rtol * scale)


@pytest.mark.parametrize("rows", [30, 167, 749, 1500])
@pytest.mark.parametrize("dynamics", ["slip", "static"])
def test_nested_strokes_go_on_at_every_border(rows, dynamics):
    whole = simulate(RIG, DRIVE, dynamics)
    assert {-1, 0, 1} <= set(whole.phase)
    assert_same(in_pieces(RIG, DRIVE, rows, dynamics), whole, rtol=1e-14)


def test_a_slack_tendon_that_rests_over_a_border_stays_slack():
    slack = np.interp(np.arange(160), [0, 50, 110, 159], [3.0, -40.0, -40.0, 9.0])
    drive = DriveInput(slack, time_s=np.arange(160) * 0.01)
    whole = simulate(RIG, drive)
    assert (whole.phase[50:110] == 2).all()
    assert_same(in_pieces(RIG, drive, 40), whole, rtol=1e-14)


@pytest.mark.parametrize("how", [{}, {"nodes": 12}])
def test_readings_that_come_late_look_over_the_borders(how):
    rig = with_values(RIG, DELAYS)
    assert_same(in_pieces(rig, DRIVE, 150, **how), simulate(rig, DRIVE, **how), rtol=1e-13)


def test_what_a_sensor_remembers_goes_over_the_borders():
    rig = with_values(RIG, REMEMBERED | DELAYS)
    assert_same(in_pieces(rig, DRIVE, 150), simulate(rig, DRIVE), rtol=1e-13)
    without = simulate(with_values(RIG, DELAYS), DRIVE)
    assert np.abs(simulate(rig, DRIVE).f_in_N - without.f_in_N).max() > 0.5


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect.name)
def test_every_effect_goes_over_the_borders(effect):
    rig = with_values(RIG, {f"{effect.name}.{p.name}": p.start for p in effect.parameters})
    assert_same(in_pieces(rig, DRIVE, 150, nodes=8), simulate(rig, DRIVE, nodes=8))


@pytest.mark.parametrize(("load", "channel"), [("force", "f_out_N"), ("displacement", "x_out_mm")])
def test_a_load_that_is_driven_late_looks_over_the_borders(load, channel):
    rig = with_values(RIG, DELAYS | REMEMBERED)
    given = getattr(simulate(rig, DRIVE), channel)
    drive = replace(DRIVE, load=load, load_values=given)
    assert_same(in_pieces(rig, drive, 160, nodes=12), simulate(rig, drive, nodes=12))


def test_a_drive_by_force_goes_on():
    drive = DriveInput(branches(MOTION - 3.0, GROUP_A)[0], kind="force", time_s=TIME_S)
    rig = with_values(RIG, DELAYS)
    assert_same(in_pieces(rig, drive, 211, nodes=12), simulate(rig, drive, nodes=12))


@pytest.mark.parametrize("seed", range(12))
def test_any_effects_on_any_rig(seed):
    rng = np.random.default_rng(seed)
    nominal = any_rig(rng)
    x = any_motion(rng, nominal)
    x_out = branches(x, nominal)[1]
    rig = with_values(nominal, any_effects(rng, nominal, x, x_out))
    time_s = np.cumsum(rng.uniform(0.5, 1.5, x.size)) / x.size
    drive = DriveInput(x, time_s=time_s - time_s[0])
    whole = simulate(rig, drive, nodes=8)
    found = in_pieces(rig, drive, max(x.size // 7, 8), nodes=8)
    if UNCONVERGED in whole.phase:  # where a step may go either way, rounding decides
        return
    assert_same(found, whole, rtol=1e-7)


def test_what_is_not_followed_in_pieces_is_said():
    with pytest.raises(ValueError, match="dynamic model cannot be simulated in pieces"):
        next(simulate_pieces(RIG, parts(DRIVE, 100), "lugre"))
    late = with_values(RIG, {"channel_delay.f_in_delay_s": 3.0})
    with pytest.raises(ValueError, match="shorter than a channel"):
        list(simulate_pieces(late, parts(DRIVE, 100)))
