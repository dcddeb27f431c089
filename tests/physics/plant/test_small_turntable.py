"""One step of the plant: the turntable's equation of motion, its play and its ripple by hand."""

import math

import pytest

from tests.physics.references import DRIVEN_BY_FORCE, GROUP_A
from tsas_cli.numerics.wave import Wave
from tsas_cli.physics.course import Losses
from tsas_cli.physics.mesh import segment_compliances
from tsas_cli.physics.plant.slip_plant import step_plant
from tsas_cli.physics.plant.turntable import (
    Actuator,
    DriveStep,
    Play,
    Tangent,
    Turntable,
    across_play,
    ripple_tangent,
    spring_of,
    turntable_at,
)
from tsas_cli.physics.rig import with_values
from tsas_cli.physics.slip.state import (
    POSITION,
    SLIP,
    TENSION,
    Moment,
    chain_at_rest,
    slip_laws,
)

F0, H = 25.0, 0.01
ACTUATOR = Actuator(0.024, 150.0, 6e-3, 0.4, 0.02, 3000.0)
TABLE = Turntable(2.0, 1.9, 9.0, 8.0, 31.0, 7.0)
MOTOR_MM = 2.3
STEP = DriveStep(ACTUATOR, MOTOR_MM, 3.0, H)
PRELOADED = Moment(F0, 0.0, Losses(0.4, 0.4, 0.0, 0.0), H)
RIPPLE = {
    "drive_ripple.sine_mm": 0.06,
    "drive_ripple.cosine_mm": 0.02,
    "drive_ripple.period_mm": 0.9,
    "drive_ripple.second_sine": 0.2,
    "drive_ripple.second_cosine": -0.1,
}
PLAY = {"backlash.play_mm": 0.4}


def left_over(x, pull, *, table=TABLE, motor_mm=MOTOR_MM):
    """Return what m a + B v + k (x − motor) + pull leaves, after a step of BDF2 to x [N]."""
    v = (1.5 * x - 2.0 * table.x + 0.5 * table.x_before) / H
    a = (1.5 * v - 2.0 * table.v + 0.5 * table.v_before) / H
    gear = 150.0 * (x - motor_mm)
    return 6e-3 * a + 0.4 * v + gear + pull


def tangent(x):
    """Return value at zero and slope of the straight line that is the gear's output about x."""
    w, size = 2.0 * math.pi / 0.9, math.hypot(0.06, 0.02)
    here, next_value = (
        y
        + 0.06 * math.sin(w * y)
        + 0.02 * (math.cos(w * y) - 1.0)
        + size * (0.2 * math.sin(2.0 * w * y) - 0.1 * (math.cos(2.0 * w * y) - 1.0))
        for y in (x, x + 1e-4)
    )
    slope = (next_value - here) / 1e-4
    return here - slope * x, slope


@pytest.mark.parametrize("values", [{}, RIPPLE, PLAY, RIPPLE | PLAY])
@pytest.mark.parametrize("p", [1.5, 3.1])
def test_a_turntable_that_touches_is_a_spring_at_the_tendons_end(values, p):
    """Wherever that end goes, the turntable's equation holds with the force that it takes."""
    rig = with_values(GROUP_A, values)
    reach = spring_of(TABLE, p, rig, STEP)
    assert reach.touches
    value, slope = tangent(2.1) if values.keys() & RIPPLE.keys() else (0.0, 1.0)
    half = 0.2 if values.keys() & PLAY.keys() else 0.0
    for end in (1.7, 2.2):
        x, force = turntable_at(end, reach)
        assert left_over(x, slope * (force - F0)) == pytest.approx(0.0, abs=1e-7)
        at_flank = value + slope * x - math.copysign(half, 2.1 - p)
        assert at_flank == pytest.approx(end, abs=1e-9)


@pytest.mark.parametrize("values", [PLAY, RIPPLE | PLAY])
@pytest.mark.parametrize("friction", [0.0, 0.02, 10.0])
def test_a_turntable_within_its_play_moves_with_the_tension_as_it_is(values, friction):
    """Friction of the play holds it back."""
    drags = values | {"sheath_drag.force_N": 0.1 * friction}
    rig = with_values(GROUP_A._replace(friction_coefficient=friction), drags)
    reach = spring_of(TABLE, 2.05, rig, STEP)
    _, slope = tangent(2.1) if values.keys() & RIPPLE.keys() else (0.0, 1.0)
    assert not reach.touches
    rubs = 31.0 * math.tanh(friction * math.pi) + 0.1 * friction
    off = left_over(reach.x, slope * (31.0 - F0))
    assert off == pytest.approx(math.copysign(rubs, TABLE.x - reach.x), abs=1e-7)


