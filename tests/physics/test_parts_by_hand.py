"""Small parts of the chains, the plant and the sensors, each called alone and held by hand."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from tests.physics.references import (
    DRIVEN_BY_FORCE,
    GROUP_A,
    LOADED_BY_DISPLACEMENT,
    LOADED_BY_FORCE,
    LOADED_BY_SPRING,
    at,
    bare_step,
    course_of,
    step_ends,
    wrap_of,
)
from tsas_cli.drive.harmonic_drive import DriveValues, has_gear, lag_coefficients
from tsas_cli.effects.load_spring_nonlinearity import LoadSpringNonlinearity
from tsas_cli.physics.course import Losses, Tensions
from tsas_cli.physics.ends import last_direction, losses_at, losses_without_speed
from tsas_cli.physics.frames import empty_frames, is_next, slips_up_to
from tsas_cli.physics.lugre.balance import set_limits
from tsas_cli.physics.lugre.ends import Samples, Span, input_error
from tsas_cli.physics.lugre.start import lugre_laws
from tsas_cli.physics.lugre.state import (
    DEFLECTION_HISTORY,
    LIMIT,
    LIMIT_BY_T,
    LIMIT_BY_V,
    RATE,
)
from tsas_cli.physics.lugre.state import PITCH as LUGRE_PITCH
from tsas_cli.physics.lugre.state import ROWS as LUGRE_ROWS
from tsas_cli.physics.lugre.state import TENSION as LUMP_TENSION
from tsas_cli.physics.mesh import PITCH
from tsas_cli.physics.parameters import BRISTLES, NOMINAL
from tsas_cli.physics.plant.turntable import (
    Play,
    Tangent,
    Turntable,
    across_play,
    advance_turntable,
    play_friction,
)
from tsas_cli.physics.response import force_beside_tendon, with_spring_load
from tsas_cli.physics.rig import with_values
from tsas_cli.physics.sensors import reading, true_value
from tsas_cli.physics.slip.chain import (
    between,
    initial_state,
    phase_of,
    rest_after,
    slip_chain,
    tension_at_sensor,
)
from tsas_cli.physics.slip.nodes import capstan_ratio, is_linear, set_friction
from tsas_cli.physics.slip.start import slip_laws
from tsas_cli.physics.slip.state import (
    POSITION,
    RATIO_PULLED,
    RATIO_RELEASED,
    ROWS,
    SLIP,
    TENSION,
    WRAP_PULLED,
    WRAP_RELEASED,
    Moment,
)

RISING = "load_dependent_friction.exponent"
N = 3


def test_a_drive_feels_its_friction_and_its_spring():
    ends = SimpleNamespace(direction=np.array([1.0, -1.0, 0.0]), drive=np.array([2.0, 3.0, -4.0]))
    both = {"drive_friction.friction_N": 5.0, "proximal_spring.stiffness_N_per_mm": 0.5}
    rubs, springs = ({k: v} for k, v in both.items())
    np.testing.assert_allclose(
        force_beside_tendon(with_values(GROUP_A, both), ends), [6.0, -3.5, -2.0]
    )
    np.testing.assert_allclose(
        force_beside_tendon(with_values(GROUP_A, rubs), ends), [5.0, -5.0, 0.0]
    )
    np.testing.assert_allclose(
        force_beside_tendon(with_values(GROUP_A, springs), ends), [1.0, 1.5, -2.0]
    )
    assert force_beside_tendon(GROUP_A, ends) == 0.0
    f_out = np.array([25.0, 30.0, 20.0])
    x_in, x_out, f_in, told, _ = with_spring_load(
        with_values(GROUP_A, both), ends, Tensions(f_out + 1.0, f_out, np.zeros(3))
    )
    np.testing.assert_allclose(x_out * GROUP_A.load_stiffness_N_per_mm, [0.0, 5.0, -5.0])
    np.testing.assert_allclose(f_in, f_out + 1.0 + [6.0, -3.5, -2.0])
    assert told is f_out
    assert x_in is ends.drive


def table_at(x, *, x_before=0.0, v=0.0, v_before=0.0, f_in=0.0, speed=0.0):
    return Turntable(x, x_before, v, v_before, f_in, speed)


@pytest.mark.parametrize(
    ("x", "at", "found"),
    [
        # Half of the play is 1 mm, what rubs holds 0.3 mm.
        (0.5, 0.0, 0.2),  # in the play it stays behind
        (-0.5, 0.0, -0.2),
        (0.2, 0.0, 0.0),  # and does not move for less
        (1.5, 1.0, 1.5),  # at the flank, pushing against it
        (-1.5, -1.0, -1.5),
        (-1.5, 1.0, -1.2),  # at the other flank
        (0.5, 1.0, 0.8),  # leaving it
        (1.5, 0.9, 1.2),  # not there yet
        (0.95, 1.0, 1.0),  # at the flank, not pushing
    ],
)
def test_friction_in_the_play_holds_the_drive(x, at, found):
    assert across_play(x, at, 0.0, Tangent(0.0, 1.0), Play(1.0, 0.3)) == pytest.approx(found)
    # Elsewhere, with a slope of 2: twice as near, behind an end at 7 + 3 mm.
    near = across_play(x / 2.0, at / 2.0, 10.0, Tangent(10.0, 2.0), Play(1.0, 0.15))
    assert near == pytest.approx(found / 2.0)


def test_what_rubs_is_the_part_of_the_tension_that_full_slip_takes():
    a = wrap_of(GROUP_A)
    up, down = math.exp(a), math.exp(-a)
    assert play_friction(10.0, GROUP_A) == pytest.approx(10.0 * (up - down) / (up + down))


def test_a_turntable_moves_on_by_the_backward_formula():
    before = table_at(4.0, x_before=1.0, v=7.0)
    now = advance_turntable(before, 9.0, 30.0, 2.5, 0.5)
    assert now.v == pytest.approx((1.5 * 9.0 - 2.0 * 4.0 + 0.5 * 1.0) / 0.5)
    assert now._replace(v=0.0) == table_at(9.0, x_before=4.0, v_before=7.0, f_in=30.0, speed=2.5)


def test_a_part_of_the_way_is_a_straight_line_and_the_end_exact():
    start = Moment(1.0, 2.0, Losses(3.0, 4.0, 5.0, 6.0), 7.0)
    end = Moment(2.0, 4.0, Losses(6.0, 8.0, 10.0, 12.0), 14.0)
    quarter = between(start, end, 0.25, 0.5)
    assert (quarter.drive, quarter.load, quarter.step_s) == pytest.approx((1.25, 2.5, 0.5))
    assert quarter.losses == pytest.approx((3.75, 5.0, 6.25, 7.5))
    assert between(start, end, 1.0, 0.5) == (*end[:-1], 0.5)


def test_what_a_drive_does_not_say_is_not_there():
    plain = DriveValues(0.02)
    assert set(plain[1:]) == {0.0}
    assert not has_gear(plain)
    for name in ("sine_mm", "cosine_mm", "play_mm"):
        assert has_gear(plain._replace(**{name: -0.1}))
    np.testing.assert_array_equal(lag_coefficients(plain), [1.0])
    w = 2.0 * math.pi * 5.0
    spring = plain._replace(natural_frequency_Hz=5.0, damping_ratio=0.3)
    np.testing.assert_allclose(lag_coefficients(spring), [1.0, 0.6 / w, 1.0 / w**2])
    both = spring._replace(motor_lag_s=0.2)
    expected = [1.0, 0.2 + 0.6 / w, 0.2 * 0.6 / w + 1.0 / w**2, 0.2 / w**2]
    np.testing.assert_allclose(lag_coefficients(both), expected)


def test_friction_of_both_directions_by_the_formula():
    """μ θ (1 ± α), raised by Stribeck at rest; viscous loss and lost preload beside it."""
    a = wrap_of(GROUP_A)
    rig = with_values(GROUP_A, {"direction_dependent_friction.asymmetry": 0.2})
    assert losses_without_speed(0.0, 0.0, rig) == pytest.approx((1.2 * a, 0.8 * a, 0.0, 0.0))
    at_speed = losses_at(0.0, 3.0, 0.0, rig)
    assert at_speed == pytest.approx((1.2 * a, 0.8 * a, 0.0, 0.0))
    viscous = with_values(rig, {"viscous_friction.coefficient_N_s_per_mm": 0.5})
    assert losses_at(0.0, 3.0, 0.0, viscous)[2] == pytest.approx(1.5)


def test_the_last_direction_holds_on_at_rest():
    x = np.array([1.0, 1.0, 3.0, 3.0, 2.0, 2.0])
    np.testing.assert_array_equal(last_direction(x), [0.0, 0.0, 1.0, 1.0, -1.0, -1.0])
    np.testing.assert_array_equal(last_direction(x, -1.0)[:3], [-1.0, -1.0, 1.0])


def chain_of(*tensions):
    chain = np.zeros(ROWS * PITCH)
    chain[TENSION : TENSION + len(tensions)] = tensions
    return chain


@pytest.mark.parametrize("exponent", [0.0, 0.5, -0.5, 1.0, -1.0])
def test_what_a_node_leaves_depends_on_the_mean_tension_beside_it(exponent):
    """e^(−a (T/F0)^n / 3), at twice the preload on the drive's side of the first node."""
    F0 = GROUP_A.preload_N
    chain = chain_of(2.0 * F0, 2.0 * F0, F0, 0.5 * F0, 77.0)
    laws = slip_laws(with_values(GROUP_A, {RISING: exponent}), N, LOADED_BY_SPRING)
    set_friction(chain, Moment(0.0, 0.0, Losses(0.6, 0.3, 0.0, 0.0), 1.0), laws)
    factors = np.array([2.0, 1.5, 0.75]) ** exponent
    nodes = slice(1, N + 1)
    np.testing.assert_allclose(chain[WRAP_PULLED:][nodes], 0.2 * factors)
    np.testing.assert_allclose(chain[WRAP_RELEASED:][nodes], 0.1 * factors)
    np.testing.assert_allclose(chain[RATIO_PULLED:][nodes], np.exp(-0.2 * factors))
    np.testing.assert_allclose(chain[RATIO_RELEASED:][nodes], np.exp(-0.1 * factors))
    for row in (WRAP_PULLED, WRAP_RELEASED, RATIO_PULLED, RATIO_RELEASED):
        assert not chain[row]
        assert not chain[row + N + 1]


