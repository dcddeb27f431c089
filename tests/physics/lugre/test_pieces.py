"""Pieces of the dynamic chain: limits of friction, ends, what a step sees, how runs go."""

import math

import numpy as np
import pytest

from tests.physics.lugre.lumps import LAST, STEP, cleared, nodes, run, segments
from tests.physics.references import (
    DRIVEN_BY_FORCE,
    GROUP_A,
    LOADED_BY_DISPLACEMENT,
    LOADED_BY_FORCE,
    LOADED_BY_SPRING,
    at,
    course_of,
)
from tsas_cli.physics.boundary import FORCE
from tsas_cli.physics.course import DRIVE, LOAD
from tsas_cli.physics.lugre import state as rows
from tsas_cli.physics.lugre.balance import balance, end_friction, set_limits
from tsas_cli.physics.lugre.chain import OWN_STEPS, phase_of
from tsas_cli.physics.lugre.ends import (
    F_IN,
    F_OUT,
    X_IN,
    X_OUT,
    EndState,
    Samples,
    Span,
    StepEnds,
    write_samples,
)
from tsas_cli.physics.lugre.start import rest_at
from tsas_cli.physics.lugre.state import Given, Step
from tsas_cli.physics.phases import SLACK, UNCONVERGED
from tsas_cli.physics.rig import with_values

F0, KL = 25.0, 1.579
BOUNDARIES = [LOADED_BY_SPRING, LOADED_BY_FORCE, LOADED_BY_DISPLACEMENT, DRIVEN_BY_FORCE]
NONE = Given(0.0, 0.0)


def lumps(rig, *, speeds=(0.0,) * 5, tensions=(40.0, 31.0, 22.0, 13.0)):
    """Return lumps with these speeds and tensions, their segments rigid in this step."""
    s, law = cleared(rig)
    nodes(s, rows.RATE)[:] = speeds
    for row in (rows.TENSION_HISTORY, rows.TENSION):
        segments(s, row)[:] = tensions
    return s, law


@pytest.mark.parametrize(
    ("exponent", "excess"),
    [(0.0, 0.4), (1.0, 0.4), (-1.0, 0.4), (-0.4, 0.4), (0.3, 0.4), (1.0, 0.0), (0.0, -0.5)],
)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_limits_of_friction_follow_tension_way_and_speed(exponent, excess, sign):
    """By the mean of both tensions; in contraction where its bristles lean towards the drive."""
    values = {
        "load_dependent_friction.exponent": exponent,
        "stribeck_friction.excess": excess,
        "stribeck_friction.velocity_mm_per_s": 2.0,
    }
    speeds = np.array([0.0, 1.0, -4.0, 0.5, 0.0])
    tensions = sign * np.array([40.0, 31.0, 22.0, 13.0])
    s, law = lumps(with_values(GROUP_A, values), speeds=speeds, tensions=tensions)
    s[rows.DEFLECTION_HISTORY + 3] = -0.01
    set_limits(s, STEP, law)
    found = [nodes(s, row) for row in (rows.LIMIT, rows.LIMIT_BY_T, rows.LIMIT_BY_V)]
    for i, wrap in ((1, 0.14), (2, 0.11), (3, 0.11)):

        def limit(tension, v, wrap=wrap):
            factor = wrap * (abs(tension) / 10.0) ** exponent
            return abs(tension) * factor * (1.0 + excess * math.exp(-((v / 2.0) ** 2)))

        mean, v, d = 0.5 * (tensions[i - 1] + tensions[i]), speeds[i] + 1.5, 1e-5
        by_t = (limit(mean + d, v) - limit(mean - d, v)) / (2.0 * d)
        by_v = (limit(mean, v + d) - limit(mean, v - d)) / (2.0 * d)
        assert found[0][i] == pytest.approx(limit(mean, v), rel=1e-8)
        assert [each[i] for each in found[1:]] == pytest.approx([by_t, by_v], rel=1e-6, abs=1e-9)
    for each in found:  # an end has none of a lump
        assert each[0] == each[LAST] == 0.0


ENDS = StepEnds(
    EndState(Given(1.0, 2.0), 0.0, 0.0, 30.0, 0.0),
    EndState(Given(10.0, 3.0), 0.0, 0.0, 20.0, 0.0),
    0.5,
)


