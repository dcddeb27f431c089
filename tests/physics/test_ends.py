"""What is given at the ends of a tendon: losses, directions, speeds and steps of a course."""

import math

import numpy as np
import pytest

from tests.physics.references import GROUP_A, wrap_of
from tsas_cli.physics.boundary import DISPLACEMENT, FORCE, SPRING
from tsas_cli.physics.course import DRIVE, LOAD, PULLED, RELEASED, STEP, VISCOUS
from tsas_cli.physics.ends import (
    DriveInput,
    ends_of,
    last_direction,
    losses_at,
    losses_without_speed,
)
from tsas_cli.physics.rig import with_values


def test_friction_of_both_directions_by_the_formula():
    """μ θ (1 ± α), raised by Stribeck at rest; viscous loss and lost preload beside it."""
    a = wrap_of(GROUP_A)
    rig = with_values(GROUP_A, {"direction_dependent_friction.asymmetry": 0.2})
    assert losses_without_speed(0.0, 0.0, 0.0, rig) == pytest.approx((1.2 * a, 0.8 * a, 0.0, 0.0))
    at_speed = losses_at(0.0, 0.0, 3.0, 0.0, rig)
    assert at_speed == pytest.approx((1.2 * a, 0.8 * a, 0.0, 0.0))
    viscous = with_values(rig, {"viscous_friction.coefficient_N_s_per_mm": 0.5})
    assert losses_at(0.0, 0.0, 3.0, 0.0, viscous)[2] == pytest.approx(1.5)


def test_the_last_direction_holds_on_at_rest():
    x = np.array([1.0, 1.0, 3.0, 3.0, 2.0, 2.0])
    np.testing.assert_array_equal(last_direction(x), [0.0, 0.0, 1.0, 1.0, -1.0, -1.0])
    np.testing.assert_array_equal(last_direction(x, -1.0)[:3], [-1.0, -1.0, 1.0])


A = wrap_of(GROUP_A)
TIME_S = np.array([1.0, 1.5, 3.0])
LEVELS = np.array([4.0, 6.0, 3.0])


def test_a_course_by_displacement_has_speeds_steps_and_the_last_directions():
    rig = with_values(
        GROUP_A._replace(x_in_zero_mm=1.0), {"viscous_friction.coefficient_N_s_per_mm": 0.5}
    )
    found = ends_of(rig, DriveInput(LEVELS, time_s=TIME_S))
    assert found.boundary == (DISPLACEMENT, SPRING)
    np.testing.assert_allclose(found.drive, [3.0, 5.0, 2.0])
    np.testing.assert_allclose(found.course[LOAD], 0.0)
    np.testing.assert_allclose(found.course[[PULLED, RELEASED]], A)
    # Speeds of 2 mm/s up, then 2 mm/s down; in between weighed by the other side's time.
    np.testing.assert_allclose(np.abs(found.course[VISCOUS]), 0.5 * np.array([4.0, 2.5, 2.0]))
    np.testing.assert_allclose(found.course[STEP], [math.inf, 0.5, 1.5])
    np.testing.assert_array_equal(found.direction, [0.0, 1.0, -1.0])
    still = ends_of(rig, DriveInput(LEVELS))
    assert not still.course[VISCOUS].any()
    assert np.isinf(still.course[STEP]).all()
    assert found.first().course.shape == (8, 1)
    assert found.first().direction.shape == (1,)


def test_a_course_by_force_is_free_of_the_sensors_errors():
    rig = with_values(
        GROUP_A._replace(x_out_zero_mm=0.5),
        {"force_sensor_offset.f_in_offset_N": 2.0, "force_sensor_offset.f_out_offset_N": -1.0},
    )
    pulled = ends_of(rig, DriveInput(LEVELS, kind="force", load="force", load_values=2.0 * LEVELS))
    assert pulled.boundary == (FORCE, FORCE)
    np.testing.assert_allclose(pulled.course[[DRIVE, LOAD]], [LEVELS - 2.0, 2.0 * LEVELS + 1.0])
    placed = ends_of(rig, DriveInput(LEVELS, load="displacement", load_values=LEVELS))
    assert placed.boundary == (DISPLACEMENT, DISPLACEMENT)
    np.testing.assert_allclose(placed.course[LOAD], LEVELS - 0.5)


def test_a_run_goes_on_with_the_play_and_the_direction_that_it_had():
    """A play of 2 mm: the tendon's end stays while the drive crosses it."""
    rig = with_values(GROUP_A, {"backlash.play_mm": 2.0})
    begun = ends_of(rig, DriveInput(LEVELS))
    np.testing.assert_allclose(begun.drive, [4.0, 5.0, 4.0])
    goes_on = ends_of(rig, DriveInput(LEVELS), (4.5, -1.0))
    np.testing.assert_allclose(goes_on.drive, [4.5, 5.0, 4.0])
    np.testing.assert_array_equal(goes_on.direction, [-1.0, 1.0, -1.0])
