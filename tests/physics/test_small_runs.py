"""What acts at the ends of a run, and how it is answered, of few samples on few nodes."""

import math

import numpy as np
import pytest

from tests.physics.references import GROUP_A, wrap_of
from tsas_cli.effects import EFFECTS
from tsas_cli.physics import response
from tsas_cli.physics.boundary import DISPLACEMENT, FORCE, SPRING, Boundary
from tsas_cli.physics.course import (
    DIRECTION,
    DRIVE,
    LOAD,
    STEP,
    TRAVEL,
)
from tsas_cli.physics.ends import (
    DriveInput,
    ends_of,
    force_of_motion,
    last_direction,
    losses_at,
)
from tsas_cli.physics.response import NODES, first_determined_sample, is_closed, simulate
from tsas_cli.physics.rig import with_values

RIG = GROUP_A._replace(x_in_zero_mm=3.0, x_out_zero_mm=-7.0)
A = wrap_of(GROUP_A)
VARYING = with_values(
    GROUP_A,
    {
        "direction_dependent_friction.asymmetry": 0.2,
        "friction_drift.rate_per_s": 0.1,
        "friction_drift.session_rate_per_s": 0.01,
        "bend_drift.rate_rad_per_s": 0.3,
        "preload_loss.rate_N_per_s": 0.5,
        "position_dependent_friction.slope_per_mm": 0.02,
        "stribeck_friction.excess": 0.4,
        "stribeck_friction.velocity_mm_per_s": 2.0,
        "viscous_friction.coefficient_N_s_per_mm": 0.05,
    },
)
TIME_S = np.array([0.0, 0.1, 0.3, 0.4])


def friction_by_hand(time_s, position, speed, session_s):
    """Return friction times bend of a pull and of a release, viscous loss and lost preload."""
    wrap = 0.125 * (1.0 + 0.1 * time_s + 0.01 * session_s) * (math.pi + 0.3 * time_s)
    wrap *= 1.0 + 0.02 * position
    return 1.2 * wrap, 0.8 * wrap, 0.05 * abs(speed), 0.5 * time_s


@pytest.mark.parametrize("speed", [0.0, 3.0, -1.0])
def test_friction_at_a_moment_is_all_that_changes_it(speed):
    expected = friction_by_hand(4.0, 7.0, speed, 30.0)
    assert losses_at(4.0, 7.0, speed, 30.0, VARYING) == pytest.approx(expected)


def test_the_course_of_a_run_is_what_acts_at_each_sample():
    x = np.array([0.0, 0.2, 0.9, 0.8])
    ends = ends_of(VARYING, DriveInput(x, time_s=TIME_S, session_s=30.0))
    assert ends.boundary == Boundary(DISPLACEMENT, SPRING)
    np.testing.assert_array_equal(ends.drive, x)
    np.testing.assert_array_equal(ends.course[LOAD], 0.0)
    moments = zip(TIME_S, x, np.gradient(x, TIME_S), strict=True)
    expected = [friction_by_hand(t, place, v, 30.0) for t, place, v in moments]
    np.testing.assert_allclose(ends.course[:4].T, expected)
    np.testing.assert_allclose(ends.course[STEP], [math.inf, 0.1, 0.2, 0.1])
    assert ends.course[DIRECTION].tolist() == [0.0, 1.0, 1.0, -1.0]
    by_force = ends_of(VARYING, DriveInput(x + 25.0, "force", time_s=TIME_S))
    unmoved = friction_by_hand(0.3, 0.0, 0.0, 0.0)  # its position and speed are not known
    np.testing.assert_allclose(by_force.course[:4, 2], unmoved)
    slowly = ends_of(VARYING, DriveInput(x))
    still = [friction_by_hand(0.0, place, 0.0, 0.0) for place in x]
    np.testing.assert_allclose(slowly.course[:4].T, still)
    assert slowly.course[STEP].tolist() == [math.inf] * 4
    two = ends_of(VARYING, DriveInput(x[:2], time_s=TIME_S[:2], session_s=30.0))
    expected = [friction_by_hand(t, place, 2.0, 30.0) for t, place in ((0.0, 0.0), (0.1, 0.2))]
    np.testing.assert_allclose(two.course[:4].T, expected)
    alone = ends_of(VARYING, DriveInput(x[:1], time_s=TIME_S[:1]))
    assert alone.course[STEP].tolist() == [math.inf]


