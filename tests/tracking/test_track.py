"""The whole loop: what it repeats, what it converges to, what it refuses."""

import math

import numpy as np
import pytest

from tests.tracking.runs import loop_of, run, settings_of
from tsas_cli.controllers import CONTROLLERS
from tsas_cli.controllers.closed_loop import (
    ASKED,
    DISTANCE,
    F_IN,
    F_OUT,
    MEMORY_AT,
    MOTOR,
    X_IN,
    X_OUT,
    X_SEEN,
)
from tsas_cli.controllers.signals import error_filter
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.response import simulate
from tsas_cli.physics.rig import with_values
from tsas_cli.support.errors import InputError
from tsas_cli.tracking.track import feedforward

SILENT = {"noise_mm": 0.0, "step_mm": 0.0}
RATE = {"rate_Hz": 500.0}

every_controller = pytest.mark.parametrize("controller", CONTROLLERS)


def plant():
    return loop_of(settings_of())[3]


@every_controller
def test_the_same_seed_gives_the_same_numbers_and_another_seed_others(controller):
    first, again, other = run(controller), run(controller), run(controller, seed=2)
    np.testing.assert_array_equal(first.columns, again.columns)
    assert first.score == again.score
    assert np.abs(first.columns[ASKED] - other.columns[ASKED]).max() > 1e-3
    assert first.unsettled == 0


@every_controller
def test_every_controller_follows_and_only_its_own_columns_are_filled(controller):
    one = run(controller)
    assert one.score.rmse_N < 1.2
    assert one.time_s[-1] == pytest.approx(2.0)
    filled = sum(np.ptp(row) > 0.0 for row in one.columns[MEMORY_AT:])
    named = settings_of().controllers.of(controller).COLUMNS
    assert filled == len(named), f"COLUMNS of its settings name {named}"
    assert one.columns[DISTANCE].any() == controller.endswith("sliding-mode")


def test_the_encoder_has_its_noise_and_its_steps():
    one = run(sensor=RATE | {"noise_mm": 0.02, "step_mm": 0.01})
    seen = one.columns[X_SEEN]
    np.testing.assert_allclose(seen, 0.01 * np.round(seen / 0.01), atol=1e-12)
    assert np.std(seen - one.columns[X_IN]) == pytest.approx(0.02, rel=0.15)
    silent = run(sensor=RATE | SILENT)
    np.testing.assert_array_equal(silent.columns[X_SEEN], silent.columns[X_IN])


def test_more_steps_between_samples_change_ever_less():
    """In second order where the motor turns on; friction's corners cost a part of that."""
    x = [
        run(sensor=RATE | SILENT, loop={"nodes": 8, "substeps": n}).columns[X_IN]
        for n in (4, 16, 64)
    ]
    coarse, fine = np.abs(x[0] - x[2]), np.abs(x[1] - x[2])
    assert coarse.max() < 0.01
    assert np.sqrt(np.mean(fine**2)) < 0.2 * np.sqrt(np.mean(coarse**2))


@pytest.mark.parametrize("drift_per_s", [0.0, 0.2])
def test_the_tensions_are_those_of_the_model_moved_along_x_in(drift_per_s):
    """Sample by sample, and at its time: what is recorded belongs together."""
    rig = with_values(plant().rig, {"friction_drift.rate_per_s": drift_per_s})
    one = run(rig=rig, sensor=RATE | SILENT)
    c = one.columns
    there = simulate(rig, DriveInput(c[X_IN], time_s=one.time_s), nodes=8)
    np.testing.assert_allclose(c[F_OUT], there.f_out_N, atol=0.05)
    np.testing.assert_allclose(c[X_OUT], there.x_out_mm, atol=0.05)
    assert np.sqrt(np.mean((c[F_IN] - there.f_in_N) ** 2)) < 0.3


def test_what_is_asked_for_is_the_law_of_what_was_seen():
    """The sliding mode's speed, from the recorded x_in by Eq. (45) and the feedforward."""
    one, gains = run("sliding-mode"), settings_of().controllers.sliding_mode
    _, path, known, _ = loop_of(settings_of())
    x, v, a, jerk = path.drive[:, : one.time_s.size]
    A, b = error_filter(settings_of().loop.filter_Hz, 0.002)
    state, rows = np.zeros(3), []
    for e in x - one.columns[X_SEEN]:
        state = A @ state + b * e
        rows.append(state)
    e, de, dde = np.array(rows).T
    s = gains.c1 * e + gains.c2 * de + dde
    phi1, phi2, phi3 = gains.phi
    u = phi1 * (gains.c1 * de + gains.c2 * dde + jerk) + phi2 * (v - de) + phi3 * (a - dde)
    u += gains.epsilon_rpm * np.clip(s / gains.boundary_mm_per_s2, -1.0, 1.0) + gains.ks * s
    asked = u + feedforward(path, known.actuator)[: s.size]
    np.testing.assert_allclose(one.columns[DISTANCE], s, atol=1e-8)
    np.testing.assert_allclose(one.columns[ASKED], asked, atol=1e-8)


