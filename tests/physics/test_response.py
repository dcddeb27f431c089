"""One run: where it starts, and from where on nothing depends on what came before it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.physics.references import GROUP_A, wrap_of
from tsas_cli.physics.ends import DriveInput, ends_of
from tsas_cli.physics.response import first_determined_sample, simulate
from tsas_cli.physics.rig import with_values

RIG = GROUP_A._replace(x_in_zero_mm=3.0, x_out_zero_mm=-7.0)
MOTION = np.concatenate((np.linspace(0, 20, 500), np.linspace(20, 5, 500), np.linspace(5, 9, 300)))


@pytest.fixture(scope="module")
def spring():
    return simulate(RIG, DriveInput(MOTION + 3.0))


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


EA, KL, L, _, F0 = GROUP_A[1:6]
WRAP = wrap_of(GROUP_A)


def dead_band(x):
    """Return the travel from contraction at x to loosening, by the formulas of Yang 2025."""
    slope = KL * math.exp(WRAP) / (1.0 + KL * (math.exp(WRAP) - 1.0) * L / (WRAP * EA))
    tension = slope * (x + F0 * (1.0 / KL + L / EA))
    return L / (WRAP * EA) * tension * (1.0 - math.exp(-WRAP)) ** 2


def test_a_release_forgets_when_the_widest_dead_band_is_crossed():
    x = 10.0 - np.arange(0.0, 1.0, 1e-3)
    first = first_determined_sample(GROUP_A, DriveInput(x))
    assert x[0] - x[first] == pytest.approx(dead_band(10.0), abs=1.5e-3)


def test_a_move_inside_the_dead_band_is_never_forgotten():
    x = 10.0 + 0.4 * dead_band(10.0) * np.sin(np.linspace(0.0, 20.0, 500))
    assert first_determined_sample(GROUP_A, DriveInput(x)) is None
    assert first_determined_sample(GROUP_A, DriveInput(np.full(100, 10.0))) is None


@pytest.mark.parametrize("wanted", [5.0, 200.0])
def test_a_tension_out_of_reach_starts_at_the_nearest_one(wanted):
    """Below that of loosening, or above that of contraction."""
    x = np.full(3, 10.0)
    reached = simulate(GROUP_A, DriveInput(x, start_f_in_N=wanted)).f_in_N[0]
    pulled = simulate(GROUP_A, DriveInput(np.array([0.0, 10.0]))).f_in_N[-1]
    released = simulate(GROUP_A, DriveInput(np.array([0.0, 20.0, 10.0]))).f_in_N[-1]
    assert reached == pytest.approx(pulled if wanted > 100.0 else released, rel=1e-6)


def test_a_tendon_that_is_tightened_anew_leaves_the_drives_ripple_where_it_is():
    """The end of the tendon is ahead by the wave of the reading, wherever the zero of x_in is."""
    reading = np.linspace(0.0, 5.0, 400)
    wave = {"drive_ripple.sine_mm": 0.1, "drive_ripple.period_mm": 1.2}
    ahead = 0.1 * np.sin(2.0 * np.pi * reading / 1.2)
    for zero in (-0.4, 0.0, 0.7):
        rig = with_values(GROUP_A, wave | {"x_in_zero_mm": zero})
        assert np.ptp(ends_of(rig, DriveInput(reading)).drive - reading - ahead) < 1e-12
