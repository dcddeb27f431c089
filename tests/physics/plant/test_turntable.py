"""The plant against an independent integration, and against the model that it moves."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from tests.physics.references import DRIVEN_BY_FORCE, GROUP_A
from tsas_cli.physics.course import Losses
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.plant.slip_plant import step_plant
from tsas_cli.physics.plant.turntable import (
    Actuator,
    DriveStep,
    Motor,
    Turntable,
    advance_motor,
)
from tsas_cli.physics.response import simulate
from tsas_cli.physics.rig import with_values
from tsas_cli.physics.slip.outputs import tension_at_sensor
from tsas_cli.physics.slip.state import (
    COMPLIANCE,
    POSITION,
    TENSION,
    Moment,
    chain_at_rest,
    slip_laws,
)

K = 2.0 * math.pi * 27.1 / (60.0 * 120.0)
DRIVE = Actuator(K, 52.0, 0.1296 / 27.1**2, 0.007, 0.002, 3000.0)
SMOOTH = GROUP_A._replace(friction_coefficient=0.0)
N = 12
F0 = GROUP_A.preload_N
SERIES = 1.0 / (1.0 / GROUP_A.load_stiffness_N_per_mm + 250.0 * math.pi / 67858.4)


class Run:
    """Columns of a run from rest, shape (m,): one motor speed asked for per step."""

    def __init__(self, asked_rpm, rig=GROUP_A, *, drive=DRIVE, h=1e-3, n=N):
        motor, table = Motor(0.0, 0.0), Turntable(0.0, 0.0, 0.0, 0.0, rig.preload_N, 0.0)
        chain, laws = chain_at_rest(rig, n), slip_laws(rig, n, DRIVEN_BY_FORCE)
        now = Moment(rig.preload_N, 0.0, Losses(0.0, 0.0, 0.0, 0.0), math.inf)
        rows = []
        for k, asked in enumerate(asked_rpm):
            motor = advance_motor(motor, float(asked), drive, h)
            step = DriveStep(drive, motor.mm, (k + 1) * h, h)
            table, now, settled = step_plant(table, chain, now, rig, laws, step)
            assert settled
            stretch = 0.5 * np.sum(
                chain[COMPLIANCE : COMPLIANCE + n + 1]
                * (chain[TENSION : TENSION + n + 1] - F0) ** 2
            )
            f_out = tension_at_sensor(chain, now, laws)
            rows.append((*motor, *table, chain[POSITION], chain[POSITION + n + 1], f_out, stretch))
        columns = np.array(rows).T
        self.time_s = h * np.arange(1, 1 + columns.shape[1])
        self.motor_rpm, self.motor, self.x, _, self.v = columns[:5]
        self.f_in, self.end, self.x_out, self.f_out, self.stretch = columns[[6, 8, 9, 10, 11]]


def there_and_back(*rpm, hold=0.0, each_s=0.2, h=1e-3):
    """Return one speed after the other, and rest between them."""
    legs = [np.concatenate((np.full(round(each_s / h), s), np.zeros(round(hold / h)))) for s in rpm]
    return np.concatenate(legs)


def test_a_motor_without_lag_has_its_speed_at_once():
    now = advance_motor(Motor(5.0, 1.0), 300.0, DRIVE._replace(motor_lag_s=0.0), 0.01)
    assert now[:2] == pytest.approx((300.0, 1.0 + 300.0 * K * 0.01))


def exact_drive(asked, time_s, drive, stiffness):
    """Integrate motor and turntable on a spring; return motor speed and place, x and v."""
    m, B, kd = drive.inertia_N_s2_per_mm, drive.damping_N_s_per_mm, drive.stiffness_N_per_mm

    def rates(_, y):
        w, motor, x, v = y
        pull = kd * (motor - x) - B * v - stiffness * x
        return (asked - w) / drive.motor_lag_s, drive.gain_mm_per_s_rpm * w, v, pull / m

    span = (0.0, time_s[-1])
    return solve_ivp(rates, span, np.zeros(4), t_eval=time_s, rtol=1e-11, atol=1e-13).y


OTHER_DRIVE = Actuator(0.031, 20.0, 6e-4, 0.05, 0.004, 3000.0)


@pytest.mark.parametrize("drive", [DRIVE, OTHER_DRIVE], ids=["paper", "other"])
@pytest.mark.parametrize("spring", [0.0, 12.5])
def test_a_speed_step_without_friction_is_of_second_order(drive, spring):
    rig = with_values(SMOOTH, {"proximal_spring.stiffness_N_per_mm": spring})
    errors = []
    for h in (2e-4, 1e-4, 5e-5, 2.5e-5):
        run = Run(np.full(round(0.02 / h), 900.0), rig, drive=drive, h=h)
        exact = exact_drive(900.0, run.time_s, drive, SERIES + spring)
        np.testing.assert_allclose([run.motor_rpm, run.motor], exact[:2], rtol=1e-6, atol=1e-8)
        np.testing.assert_allclose(run.f_in - F0, (SERIES + spring) * run.x, atol=1e-8)
        np.testing.assert_allclose(run.x_out, run.x * SERIES / 1.579, atol=1e-8)
        errors.append(np.sqrt(np.mean((np.array([run.x, run.v]) - exact[2:]) ** 2, axis=1)))
    assert errors[-1][0] < 1e-3 * run.x.max()
    for coarse, fine in pairwise(np.array(errors)):
        np.testing.assert_allclose(np.log2(coarse / fine), 2.0, atol=0.2)


def moved_likewise(run, rig=GROUP_A):
    """Return what the model says where the drive moves the tendon's end as in a run."""
    drive = DriveInput(np.append(0.0, run.end), time_s=np.append(0.0, run.time_s))
    return simulate(rig, drive, nodes=N)