@pytest.mark.parametrize(
    ("load", "at_load"),
    [
        ("spring", (SPRING, [0.0, 0.0])),
        ("force", (FORCE, [26.0, 27.0])),
        ("displacement", (DISPLACEMENT, [33.0, 34.0])),
    ],
)
@pytest.mark.parametrize(
    ("kind", "at_drive"),
    [("displacement", (DISPLACEMENT, [7.0, 8.0])), ("force", (FORCE, [10.0, 11.0]))],
)
def test_what_is_given_at_the_ends_is_read_with_the_zeros(kind, at_drive, load, at_load):
    """Both places count from their zeros, no force does."""
    given = DriveInput(np.array([10.0, 11.0]), kind, load, np.array([26.0, 27.0]))
    ends = ends_of(RIG, given)
    assert (ends.boundary.drive, ends.course[DRIVE].tolist()) == at_drive
    assert (ends.boundary.load, ends.course[LOAD].tolist()) == at_load


def test_what_is_given_at_the_ends_is_free_of_the_sensors_errors():
    offsets = {"f_in_offset_N": 2.0, "f_out_offset_N": -1.0}
    rig = with_values(GROUP_A, {f"force_sensor_offset.{n}": v for n, v in offsets.items()})
    forces = np.array([4.0, 6.0])
    ends = ends_of(rig, DriveInput(forces, "force", "force", 2.0 * forces))
    assert ends.course[DRIVE].tolist() == [2.0, 4.0]
    assert ends.course[LOAD].tolist() == [9.0, 13.0]


def test_the_drives_end_goes_through_the_play_from_where_it_was():
    loose = with_values(GROUP_A, {"backlash.play_mm": 0.4})
    drive = DriveInput(np.array([1.0, 1.5, 1.5, 1.2, 0.8]))
    assert ends_of(loose, drive).drive.tolist() == pytest.approx([1.0, 1.3, 1.3, 1.3, 1.0])
    again = ends_of(loose, drive, (1.1, -1.0, 0.5))
    assert again.drive.tolist() == pytest.approx([1.1, 1.3, 1.3, 1.3, 1.0])
    assert again.course[DIRECTION].tolist() == [-1.0, 1.0, 1.0, 1.0, -1.0]
    assert again.course[TRAVEL].tolist() == pytest.approx([0.5, 0.2, 0.2, 0.2, 0.3])
    wave = {"drive_ripple.sine_mm": 0.1, "drive_ripple.cosine_mm": 0.2, "drive_ripple.period_mm": 4}
    uneven = ends_of(with_values(GROUP_A, wave), DriveInput(np.array([1.0, 2.0])))
    assert uneven.drive.tolist() == pytest.approx([1.0 + 0.1 - 0.2, 2.0 - 0.4])


@pytest.mark.parametrize(("damping", "mass_kg"), [(0.0, 1.0), (1.0, 0.0), (0.3, 2.0)])
def test_the_sensor_at_the_drive_feels_what_moves_the_tendons_end(damping, mass_kg):
    """c v + m a, and no acceleration where no time is known."""
    names = ("drive_damping.coefficient_N_s_per_mm", "drive_inertia.mass_kg")
    rig = with_values(GROUP_A, dict(zip(names, (damping, mass_kg), strict=True)))
    x, speed = TIME_S**2, 6.0 + 100.0 * TIME_S
    felt = force_of_motion(speed, TIME_S, rig.effects)
    np.testing.assert_allclose(felt, damping * speed + 1e-3 * mass_kg * 100.0)
    np.testing.assert_allclose(force_of_motion(speed, None, rig.effects), damping * speed)
    felt = force_of_motion(np.gradient(x, TIME_S), TIME_S, rig.effects)
    np.testing.assert_allclose(ends_of(rig, DriveInput(x, time_s=TIME_S)).course[-1], felt)


