"""Tendon outside the sheath, held against two ways of taking it out again."""

import numpy as np
import pytest

from tests.physics.references import GROUP_A, branches
from tsas_cli.effects import Effects, FreeTendon
from tsas_cli.effects.free_tendon import free_compliance
from tsas_cli.physics.response import DriveInput, simulate

EA = GROUP_A.tendon_stiffness_N
MOTION = np.interp(np.linspace(0, 6, 3000), np.arange(7), [0, 14, 13.9, 13.95, 3, 9, -4])


def with_free(proximal, distal):
    return GROUP_A._replace(effects=Effects(free_tendon=FreeTendon(proximal, distal)))


def test_a_free_length_is_a_rod():
    assert free_compliance(150.0, 6e4) == pytest.approx(0.0025)


def test_at_the_drive_it_takes_up_travel_by_its_tension():
    f_in, f_out, phase = branches(MOTION, with_free(152.0, 0.0))
    inside = MOTION - (f_in - 25.0) * 152.0 / EA
    nominal = branches(inside, GROUP_A)
    np.testing.assert_allclose(f_in, nominal[0], rtol=1e-9)
    np.testing.assert_allclose(f_out, nominal[1], rtol=1e-9)
    np.testing.assert_array_equal(phase, nominal[2])


def test_at_the_load_it_softens_the_spring_and_moves_the_output_less():
    spring = GROUP_A.load_stiffness_N_per_mm
    softer = GROUP_A._replace(load_stiffness_N_per_mm=1.0 / (1.0 / spring + 61.0 / EA))
    f_in, f_out, _ = branches(MOTION, with_free(0.0, 61.0))
    np.testing.assert_allclose(f_in, branches(MOTION, softer)[0], rtol=1e-9)
    response = simulate(with_free(0.0, 61.0), DriveInput(MOTION))
    np.testing.assert_allclose(response.x_out_mm, (f_out - 25.0) / spring, atol=1e-9)