@pytest.mark.parametrize(
    ("x", "p", "held", "expected"),
    [
        pytest.param(2.05, 2.0, 0.0, 2.05, id="nothing rubs"),
        pytest.param(2.10, 2.0, 0.02, 2.08, id="up within the play"),
        pytest.param(1.90, 2.0, 0.02, 1.92, id="down within the play"),
        pytest.param(2.01, 2.0, 0.02, 2.00, id="held"),
        pytest.param(1.99, 2.0, 0.02, 2.00, id="held the other way"),
        pytest.param(2.30, 1.8, 0.02, 2.30, id="pushing at its upper flank"),
        pytest.param(1.70, 2.2, 0.02, 1.70, id="pushing at its lower flank"),
        pytest.param(1.90, 1.8, 0.02, 1.92, id="leaving its flank"),
        pytest.param(2.30, 1.9, 0.02, 2.28, id="on its way to the flank"),
        pytest.param(2.10, 1.9, 0.02, 2.08, id="on the same side within the play"),
        pytest.param(1.40, 1.8, 0.02, 1.42, id="from one flank past the other"),
    ],
)
def test_the_way_across_the_play(x, p, held, expected):
    """0.2 mm to either side of the tendon's end; the drive was at 2 mm."""
    assert across_play(x, 2.0, p, Tangent(0.0, 1.0), Play(0.2, held)) == pytest.approx(expected)
    # The same where what the gear gives out is half of what it is turned, and moved by 1 mm.
    halved = across_play(x, 2.0, 0.5 * p + 1.0, Tangent(1.0, 0.5), Play(0.1, held))
    assert halved == pytest.approx(expected)


@pytest.mark.parametrize(
    ("sine", "cosine"), [(0.0, 0.0), (0.06, 0.0), (0.0, 0.02), (0.06, 0.02), (0.02, 0.02)]
)
def test_the_ripples_tangent_has_its_value_and_slope(sine, cosine):
    w, x = 2.0 * math.pi / 0.9, 0.35
    value, slope = ripple_tangent(x, Wave(sine, cosine, 0.9))
    assert slope == pytest.approx(
        1.0 + w * (sine * math.cos(w * x) - cosine * math.sin(w * x)), abs=1e-3
    )
    wave = sine * math.sin(w * x) + cosine * (math.cos(w * x) - 1.0)
    assert value + slope * x == pytest.approx(x + wave, abs=1e-12)


AT_DRIVE = {"drive_friction.friction_N": 2.0, "proximal_spring.stiffness_N_per_mm": 4.0}


RESTING = Turntable(0.0, 0.0, 0.0, 0.0, F0, 0.0)


def first_step(rig, motor_mm, table=RESTING):
    """Move a plant at rest by one step, its motor being elsewhere; return where all is then."""
    chain, laws = chain_at_rest(rig, 3), slip_laws(rig, 3, DRIVEN_BY_FORCE)
    step = STEP._replace(motor_mm=motor_mm)
    after, now, settled = step_plant(table, chain, PRELOADED, rig, laws, step)
    assert settled
    return after, now, chain


@pytest.mark.parametrize("motor_mm", [2.0, -2.0, -900.0])
def test_after_a_step_the_turntable_balances_what_pulls_at_it(motor_mm):
    """A motor that unwinds at once leaves the tendon without tension; friction and spring pull."""
    rig = with_values(GROUP_A, AT_DRIVE)
    after, _, chain = first_step(rig, motor_mm)
    left = left_over(after.x, after.f_in - F0, table=RESTING, motor_mm=motor_mm)
    assert left == pytest.approx(0.0, abs=1e-6 if motor_mm == -900.0 else 1e-7)
    assert after.x == pytest.approx(chain[POSITION])
    assert after.speed == pytest.approx(chain[POSITION] / H)
    rubs = math.copysign(2.0, motor_mm)
    assert after.f_in == pytest.approx(chain[TENSION] + 4.0 * chain[POSITION] + rubs)
    if motor_mm == -900.0:
        assert not chain[TENSION : TENSION + 4].any()
        assert chain[SLIP] == -1.0
        assert chain[POSITION + 4] == pytest.approx(-F0 / 1.579)
    else:
        stretched = segment_compliances(rig, 3)[0] * (chain[TENSION] - F0)
        assert chain[POSITION] - chain[POSITION + 1] == pytest.approx(stretched)


def test_friction_in_a_step_is_that_of_its_end_and_of_the_speed_before():
    rig = with_values(
        GROUP_A,
        {
            "friction_drift.rate_per_s": 0.1,
            "direction_dependent_friction.asymmetry": 0.2,
            "viscous_friction.coefficient_N_s_per_mm": 0.05,
            "preload_loss.rate_N_per_s": 0.5,
        },
    )
    _, now, _ = first_step(rig, MOTOR_MM, TABLE)
    wrap = 0.125 * math.pi * 1.3
    assert now.losses == pytest.approx((1.2 * wrap, 0.8 * wrap, 0.05 * 7.0, 1.5))
    assert (now.load, now.step_s) == (0.0, H)


def test_a_tendon_rests_while_its_drive_is_within_the_play():
    after, now, chain = first_step(with_values(GROUP_A, PLAY), 0.1)
    assert now.drive == F0  # the moment of before
    assert not chain[POSITION : POSITION + 5].any()
    assert (after.f_in, after.speed, after.x_before) == (F0, 0.0, 0.0)
    assert 0.0 <= after.x < 0.1