MOTION = there_and_back(2000.0, -600.0, 800.0, -1500.0, hold=0.05)
MOVED = {
    "none": {},
    "free tendon": {"free_tendon.proximal_length_mm": 152.0, "free_tendon.distal_length_mm": 61.0},
    "drive compliance": {"drive_compliance.compliance_mm_per_N": 0.01},
    "direction": {"direction_dependent_friction.asymmetry": 0.2},
    "presliding": {"presliding.length_mm": 0.05},
    "load-dependent friction": {"load_dependent_friction.exponent": -0.2},
    "load spring": {"load_spring_nonlinearity.quadratic_per_mm": 0.03},
    "load friction": {"load_friction.before_sensor_N": 2.0, "load_friction.after_sensor_N": 1.0},
    "friction drift": {"friction_drift.rate_per_s": 0.5},
    "bend drift": {"bend_drift.rate_rad_per_s": 0.5},
    "preload loss": {"preload_loss.rate_N_per_s": 3.0},
    "proximal spring": {"proximal_spring.stiffness_N_per_mm": 12.5},
    "stribeck": {"stribeck_friction.excess": 0.2, "stribeck_friction.velocity_mm_per_s": 20.0},
}


@pytest.mark.parametrize("values", MOVED.values(), ids=MOVED.keys())
def test_tensions_are_those_of_the_model_whose_drive_is_moved_likewise(values):
    """The plant finds tensions from forces, `simulate` from the way of the tendon's end."""
    rig = with_values(GROUP_A, values)
    run = Run(MOTION, rig)
    there = moved_likewise(run, rig)
    np.testing.assert_allclose(run.x_out, there.x_out_mm[1:], atol=1e-5)
    np.testing.assert_allclose(run.f_out, there.f_out_N[1:], atol=1e-5)
    np.testing.assert_allclose(run.f_in, there.f_in_N[1:], atol=1e-5)


def test_friction_at_the_drive_sticks_until_the_gear_is_wound_up():
    rig = with_values(GROUP_A, {"drive_friction.friction_N": 6.0})
    slow = Run(np.full(800, 30.0), rig)
    wound = DRIVE.stiffness_N_per_mm * (slow.motor - slow.x)
    sticks = DRIVE.stiffness_N_per_mm * slow.motor < 6.0 - 0.1
    assert 100 < sticks.sum() < 300
    assert not slow.x[sticks].any()
    np.testing.assert_allclose(slow.f_in[sticks] - F0, wound[sticks], atol=0.02)
    assert slow.x[-1] > 0.05
    moves = np.diff(slow.end, prepend=0.0) > 0.0
    rubs = slow.f_in - moved_likewise(slow).f_in_N[1:]
    np.testing.assert_allclose(rubs[moves], 6.0, atol=1e-6)


@pytest.mark.parametrize("friction", [0.0, 3.0])
def test_a_motor_that_unwinds_far_lets_the_tendon_hang(friction):
    """It carries nothing then, and comes back taut along the same way."""
    rig = with_values(GROUP_A, {"drive_friction.friction_N": friction})
    out = there_and_back(-3000.0, hold=0.3, each_s=0.5)
    run = Run(np.concatenate((out, -out, out[:300])), rig)
    assert run.x.min() < -30.0
    hanging = run.f_out == 0.0
    assert 500 < hanging.sum() < 1400
    np.testing.assert_allclose(run.x_out[hanging], -F0 / 1.579, rtol=1e-9)
    assert (np.abs(run.f_in[hanging]) <= friction + 1e-9).all()
    assert (run.f_out >= 0.0).all()
    assert run.f_in.min() > -friction - 1e-9
    np.testing.assert_allclose(run.f_out, moved_likewise(run).f_out_N[1:], atol=1e-5)


def energy(run, drive=DRIVE):
    """Return kinetic energy, and what gear, tendon and load spring hold beyond the preload [mJ]."""
    kinetic = 0.5 * drive.inertia_N_s2_per_mm * run.v**2
    gear = 0.5 * drive.stiffness_N_per_mm * (run.motor - run.x) ** 2
    return kinetic + gear + run.stretch + 0.5 * 1.579 * run.x_out**2


@pytest.mark.parametrize("friction", [0.0, 0.125, 0.4])
def test_no_energy_comes_from_the_plant(friction):
    """The motor does what is stored, what damping takes and, with friction, more than that."""
    h = 2e-4
    rig = GROUP_A._replace(friction_coefficient=friction)
    run = Run(there_and_back(2000.0, -1900.0, 700.0, hold=0.02, h=h, each_s=0.06), rig, h=h)
    pull = DRIVE.stiffness_N_per_mm * (run.motor - run.x)
    done = np.cumsum(0.5 * (pull + np.append(0.0, pull[:-1])) * np.diff(run.motor, prepend=0.0))
    lost = done - energy(run)
    assert np.diff(lost, prepend=0.0).min() > -1e-3
    damped = np.sum(DRIVE.damping_N_s_per_mm * run.v**2) * h
    if friction == 0.0:
        assert lost[-1] == pytest.approx(damped, rel=0.01)
    else:
        assert lost[-1] > damped + 10.0