@pytest.mark.parametrize("boundary", BOUNDARIES)
def test_samples_within_a_step_read_what_was_given_and_what_answered(boundary):
    """Everything goes straight here; the guide's share is taken off what the sensor reads."""
    rubs = {"load_friction.before_sensor_N": 1.5, "load_friction.after_sensor_N": 3.0}
    times, law = np.linspace(0.0, 1.0, 11), cleared(with_values(GROUP_A, rubs))[1]
    course = course_of(100.0 + times, GROUP_A, load=101.0 + times, time_s=times)
    a = StepEnds(EndState(NONE, 1.0, 10.0, 30.0, 40.0), EndState(NONE, 2.0, 20.0, 50.0, 60.0), 0.0)
    b = StepEnds(EndState(NONE, 6.0, 10.0, 50.0, 40.0), EndState(NONE, 12.0, 20.0, 80.0, 60.0), 3.0)
    columns = np.full((4, 11), -1.0)
    write_samples(columns, Samples(3, 7), course, Span(0.25, 0.5), a, b, at(law, boundary))
    since = times[3:7] - 0.25
    expected = {X_IN: 1.0 + 10.0 * since, X_OUT: 2.0 + 20.0 * since, F_IN: 30.0 + 40.0 * since}
    share = 1.0 if boundary == LOADED_BY_DISPLACEMENT else 1.0 / 3.0
    expected[F_OUT] = 50.0 + 60.0 * since - share * 3.0 * since / 0.5
    expected[F_IN if boundary.drive == FORCE else X_IN] = course[DRIVE, 3:7]
    if boundary.load != LOADED_BY_SPRING.load:
        expected[F_OUT if boundary.load == FORCE else X_OUT] = course[LOAD, 3:7]
    for row, values in expected.items():
        np.testing.assert_allclose(columns[row, 3:7], values)
    assert np.all(columns[:, [0, 1, 2, 7, 8, 9, 10]] == -1.0)


@pytest.mark.parametrize("exponent", [0.0, 0.3])
@pytest.mark.parametrize("length", [0.0, 0.02])
def test_lumps_that_are_laid_down_stay_where_they_are(length, exponent):
    """Their bristles carry what the tensions leave over, to either side by its own limit."""
    values = {
        "presliding.length_mm": length,
        "load_dependent_friction.exponent": exponent,
        "drive_friction.friction_N": 2.0,
        "load_friction.after_sensor_N": 3.0,
    }
    s, law = lumps(with_values(GROUP_A, values))
    tensions = np.array([21.0, 22.0, 21.5, 22.3])
    start = np.array([[0.7, 0.5, 0.3, 0.2, 0.1], [*tensions, 0.0]])
    step = Step(1e-13, Given(21.5, 0.0), NONE, NONE, 0.14, 0.06, 2.0)
    moving = (rows.SPEED, rows.SPEED_HISTORY, rows.RATE, rows.TENSION_SLOPE)
    for row in moving:
        nodes(s, row)[:] = 9.0
    ends = rest_at(s, start, step, at(law, DRIVEN_BY_FORCE))
    assert not any(nodes(s, row).any() for row in moving)
    assert (ends.drive.tension, ends.drive.x) == (21.0, 0.7)
    assert (ends.load.tension, ends.load.x) == (22.3, 0.1)
    left = np.array([0.5, *-np.diff(tensions), 22.3 - (23.0 + KL * 0.1)])
    bent = nodes(s, rows.DEFLECTION)
    nodes(s, rows.DEFLECTION_HISTORY)[:] = bent
    total = balance(s, step, at(law, DRIVEN_BY_FORCE))
    assert total == pytest.approx(np.abs(nodes(s, rows.RESIDUAL)[[0, LAST]]).sum(), abs=1e-6)
    np.testing.assert_allclose(nodes(s, rows.FRICTION)[1:LAST], left[1:LAST], rtol=1e-5)
    assert bent[[0, LAST]] == pytest.approx(left[[0, LAST]] / law.end_bristle.stiffness)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_what_is_left_at_rest_bends_bristles_up_to_their_limit_and_the_loads_element(sign):
    """Travel is the share of a limit of 3 N; the element yields at 2 N, the guide has the rest."""
    values = {"presliding.length_mm": 0.05, "load_friction.after_sensor_N": 3.0}
    s, law = lumps(with_values(GROUP_A, values | {"load_hysteresis.force_N": 2.0}))
    left = sign * np.array([1.5, 6.0, -6.0])
    start = np.zeros((2, 5))
    start[1, :4] = 30.0 - np.append(0.0, np.cumsum(left))
    for boundary, element in ((LOADED_BY_SPRING, sign * 2.0), (LOADED_BY_FORCE, 0.0)):
        s[rows.LOAD_STATE] = s[rows.LOAD_STATE + 1] = 7.0
        given = Given(start[1, 3] - sign * 2.5, 0.0)
        step = Step(1e-13, NONE, given, NONE, 0.1, 0.1, F0 - given.value)
        rest_at(s, start, step, at(law, boundary))
        limits = 0.05 * (start[1, 1:4] + start[1, :3])
        bent = left / law.lump.bristle.stiffness + 0.05 * np.clip(left / limits, -1.0, 1.0)
        bent = [*bent, (sign * 2.5 - element) / law.end_bristle.stiffness]
        np.testing.assert_allclose(nodes(s, rows.DEFLECTION)[1:], bent, rtol=1e-6)
        assert s[rows.LOAD_STATE :][:2].tolist() == pytest.approx([element, 0.0])