def test_the_direction_is_that_of_the_last_motion():
    x = np.array([1.0, 1.0, 2.0, 2.0, 1.5, 1.5])
    assert last_direction(x).tolist() == [0.0, 0.0, 1.0, 1.0, -1.0, -1.0]
    assert last_direction(x, -1.0).tolist() == [-1.0, -1.0, 1.0, 1.0, -1.0, -1.0]


def test_a_last_bit_is_no_motion_and_a_creep_is_one():
    """The mean of equal values may differ from them: friction would change its sign at a rest."""
    rest = np.array([1.0, 5.0, np.nextafter(5.0, 0.0), 5.0, np.nextafter(5.0, 9.0), 5.5])
    assert last_direction(rest).tolist() == [0.0, 1.0, 1.0, 1.0, 1.0, 1.0]
    creep = 5.0 - 4e-10 * np.arange(6)
    assert last_direction(creep, 1.0).tolist() == [1.0, 1.0, 1.0, -1.0, -1.0, -1.0]


MOTION = np.array([0.5, 1.0, 0.7, 0.7, 0.9])


@pytest.mark.parametrize(("friction", "stiffness"), [(2.0, 4.0), (0.0, 4.0), (2.0, 0.0)])
@pytest.mark.parametrize("nodes", [None, 3])
def test_the_sensor_at_the_drive_feels_what_is_beside_the_tendon(friction, stiffness, nodes):
    names = ("drive_friction.friction_N", "proximal_spring.stiffness_N_per_mm")
    beside = with_values(RIG, dict(zip(names, (friction, stiffness), strict=True)))
    drive = DriveInput(MOTION + 3.0)
    plain, answer = (simulate(rig, drive, nodes=nodes) for rig in (RIG, beside))
    felt = friction * np.array([0.0, 1.0, -1.0, -1.0, 1.0]) + stiffness * MOTION
    np.testing.assert_allclose(answer.f_in_N - plain.f_in_N, felt, atol=1e-9)
    np.testing.assert_allclose(answer.f_out_N, plain.f_out_N)
    np.testing.assert_array_equal(answer.x_in_mm, MOTION + 3.0)


@pytest.mark.parametrize(("load", "read"), [("force", "f_out_N"), ("displacement", "x_out_mm")])
def test_a_load_that_was_measured_is_read_again(load, read):
    spring = simulate(RIG, DriveInput(MOTION + 3.0), nodes=3)
    given = DriveInput(MOTION + 3.0, load=load, load_values=getattr(spring, read))
    again = simulate(RIG, given, nodes=3)
    for name in ("x_in_mm", "x_out_mm", "f_in_N", "f_out_N"):
        np.testing.assert_allclose(getattr(again, name), getattr(spring, name), atol=1e-6)
    by_force = simulate(RIG, DriveInput(spring.f_in_N, "force"), nodes=3)
    np.testing.assert_allclose(by_force.x_in_mm, spring.x_in_mm, atol=1e-6)