@pytest.mark.parametrize(
    "bent",
    [
        {RISING: 0.1},
        {RISING: -1.0},
        {"presliding.length_mm": 0.1},
        {"load_inertia.mass_kg": 1.0},
        {"load_spring_nonlinearity.quadratic_per_mm": 0.1},
        {"load_spring_nonlinearity.cubic_per_mm2": -0.1},
    ],
)
def test_what_makes_a_chain_more_than_a_set_of_slipping_nodes(bent):
    assert is_linear(slip_laws(GROUP_A, N, LOADED_BY_SPRING))
    assert not is_linear(slip_laws(with_values(GROUP_A, bent), N, LOADED_BY_SPRING))


@pytest.mark.parametrize(
    ("direction", "tensions", "passed"),
    [
        (1.0, (4.0, 2.0), 0.5),  # pulling, what is released plays no part
        (-1.0, (4.0, 2.0), 5.0),
        (1.0, (-4.0, -2.0), 2.0),  # under compression the other way round
        (-1.0, (-4.0, -2.0), 0.2),
        (1.0, (-1.0, 1.0), 0.5),
    ],
)
def test_a_node_passes_on_its_ratio_or_the_inverse(direction, tensions, passed):
    chain = chain_of(*tensions)
    chain[RATIO_PULLED + 1], chain[RATIO_RELEASED + 1] = 0.5, 0.2
    assert capstan_ratio(direction, 1, chain) == pytest.approx(passed)


