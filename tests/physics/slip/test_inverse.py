"""The inverse model against the closed form of Eq. (22), and against the model that it inverts."""

import numpy as np
import pytest

from tests.physics.references import GROUP_A, wrap_of
from tsas_cli.physics.ends import losses_over
from tsas_cli.physics.rig import with_values
from tsas_cli.physics.slip.inverse import inverse_chain

STEP_S = 0.005
T = np.arange(0.0, 4.0 * np.pi, STEP_S)
SINE = 43.0 - 18.0 * np.cos(T)
OTHER = GROUP_A._replace(
    friction_coefficient=0.3,
    tendon_stiffness_N=3.1e4,
    load_stiffness_N_per_mm=4.7,
    sheath_length_mm=411.0,
    total_bend_rad=1.9,
    preload_N=17.0,
)


def path_to(wanted_N, rig=GROUP_A, *, n=50, speed=0.0):
    """Return the inverse model's path; none of its samples may be missed."""
    time_s = STEP_S * np.arange(wanted_N.size)
    at_rest = np.zeros(time_s.size)
    friction = losses_over(time_s, at_rest, speed + at_rest, 0.0, rig)
    path, tension, missed = inverse_chain(wanted_N, friction, STEP_S, rig, n)
    assert missed == 0
    return path, tension


def closed_form(wanted_N, rig, direction):
    """Return Eq. (22) with Δs of full slip in contraction (+1) or loosening (−1)."""
    a, L, EA = direction * wrap_of(rig), rig.sheath_length_mm, rig.tendon_stiffness_N
    load = (wanted_N - rig.preload_N) / rig.load_stiffness_N_per_mm
    return load + wanted_N * L * np.expm1(a) / (a * EA) - rig.preload_N * L / EA


@pytest.mark.parametrize("rig", [GROUP_A, OTHER], ids=["group a", "other"])
def test_both_phases_are_equation_22(rig):
    path, tension = path_to(SINE, rig, n=100)
    rise = np.diff(SINE, prepend=SINE[0])
    for direction in (1.0, -1.0):
        slips = rise * direction > 1e-4
        assert slips.sum() > 1000
        expected = closed_form(SINE[slips], rig, direction)
        np.testing.assert_allclose(path[slips], expected, atol=2e-5)
        capstan = SINE[slips] * np.exp(direction * wrap_of(rig))
        np.testing.assert_allclose(tension[slips], capstan, rtol=1e-7)


@pytest.mark.parametrize("n", [5, 10, 20, 30, 50])
@pytest.mark.parametrize("speed", [1.0, 2.0])
def test_a_dead_band_in_which_the_answer_trembles_is_crossed(n, speed):
    """A curved spring's answer is right to rounding only; the path stays on its rising branch."""
    rig = with_values(GROUP_A, {"load_spring_nonlinearity.quadratic_per_mm": 0.03})
    path, _ = path_to(43.0 - 18.0 * np.cos(speed * T), rig, n=n)
    assert path.min() > -0.2


def test_friction_over_speed_is_that_of_the_given_speed():
    """A loss of viscosity·v over the sheath is made up for by more tension at the drive."""
    rig = with_values(GROUP_A, {"viscous_friction.coefficient_N_s_per_mm": 0.3})
    wanted = np.linspace(25.0, 61.0, 200)
    tension = {v: path_to(wanted, rig, speed=v)[1][-1] for v in (0.0, 5.0, 10.0)}
    assert tension[0.0] == pytest.approx(61.0 * np.exp(wrap_of(rig)))
    more = np.diff(list(tension.values()))
    assert more[0] == pytest.approx(more[1])
    assert 0.3 * 5.0 < more[0] < 0.3 * 5.0 * np.exp(wrap_of(rig))


def test_a_force_that_no_place_gives_is_told_as_missed():
    """A spring that softens gives no more than its peak; the drive stays where it was."""
    rig = with_values(GROUP_A, {"load_spring_nonlinearity.quadratic_per_mm": -0.05})
    most = 25.0 + 1.579 / (4.0 * 0.05)
    wanted = np.concatenate((np.linspace(25.0, most - 0.1, 50), np.full(3, most + 5.0)))
    friction = losses_over(*np.zeros((3, wanted.size)), 0.0, rig)
    path, _, missed = inverse_chain(wanted, friction, STEP_S, rig, 10)
    assert missed == 3
    assert (path[-3:] == path[-4]).all()


@pytest.mark.parametrize("less_N", [1e-4, 1e-2, 1.0])
def test_a_dead_band_is_crossed_from_a_step_however_small(less_N):
    """Full slip turns round: from 60 N pulled to less let go of, both of the closed form."""
    rig, wanted = OTHER, np.array([17.0, 30.0, 60.0, 60.0 - less_N, 20.0, 20.0 + less_N])
    path, tension = path_to(wanted, rig, n=3)
    assert path[2] > path[3] > path[4] < path[5]
    factors = np.exp(wrap_of(rig) * np.array([1.0, 1.0, -1.0]))
    np.testing.assert_allclose(tension[[1, 2, 4]], wanted[[1, 2, 4]] * factors)
