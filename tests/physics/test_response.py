"""One run: which solver answers, where it starts, and what the sensors would read."""

from dataclasses import replace

import numpy as np
import pytest

from tests.physics.references import GROUP_A, branches
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.response import first_determined_sample, simulate

RIG = GROUP_A._replace(x_in_zero_mm=3.0, x_out_zero_mm=-7.0)
MOTION = np.concatenate((np.linspace(0, 20, 500), np.linspace(20, 5, 500), np.linspace(5, 9, 300)))


@pytest.fixture(scope="module")
def spring():
    return simulate(RIG, DriveInput(MOTION + 3.0))


def test_a_spring_is_solved_in_closed_form_and_read_with_the_zeros(spring):
    f_in, f_out, phase = branches(MOTION, GROUP_A)
    assert spring.solver == "closed form"
    np.testing.assert_array_equal(spring.x_in_mm, MOTION + 3.0)
    np.testing.assert_allclose(spring.f_in_N, f_in, rtol=1e-12)
    np.testing.assert_allclose(spring.x_out_mm + 7.0, (f_out - 25.0) / 1.579, atol=1e-12)
    np.testing.assert_array_equal(spring.phase, phase)


def mid_cycle(spring, load, part):
    values = {"spring": None, "force": spring.f_out_N, "displacement": spring.x_out_mm}[load]
    load_values = None if values is None else values[part]
    return DriveInput(spring.x_in_mm[part], load=load, load_values=load_values)


@pytest.mark.parametrize("cut", [250, 520, 700, 900, 1010, 1100])
@pytest.mark.parametrize("load", ["spring", "force", "displacement"])
def test_a_run_that_begins_mid_cycle_starts_from_the_measured_tension(spring, load, cut):
    drive = mid_cycle(spring, load, slice(cut, None))
    answer = simulate(RIG, replace(drive, start_f_in_N=float(spring.f_in_N[cut])))
    assert answer.f_in_N.size == MOTION.size - cut
    np.testing.assert_array_equal(answer.x_in_mm, spring.x_in_mm[cut:])
    assert answer.f_in_N[0] == pytest.approx(
        spring.f_in_N[cut], abs=1e-3 if load == "spring" else 0.3
    )
    assert answer.f_in_N[-1] == pytest.approx(spring.f_in_N[-1], rel=0.01)


@pytest.mark.parametrize("load", ["spring", "force", "displacement"])
def test_the_past_is_forgotten_once_the_whole_tendon_slips(spring, load):
    drive = mid_cycle(spring, load, slice(1000, None))  # begins with a reversal
    first = first_determined_sample(RIG, drive)
    pulled, released = (
        simulate(RIG, replace(drive, start_f_in_N=extreme)).f_in_N for extreme in (1e3, 1e-3)
    )
    assert first is not None
    assert first > 5
    np.testing.assert_allclose(pulled[first:], released[first:], rtol=1e-6)
    assert np.all(pulled[:first] > released[:first] + 1e-3)