def test_all_nodes_of_the_sheath_make_a_phase_and_the_ends_do_not():
    for slips, phase in (((1, 1, 1), 1), ((-1, -1, -1), -1), ((1, 1, 0), 0), ((0, 1, 1), 0)):
        chain = chain_of()
        chain[SLIP] = chain[SLIP + N + 1] = 5.0
        chain[SLIP + 1 : SLIP + N + 1] = slips
        assert phase_of(chain, N) == phase


def test_a_sensor_at_the_load_feels_the_tension_less_what_rubs_before_it():
    now = Moment(0.0, 40.0, Losses(0.4, 0.4, 0.0, 0.0), math.inf)
    plain = slip_laws(GROUP_A, N, LOADED_BY_SPRING)
    chain = chain_of(9.0, 9.0, 9.0, 30.0, 9.0)
    chain[SLIP + N + 1] = -1.0
    assert tension_at_sensor(chain, now, at(plain, LOADED_BY_FORCE)) == 40.0
    assert tension_at_sensor(chain, now, at(plain, LOADED_BY_SPRING)) == 30.0
    before = {"load_friction.before_sensor_N": 3.0}
    rubs = slip_laws(with_values(GROUP_A, before), N, LOADED_BY_SPRING)
    assert tension_at_sensor(chain, now, at(rubs, LOADED_BY_DISPLACEMENT)) == 33.0
    # The spring pulls with the preload and k x; of 30 N less that, 3 of 4 N rub before.
    after = slip_laws(
        with_values(GROUP_A, before | {"load_friction.after_sensor_N": 1.0}), N, LOADED_BY_SPRING
    )
    chain[POSITION + N + 1] = 2.0
    back = GROUP_A.preload_N + 2.0 * GROUP_A.load_stiffness_N_per_mm
    felt = tension_at_sensor(chain, now, at(after, LOADED_BY_SPRING))
    assert felt == pytest.approx(30.0 - 0.75 * (30.0 - back))