def test_who_answers_and_on_what_mesh():
    """The paper's dynamic chain has 50 lumps."""
    drive = DriveInput(MOTION[:2] + 3.0, time_s=TIME_S[:2])
    assert simulate(RIG, drive).solver == "closed form"
    assert simulate(RIG, drive, nodes=NODES).solver == "slip chain, 60 nodes"
    assert simulate(RIG, drive, "static").solver == "lumped dead bands"
    at_rest = DriveInput(np.array([3.0, 3.0]), time_s=TIME_S[:2])
    assert simulate(RIG, at_rest, "lugre").solver.startswith("LuGre chain, 50 lumps, ")
    for nodes in (2, 1000):
        solver = simulate(RIG, at_rest, nodes=nodes).solver
        assert solver == f"slip chain, {nodes} nodes"
    for nodes in (1, 1001):
        with pytest.raises(ValueError, match=f"{nodes} nodes; expected 2 to 1000"):
            simulate(RIG, drive, nodes=nodes)
    with pytest.raises(ValueError, match="times"):
        simulate(RIG, DriveInput(MOTION), "lugre")


AT_THE_ENDS_ALONE = {  # what the closed form knows, or what is off its path
    *("backlash", "drive_compliance", "drive_damping", "drive_friction", "drive_inertia"),
    *("drive_ripple", "free_tendon", "proximal_spring", "sheath_compression"),
}


@pytest.mark.parametrize("effect", EFFECTS, ids=[effect.name for effect in EFFECTS])
def test_where_the_closed_form_holds(effect):
    """A sensor's fault comes after it, what acts on tendon or load is not in it."""
    rig = with_values(RIG, {f"{effect.name}.{p.name}": p.start for p in effect.parameters})
    known = effect.name in AT_THE_ENDS_ALONE or effect.acts_on == "sensor"
    wrong = f"{effect.name}: its closed_form, or AT_THE_ENDS_ALONE, says otherwise"
    assert is_closed(rig, DriveInput(MOTION)) == known, wrong


def test_where_else_the_closed_form_does_not_hold():
    assert is_closed(RIG, DriveInput(MOTION))
    assert not is_closed(RIG, DriveInput(MOTION, "force"))
    assert not is_closed(RIG, DriveInput(MOTION, load="force", load_values=MOTION))
    assert not is_closed(RIG._replace(bend_slope=0.1), DriveInput(MOTION))
    assert not is_closed(RIG._replace(bend_bow=0.1), DriveInput(MOTION))


@pytest.mark.parametrize("wanted", [38.0, 50.0, 62.0])
@pytest.mark.parametrize("nodes", [None, 3])
def test_the_history_of_a_run_is_chosen_by_its_first_tension(wanted, nodes):
    """At 15 mm between 35 N, let go of, and 62.9 N, pulled; no more than that drive is passed."""
    drive = DriveInput(np.array([18.0, 18.1]), start_f_in_N=wanted)
    answer = simulate(RIG, drive, nodes=nodes, looked_at=np.array([1]))
    assert answer.f_in_N.shape == (2,)
    assert answer.f_in_N[0] == pytest.approx(wanted, abs=1e-6)
    assert answer.frames.samples.tolist() == [1]
    assert answer.frames.tension_N[0, 0] == pytest.approx(answer.f_in_N[1])


@pytest.mark.parametrize(("kind", "dynamics"), [("force", "slip"), ("displacement", "static")])
def test_a_drive_by_force_and_the_static_model_have_no_history_to_choose(kind, dynamics):
    drives = (DriveInput(np.array([28.0, 29.0]), kind, start_f_in_N=f) for f in (None, 40.0))
    plain, asked = (simulate(RIG, drive, dynamics) for drive in drives)
    np.testing.assert_array_equal(asked.x_out_mm, plain.x_out_mm)


def test_what_is_forgotten_of_a_drive_by_force(monkeypatch):
    """Let go of, and pulled until it slips as a whole: e^2a times the tension at first."""
    monkeypatch.setattr(response, "NODES", 3)
    pull = 25.0 * np.exp(np.linspace(0.0, 1.2, 25))
    first = first_determined_sample(GROUP_A, DriveInput(pull, kind="force"))
    assert first == np.flatnonzero(pull > 25.0 * math.exp(2.0 * A))[0]
    assert first_determined_sample(GROUP_A, DriveInput(pull[: first - 1], kind="force")) is None