def test_the_sum_of_the_pid_is_held_after_samples_at_the_limit():
    one = run("pid", drive={"speed_limit_rpm": 500.0})
    _, path, _, _ = loop_of(settings_of(drive={"speed_limit_rpm": 500.0}))
    e = path.drive[0, : one.time_s.size] - one.columns[X_SEEN]
    grown = np.diff(one.columns[MEMORY_AT])
    limited = np.abs(one.columns[ASKED][:-1]) == 500.0
    assert 10 < limited.sum() < 900
    assert not grown[limited].any()
    np.testing.assert_allclose(grown[~limited], 0.002 * e[1:][~limited], atol=1e-12)


def test_the_motor_is_asked_within_its_limit_and_follows_with_its_lag():
    one = run("pid", drive={"speed_limit_rpm": 500.0, "motor_lag_s": 0.01})
    asked, motor = one.columns[ASKED], one.columns[MOTOR]
    assert np.abs(asked).max() == 500.0
    assert one.score.at_limit_percent > 1.0
    left = math.exp(-0.002 / 0.01)
    np.testing.assert_allclose(motor[1:], asked[:-1] + left * (motor[:-1] - asked[:-1]), atol=1e-6)


def test_a_change_of_the_rig_shows_only_from_then_on():
    rubbing = with_values(plant().rig, {"friction_coefficient": 0.2})
    plain, changed = run(), run(later=rubbing, change_s=1.0)
    at = 500
    np.testing.assert_array_equal(plain.columns[:, : at + 1], changed.columns[:, : at + 1])
    late = slice(at + 100, None)
    assert np.abs(plain.columns[F_IN] - changed.columns[F_IN])[late].max() > 1.0
    ratio = changed.columns[F_IN, late] / changed.columns[F_OUT, late]
    assert ratio.min() == pytest.approx(math.exp(-0.2 * math.pi), rel=1e-3)


def test_a_stiffer_tendon_from_a_time_on_is_another_chain():
    """What gives in the chain belongs to the rig, and changes with it."""
    soft = with_values(plant().rig, {"free_tendon.proximal_length_mm": 2000.0})
    late = run(later=soft, change_s=0.5).columns
    late, always = late[:, 700:], run(rig=soft).columns[:, 700:]
    np.testing.assert_allclose(late[F_OUT], always[F_OUT], atol=0.3)
    assert np.abs(run().columns[F_OUT, 700:] - always[F_OUT]).max() > 0.5


def test_a_change_after_the_end_is_refused():
    with pytest.raises(InputError, match=r"changes at 2\.1 s; expected .* 2 s"):
        run(later=plant().rig, change_s=2.1)


def test_the_feedforward_is_the_speed_of_the_motor_that_the_path_needs():
    _, path, known, _ = loop_of(settings_of())
    rpm = feedforward(path, known.actuator)
    np.testing.assert_allclose(rpm * known.actuator.gain_mm_per_s_rpm, path.drive[1])
    lagging = plant().actuator._replace(motor_lag_s=0.03)
    more = (feedforward(path, lagging) - rpm) * lagging.gain_mm_per_s_rpm
    np.testing.assert_allclose(more, 0.03 * path.drive[2], atol=1e-9)


def test_a_loop_that_runs_away_is_refused_with_time_and_state():
    gains = {"pid": {"proportional_rpm_per_mm": -200.0}}
    with pytest.raises(InputError) as refused:
        run("pid", controllers=gains, reference={"duration_s": 60.0, "mean_N": 44.0})
    assert "the loop is unstable: x_in is " in str(refused.value)
    assert "mm is wanted" in str(refused.value)
    assert refused.value.where == "controller pid"
    usual = "in the settings, then lower its gains or the filter's cutoff"
    assert refused.value.remedy == f"check sensor {usual}"
    with pytest.raises(InputError, match=f"check drive and sensor {usual}"):
        run("pid", controllers=gains, reference={"duration_s": 60.0}, drive={"gear_ratio": 110.0})


@pytest.mark.parametrize("duration_s", [0.3, 2.0])
def test_a_motor_that_swings_between_its_limits_is_refused(duration_s):
    gains = {"pid": {"proportional_rpm_per_mm": 1e6}}
    with pytest.raises(InputError, match=r"from 0\.?\d* s on the motor swings .* ±3000 rpm, \d+"):
        run("pid", controllers=gains, reference={"duration_s": duration_s, "mean_N": 44.0})


def test_a_motor_that_is_at_its_limit_without_swinging_is_no_relay():
    one = run("pid", drive={"speed_limit_rpm": 250.0})
    assert one.score.at_limit_percent > 20.0
