"""The closed forms against quadrature along the sheath, and the numbers of Yang 2025."""

import math

import pytest
from scipy.integrate import quad

from tests.physics.references import GROUP_A, wrap_of
from tsas_cli.physics.closed_form.capstan import (
    dead_band_stiffness,
    dead_band_width,
    mean_tension_ratio,
    slip_stiffness,
    speed_per_stiffness,
    tension_ratio,
)

A = wrap_of(GROUP_A)
OTHERS = [(0.3, 40.0, 310.0, 5.0e4), (1.7, 0.2, 90.0, 3.0e3), (0.01, 900.0, 2500.0, 8.0e5)]


def test_tension_falls_towards_the_load_while_the_drive_pulls():
    assert tension_ratio(A, 1.0) == pytest.approx(1.0 / 1.48096, rel=1e-5)
    assert tension_ratio(A, -1.0) == pytest.approx(1.48096, rel=1e-5)


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize("wrap", [0.0, 1e-9, 0.05, A, 3.0])
def test_mean_tension_is_that_of_the_profile(wrap, direction):
    mean, _ = quad(lambda s: math.exp(-direction * wrap * s), 0.0, 1.0)
    assert mean_tension_ratio(wrap, direction) == pytest.approx(mean, rel=1e-12)


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize(("wrap", "spring", "length", "stiffness"), OTHERS)
def test_slip_stiffness_adds_spring_and_tendon(wrap, spring, length, stiffness, direction):
    """One newton more at the drive stretches every piece of tendon and the spring by its share."""
    stretch, _ = quad(lambda s: math.exp(-direction * wrap * s / length) / stiffness, 0.0, length)
    stretch += math.exp(-direction * wrap) / spring
    assert slip_stiffness(wrap, direction, spring, length, stiffness) == pytest.approx(
        1.0 / stretch
    )


@pytest.mark.parametrize(("wrap", "spring", "length", "stiffness"), OTHERS)
def test_dead_band_turns_one_profile_into_the_other(wrap, spring, length, stiffness):
    tension = 13.0

    def difference(s):
        left = length - s
        return tension * (math.exp(wrap * left / length) - math.exp(-wrap * left / length))

    width = quad(difference, 0.0, length)[0] / stiffness
    swing = difference(0.0)
    assert dead_band_width(tension, wrap, length, stiffness) == pytest.approx(width)
    assert dead_band_stiffness(wrap, length, stiffness) == pytest.approx(swing / width)


def test_one_turn_of_the_motor_turns_the_pulley_by_its_gear_as_in_the_paper():
    per_stiffness, turn_mm = speed_per_stiffness(27.1, 120.0), 2.0 * math.pi * 27.1 / 120.0
    assert per_stiffness * 60.0 == pytest.approx(turn_mm)
    assert per_stiffness * 175.10 == pytest.approx(4.141, rel=2e-3)
