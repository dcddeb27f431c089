"""The closed form against the profile on a fine grid, which knows no fronts and no stack."""

import math

import numpy as np
import pytest

from tests.physics.references import FREE, GROUP_A, Profile, branches, pulled_through, wrap_of
from tsas_cli.effects import Effects, FreeTendon
from tsas_cli.physics.closed_form.branches import from_rest, strokes

A = wrap_of(GROUP_A)
UP, DOWN = math.exp(A), math.exp(-A)
SOFT = GROUP_A._replace(
    friction_coefficient=0.4,
    tendon_stiffness_N=2.2e3,
    load_stiffness_N_per_mm=35.0,
    sheath_length_mm=410.0,
    total_bend_rad=2.3,
    preload_N=4.0,
    effects=Effects(free_tendon=FreeTendon(900.0, 0.0)),
)
NESTED = [2.0, 0.9, 1.7, 1.1, 1.5, 1.2, 1.4, 1.15, 1.6, 0.95, 1.9, 0.5, 3.0, 0.3, 2.9, 0.31, 3.5]


def distance_to_profile(rig, tensions):
    """Pull the profile through tensions; the closed form must give them where the drive was."""
    x_in, f_out = pulled_through(rig, tensions)
    answer_in, answer_out, _ = branches(x_in, rig)
    return max(np.abs(answer_in - tensions).max(), np.abs(answer_out - f_out).max())


@pytest.mark.parametrize("rig", [GROUP_A, FREE, SOFT])
@pytest.mark.parametrize(
    "turns",
    [
        pytest.param([1.2, 3.0], id="from rest up into full slip"),
        pytest.param([0.9, 0.4, 0.1], id="from rest down into full slip"),
        pytest.param([1.3, 0.9, 1.2, 1.0, 1.25, 0.8, 1.31, 0.3], id="reversals before any slip"),
        pytest.param(NESTED, id="nested"),
        pytest.param([5.0, 1.0, 5.0, 1.0], id="cycles"),
    ],
)
def test_turning_points_are_those_of_the_profile(rig, turns):
    tensions = rig.preload_N * np.array(turns)
    assert distance_to_profile(rig, tensions) < 1e-6 * rig.preload_N
    between = np.interp(
        np.linspace(0, len(turns) - 1, 20 * len(turns)), range(len(turns)), tensions
    )
    assert distance_to_profile(rig, between) < 1e-6 * rig.preload_N


def test_random_turning_points_are_those_of_the_profile():
    rng = np.random.default_rng(3)
    for _ in range(20):
        tensions = 25.0 * np.exp(np.cumsum(rng.normal(0.0, rng.choice([0.1, 0.5]), 40)))
        assert distance_to_profile(FREE, tensions) < 1e-6 * tensions.max()


def test_the_stack_of_turning_points_has_no_depth_limit():
    spiral = 25.0 * (2.0 + 0.3 * np.linspace(1.0, 0.1, 700) * (-1.0) ** np.arange(700))
    assert distance_to_profile(GROUP_A, np.concatenate((spiral, spiral[::-1]))) < 1e-4


def test_a_slack_tendon_carries_nothing_until_it_is_taut_again():
    slack_at = Profile(FREE)
    slack_at.pull_drive_to(0.0)
    x0 = slack_at.x_in
    x = np.array([5.0, x0 + 0.1, x0 - 1.0, x0 - 30.0, x0 - 2.0, x0 - 2.0, x0 - 0.1, x0 + 0.1])
    f_in, f_out, phase = branches(x, FREE)
    assert phase.tolist() == [1, -1, 2, 2, 2, 2, 2, 1]
    assert not f_in[2:7].any()
    assert not f_out[2:7].any()
    assert f_in[7] > 0.0
    assert f_in[7] / f_out[7] == pytest.approx(UP)
    assert f_in[1] / f_out[1] == pytest.approx(DOWN)


@pytest.mark.parametrize("bend", [0.0, 1e-12, 1e-6])
def test_a_straight_sheath_is_three_springs_in_series(bend):
    rig = FREE._replace(total_bend_rad=bend)
    length = rig.sheath_length_mm + 152.0 + 61.0
    stiffness = 1.0 / (1.0 / rig.load_stiffness_N_per_mm + length / rig.tendon_stiffness_N)
    x = np.array([0.0, 3.0, 1.0, 2.0, -4.0, 0.0])
    f_in, f_out, _ = branches(x, rig)
    np.testing.assert_allclose(f_in, 25.0 + stiffness * x, rtol=1e-4)
    np.testing.assert_allclose(f_out, f_in, rtol=1e-4)


@pytest.mark.parametrize(
    ("motion", "count"),
    [
        ([], 2),
        ([1.0, 2.0], 2),
        ([1.0, 2.0, 3.0], 2),
        ([1.0, 0.0, 1.0], 3),
        ([1.0, 0.0, 1.0, 0.5, 0.2], 4),
        ([1.0, 2.0, 2.0, 3.0], 4),
        ([0.0, -1.0, -1.0, -1.0], 3),
    ],
)
def test_room_for_strokes_is_that_of_turns_and_rests(motion, count):
    """The way to the first sample, the first stroke, and one for each change after it."""
    x = np.array(motion)
    assert strokes(x) == count


F0 = GROUP_A.preload_N


@pytest.mark.parametrize("tension", [0.3, 0.8, 1.0, 1.1, 1.4])
@pytest.mark.parametrize("c", [0.0, 0.02])
def test_from_rest_a_pull_gives_back_the_travel_that_it_takes(tension, c):
    """Travel/F0 = c (e^y − 1) ± C (e^y − 1 − y) of y = ln(T0/F0)."""
    C, y = 0.05, math.log(tension)
    bent = math.copysign(C * (tension - 1.0 - y), y) if y else 0.0
    travel = F0 * (c * (tension - 1.0) + bent)
    assert from_rest(travel, F0, C, c, 1.5) == pytest.approx(F0 * tension, rel=1e-7)