@pytest.mark.parametrize(
    ("leans", "phase"),
    [((1, 1, 1), 1), ((-1, -1, -1), -1), ((1, 1, 0), 0), ((0, -1, -1), 0), ((1, -1, 1), 0)],
)
def test_the_phase_is_that_in_which_all_lumps_are(leans, phase):
    """A lump slips where its bristles are bent by 99 % of the most that its limit bends them."""
    s, law = lumps(with_values(GROUP_A, {"presliding.length_mm": 0.05}))
    limits = nodes(s, rows.LIMIT)[1:LAST] = 2.0, 3.0, 4.0
    longest = np.array(limits) / law.lump.bristle.stiffness + 0.05
    share = np.where(leans, 0.991, 0.989) * np.sign(np.add(leans, 0.1))
    nodes(s, rows.DEFLECTION_NEW)[1:LAST] = share * longest
    assert phase_of(s, law) == phase


REST = [[0.0], [0.0], [F0], [F0]]


def test_a_tendon_that_nothing_moves_asks_nothing_of_newtons_method():
    """Steps grow, at most to the double, from within the first sample to the last one."""
    times = np.array([0.0, 1e-3, 0.2, 0.3])
    output, progress = run(np.zeros(4), times)
    assert output.phase.tolist() == [0, 0, 0, 0]
    np.testing.assert_allclose(output[:4], np.tile(REST, 4), atol=1e-9)
    assert (progress.iterations, progress.reached_s) == (0, 0.3)
    assert progress.tries == progress.step_ends_s.size
    lengths = np.diff(progress.step_ends_s, prepend=0.0)
    assert 0.0 < lengths[0] < 1e-3
    assert np.all(lengths > 0.0)
    assert np.all(lengths[1:] < 2.0 * lengths[:-1] * (1.0 + 1e-9))
    assert progress.step_ends_s[-1] == 0.3


def test_a_run_of_two_samples_goes_on_to_the_second():
    for steps in (OWN_STEPS, np.array([0.1])):
        output, progress = run([0.0, 0.02], [3.0, 3.2], steps=steps, tolerance=1e-2)
        assert (output.phase.max() < SLACK, output.x_in[1], progress.reached_s) == (True, 0.02, 3.2)


def test_steps_that_are_given_end_there_and_at_turns():
    """Where Newton's method fails there are shorter ones between; each is tried again."""
    times = np.linspace(0.0, 0.4, 9)
    steps = np.array([0.02, 0.11, 0.29, 0.31])
    drive = np.array([0.0, 0.01, 0.02, 0.03, 0.02, 0.01, 0.0, -0.01, -0.02])
    _, progress = run(drive, times, steps=steps, tolerance=math.inf)
    ends = progress.step_ends_s
    assert np.all(np.diff(ends) > 0.0)
    for end in (*steps, 0.15, 0.4):  # the drive turns at 0.15
        assert np.abs(ends - end).min() < 1e-12
    assert progress.tries > ends.size > 6
    assert progress.iterations > ends.size


@pytest.mark.parametrize("steps", [OWN_STEPS, np.array([0.05, 0.2, 0.3])])
def test_a_run_that_cannot_be_followed_is_given_up_there(steps):
    """The curve through the samples has a slope up to two before the first that is unknown."""
    times, drive = np.linspace(0.0, 1.0, 11), np.zeros(11)
    drive[7:] = math.nan
    output, progress = run(drive, times, steps=steps)
    assert output.phase.tolist() == [0] * 5 + [UNCONVERGED] * 6
    np.testing.assert_allclose(output[:4], np.tile(REST, 11), atol=1e-9)
    assert 0.5 - 1e-9 < progress.reached_s < 0.5 + 1e-12
    assert progress.tries > progress.step_ends_s.size
    assert progress.step_ends_s[-1] == progress.reached_s


def test_an_end_without_friction_has_none_and_bends_no_bristle():
    law = cleared(GROUP_A)[1]
    assert end_friction(0.3, 2.0, STEP, 0.0, law) == (0.0, 0.0, 0.0)
    force, by_speed, deflection = end_friction(0.3, 2.0, STEP, 0.5, law)
    ahead, behind = (end_friction(0.3, 2.0 + d, STEP, 0.5, law)[0] for d in (1e-5, -1e-5))
    assert by_speed == pytest.approx((ahead - behind) / 2e-5, rel=1e-5)
    assert (force > 0.0) == (deflection > 0.0)