@pytest.mark.parametrize(
    ("boundary", "given"),
    [
        (LOADED_BY_SPRING, (0.0, 0.0)),
        (LOADED_BY_FORCE, (0.0, GROUP_A.preload_N)),
        (DRIVEN_BY_FORCE, (GROUP_A.preload_N, 0.0)),
    ],
)
def test_before_a_course_everything_is_at_the_preload(boundary, given):
    state = initial_state(course_of(np.array([1.0, 2.0]), GROUP_A), GROUP_A, boundary, N)
    a = wrap_of(GROUP_A)
    assert state.before.losses == pytest.approx((a, a, 0.0, 0.0))
    assert (state.before.drive, state.before.load, state.before.step_s) == (*given, math.inf)
    np.testing.assert_array_equal(state.chain[TENSION : TENSION + N + 1], GROUP_A.preload_N)
    np.testing.assert_array_equal(state.chain[POSITION : POSITION + N + 2], 0.0)
    assert (*state.ends, state.unconverged) == (0.0, 0.0, 0.0, 0.0, 0)


def test_frames_hold_the_samples_that_are_asked_for():
    """The first and the last but one: tensions as they are after these."""
    course = course_of(np.array([0.0, 0.5, 1.2, 0.8, 0.3]), GROUP_A)
    frames = empty_frames(np.array([0, 3]), N)
    slip_chain(course, GROUP_A, LOADED_BY_SPRING, N, frames)
    for k, i in enumerate((0, 3)):
        _, tensions = rest_after(course[:, : i + 1], GROUP_A, LOADED_BY_SPRING, N)
        np.testing.assert_allclose(frames.tension_N[k], tensions[: N + 1])


def test_the_front_is_where_slip_changes_first():
    frames = empty_frames(np.array([4, 6, 9]), 4)
    frames.slip[:] = [[1, 1, 0, 1], [-1, -1, -1, -1], [0, 1, 1, 1]]
    assert [slips_up_to(frames, k) for k in range(3)] == [0.5, 1.0, 0.0]
    frames.slip[0] = 2
    assert slips_up_to(frames, 0) == 0.0  # slack
    assert [is_next(frames, k, 6) for k in range(4)] == [False, True, False, False]
    np.testing.assert_array_equal(
        empty_frames(np.array([1]), 4).places, [0.0, 0.25, 0.5, 0.75, 1.0]
    )


def limits(rig, *, bristles=(1.0, -1.0, 1.0), speeds=(0.0, 0.0, 0.0), **other):
    s = np.zeros(LUGRE_ROWS * LUGRE_PITCH)
    F0 = rig.preload_N
    s[LUMP_TENSION : LUMP_TENSION + N + 1] = [2.0 * F0, 2.0 * F0, F0, -4.0 * F0]
    s[DEFLECTION_HISTORY + 1 : DEFLECTION_HISTORY + N + 1] = bristles
    s[RATE + 1 : RATE + N + 1] = speeds
    step = bare_step(gh=0.1, pulled=0.2, released=0.1, **other)
    set_limits(s, step, lugre_laws(rig, N, LOADED_BY_SPRING))
    rows = (LIMIT, LIMIT_BY_T, LIMIT_BY_V)
    assert not any(s[row] or s[row + N + 1] for row in rows)  # an end has a limit of its own
    return [s[row + 1 : row + N + 1] for row in rows]


@pytest.mark.parametrize("exponent", [0.0, 0.5, -0.5, 1.0, -1.0])
def test_limits_of_friction_follow_the_mean_tension(exponent):
    """c T̄ (T̄/F0)^n, by the direction of the bristles; its slope over T̄ is (n + 1) times as much."""
    rig = with_values(GROUP_A, {RISING: exponent})
    mean = np.array([2.0, 1.5, -1.5])
    share = np.array([0.2, 0.1, -0.2]) * np.abs(mean) ** exponent
    found, by_tension, by_speed = limits(rig)
    np.testing.assert_allclose(found, share * mean * GROUP_A.preload_N, atol=1e-3)
    np.testing.assert_allclose(by_tension, share * (1.0 + exponent), atol=1e-12)
    assert not by_speed.any()


