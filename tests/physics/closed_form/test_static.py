"""The lumped model: straight lines between the four corners of a cycle."""

import math

import numpy as np
import pytest

from tests.physics.references import FREE, GROUP_A, branches, pulled_through, static_model, wrap_of

UP = math.exp(wrap_of(GROUP_A))


@pytest.fixture(scope="module")
def corners():
    """Where contraction and loosening end and begin: points c, e, f, b of Fig. 6."""
    tensions = np.array([90.0, 90.0 / UP**2, 20.0, 20.0 * UP**2])
    return pulled_through(GROUP_A, tensions)[0], tensions


def test_the_corners_are_those_of_the_distributed_model(corners):
    x_in, tensions = corners
    f_in, f_out, _ = static_model(x_in, GROUP_A)
    np.testing.assert_allclose(f_in, tensions, rtol=1e-9)
    np.testing.assert_allclose(f_out, tensions * [1 / UP, UP, UP, 1 / UP], rtol=1e-9)


def test_between_the_corners_are_straight_lines(corners):
    x_in, tensions = corners
    for i in range(3):
        x = np.linspace(x_in[i], x_in[i + 1], 11)
        f_in, f_out, phase = static_model(np.concatenate((x_in[:i], x)), GROUP_A)
        np.testing.assert_allclose(f_in[i:], np.linspace(*tensions[i : i + 2], 11), rtol=1e-9)
        assert set(phase[i + 1 : -1]) == {(0, -1, 0)[i]}
        if i != 1:
            assert np.ptp(f_out[i:]) < 1e-9


def test_the_first_pull_from_rest_has_the_secant_stiffness_too():
    f_in, f_out, phase = static_model(np.array([0.0, 0.01, -0.01]), GROUP_A)
    np.testing.assert_allclose(f_in, [25.0, 26.751, 23.249], atol=1e-2)
    assert f_out.tolist() == [25.0, 25.0, 25.0]
    assert not phase.any()


@pytest.mark.parametrize("rig", [GROUP_A, FREE])
def test_while_the_whole_tendon_slips_it_is_the_distributed_model(rig):
    x = np.concatenate((np.linspace(0.0, 20.0, 500), np.linspace(20.0, -20.0, 1000)))
    lumped, distributed = static_model(x, rig), branches(x, rig)
    both = (lumped[2] == distributed[2]) & (lumped[2] != 0)
    assert both.sum() > 1400
    for ours, exact in zip(lumped, distributed, strict=True):
        np.testing.assert_allclose(ours[both], exact[both], rtol=1e-9)
    assert {1, -1, 2} <= set(lumped[2])
    assert lumped[0].min() == 0.0