def test_bristles_are_taken_where_the_step_brings_them():
    """At rest before: by the speeds, of the frame too, over 0.1 s."""
    found, *_ = limits(GROUP_A, bristles=(0.0, 0.0, 0.3), speeds=(1.0, -3.0, -6.0), speed=2.0)
    share = np.array([0.2, 0.1, -0.1])
    np.testing.assert_allclose(
        found, share * np.array([2.0, 1.5, -1.5]) * GROUP_A.preload_N, atol=1e-3
    )


def test_friction_at_rest_is_higher_where_stribeck_says_so():
    """Held against its own slope: a difference over the speed."""
    values = {"excess": 0.5, "velocity_mm_per_s": 2.0}
    rig = with_values(GROUP_A, {f"stribeck_friction.{n}": v for n, v in values.items()})
    still, *_ = limits(rig)
    plain, *_ = limits(GROUP_A)
    np.testing.assert_allclose(still, 1.5 * plain)
    moving, _, slope = limits(rig, speed=1.0)
    faster, *_ = limits(rig, speed=1.0 + 1e-6)
    np.testing.assert_allclose(slope, (faster - moving) / 1e-6, rtol=1e-4)
    assert (np.abs(moving) < np.abs(still)).all()


TIMES = np.arange(9.0)


def unseen_of(drive, load, boundary):
    course = course_of(drive, GROUP_A, load=load, time_s=TIMES)
    law, within = lugre_laws(GROUP_A, N, boundary), Samples(1, 8)
    return input_error(course, within, Span(0.0, 8.0), step_ends(), bare_step(), (3.0, 5.0), law)


def test_a_step_does_not_see_what_happens_within_it():
    """A bump of 2 in the middle of drive and load, where it saw nothing: 3 · 2 and 5 · 2 N."""
    bump, flat = 2.0 * (TIMES >= 1.0) * (TIMES < 8.0), np.zeros(9)
    assert unseen_of(bump, flat, LOADED_BY_SPRING) == pytest.approx(6.0)
    assert unseen_of(flat, bump, LOADED_BY_SPRING) == 0.0  # a spring is not given
    assert unseen_of(flat, bump, LOADED_BY_FORCE) == pytest.approx(10.0)
    assert unseen_of(bump, bump, LOADED_BY_DISPLACEMENT) == pytest.approx(16.0)


@pytest.mark.parametrize("parameter", [*NOMINAL, *BRISTLES], ids=lambda p: p.name)
def test_bounds_are_whole_powers_of_ten(parameter):
    """Nobody has measured a finer limit of what is plausible."""
    for bound in (parameter.lower, parameter.upper):
        power = math.log10(abs(bound))
        assert power == pytest.approx(round(power), abs=1e-12)
    assert parameter.lower < parameter.upper
    assert (parameter.lower > 0.0) == parameter.positive
    if not parameter.positive:
        assert parameter.lower == -parameter.upper


SENSED = with_values(
    GROUP_A,
    {
        "channel_delay.f_out_delay_s": 0.5,
        "channel_delay.x_out_delay_s": 0.25,
        "force_sensor_gain.f_out_gain": 1.1,
        "position_sensor_gain.x_out_gain": 0.9,
        "force_sensor_offset.f_in_offset_N": 2.0,
        "force_sensor_offset.f_out_offset_N": -3.0,
        "force_sensor_drift.f_in_rate_N_per_s": 0.1,
    },
)._replace(x_out_zero_mm=7.0)
RAMP = 10.0 * TIMES


@pytest.mark.parametrize(
    ("channel", "late", "gain", "shift"),
    [
        ("f_in_N", 0.0, 1.0, 2.0 + 0.1 * TIMES),
        ("f_out_N", 0.5, 1.1, -3.0),
        ("x_out_mm", 0.25, 0.9, 7.0),
    ],
)
def test_a_channel_is_late_scaled_and_shifted(channel, late, gain, shift):
    seen = reading(channel, RAMP, TIMES, SENSED)
    np.testing.assert_allclose(seen, gain * np.maximum(RAMP - 10.0 * late, 0.0) + shift)
    back = true_value(channel, seen, TIMES, SENSED)
    np.testing.assert_allclose(back[1:-1], RAMP[1:-1])
    still = reading(channel, RAMP, None, SENSED)
    np.testing.assert_allclose(still, gain * RAMP + (2.0 if channel == "f_in_N" else shift))


def test_a_bent_spring_is_bent_by_its_names():
    bent = with_values(
        GROUP_A,
        {
            "load_spring_nonlinearity.quadratic_per_mm": 0.3,
            "load_spring_nonlinearity.cubic_per_mm2": 0.2,
        },
    )
    assert slip_laws(bent, N, LOADED_BY_SPRING).load.nonlinearity == LoadSpringNonlinearity(
        0.3, 0.2
    )
