"""Friction by place: each law against its closed form in full slip at a constant speed."""

import math

import numpy as np
import pytest

from tsas_studies.challenge.rig.friction import Friction
from tsas_studies.challenge.rig.motions import Motion, clock, through
from tsas_studies.challenge.rig.surface import Surface
from tsas_studies.challenge.rig.tendon import Rig, simulate

A = 0.125 * math.pi
STIFF_GPA = 6e4  # a tendon that hardly stretches: all places go as the drive does
UP, SPEED = 10.0, 4.0


def ratios(motion, friction=None, **options):
    """Return x_in and ln(f_in/f_out)/(μθ): 1 is Coulomb friction while pulling."""
    rig = Rig(
        cells=40,
        tendon_modulus_GPa=STIFF_GPA,
        friction=friction or Friction(),
        surface=Surface(**options),
    )
    columns = simulate(rig, motion).columns
    return columns["x_in_mm"], np.log(columns["f_in_N"] / columns["f_out_N"]) / A


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (
            {"rational_excess": 0.3, "rational_velocity_mm_per_s": 2.0, "rational_power": 1.5},
            1.0 + 0.3 / (1.0 + 2.0**1.5),
        ),
        (
            {"root_excess": 0.3, "root_velocity_mm_per_s": 1.0},
            1.0 + 0.3 * math.exp(-2.0),
        ),
        ({"log_share": 0.1, "log_velocity_mm_per_s": 0.5}, 1.0 + 0.1 * math.log(9.0)),
        (
            # dθ/dt = 1 − vθ/length settles at θ = length/v
            {"ageing_share": 0.2, "ageing_s": 0.05, "ageing_mm": 0.4},
            1.0 + 0.2 * math.log(1.0 + 0.1 / 0.05),
        ),
    ],
)
def test_friction_by_speed_and_age_in_full_slip(options, expected):
    motion = through([UP, 5.0], speed_mm_s=SPEED, rate_Hz=400.0)
    _, pulled = ratios(motion, **options)
    top = int(np.argmax(motion.x_in_mm))
    assert pulled[top] == pytest.approx(expected, rel=5e-3)
    assert pulled[-1] == pytest.approx(-expected, rel=5e-3)


def after_a_rest(rest_s, **options):
    """Pull by 5 mm, rest, pull on; return displacement and ratio from the end of the rest on."""
    t = clock(3.0 + rest_s, 400.0)
    x = np.interp(t, [0.0, 1.25, 1.25 + rest_s, 3.0 + rest_s], [0.0, 5.0, 5.0, 12.0])
    x_in, ratio = ratios(Motion(t, x), **options)
    on = x_in > 5.0 + 1e-9
    return x_in[on] - 5.0, ratio[on]


def test_the_longer_a_contact_rests_the_higher_its_friction():
    options = {"ageing_share": 0.1, "ageing_s": 0.1, "ageing_mm": 0.5}
    peaks = [after_a_rest(rest_s, **options)[1].max() for rest_s in (0.5, 1.0, 2.0)]
    ages = [rest_s + 0.5 / SPEED for rest_s in (0.5, 1.0, 2.0)]
    expected = [1.0 + 0.1 * math.log(1.0 + age / 0.1) for age in ages]
    assert peaks == pytest.approx(expected, rel=0.02)


def test_a_place_that_has_rested_sticks_and_lets_go_over_its_length():
    gone, ratio = after_a_rest(0.5, breakaway_excess=0.4, breakaway_mm=0.8)
    expected = 1.0 + 0.4 * np.exp(-gone / 0.8)
    later = gone > 0.3  # a few samples after the start the speed is that of the drive
    np.testing.assert_allclose(ratio[later], expected[later], atol=0.02)
    assert after_a_rest(0.5)[1].max() == pytest.approx(1.0, rel=1e-3)


def test_strands_roll_with_the_displacement():
    motion = through([UP], speed_mm_s=SPEED, rate_Hz=400.0)
    x, ratio = ratios(motion, roll_share=0.1, roll_mm=4.0, roll_phase_rad=0.5)
    moving = x > 0.5
    expected = 1.0 + 0.1 * np.sin(2.0 * np.pi * x / 4.0 + 0.5)
    np.testing.assert_allclose(ratio[moving], expected[moving], atol=3e-3)


def test_presliding_of_bouc_and_wen_goes_straight_back_and_then_like_tanh():
    motion = through([5.0, 4.7], speed_mm_s=0.5, rate_Hz=200.0)
    x, ratio = ratios(motion, Friction(round_mm=0.05))
    turn = int(np.argmax(x))
    back = (x[turn] - x[turn:]) / 0.05
    expected = np.where(back < 1.0, 1.0 - back, -np.tanh(np.maximum(back - 1.0, 0.0)))
    np.testing.assert_allclose(ratio[turn:], expected, atol=2e-3)


def test_friction_over_the_stroke_the_travel_and_a_temperature():
    motion = through([UP, 4.0], speed_mm_s=SPEED, rate_Hz=200.0)
    pulling, releasing = int(np.argmax(motion.x_in_mm)), -1
    t, sign = motion.time_s, np.array([1.0, -1.0])
    for friction, factors in (
        (Friction(slope_per_mm=0.01), [1.1, 1.04]),
        (Friction(wear_per_mm=0.01), [1.1, 1.16]),
        (
            Friction(cycle_share=0.2, cycle_s=7.0, cycle_phase_rad=1.0),
            1.0 + 0.2 * np.sin(2.0 * np.pi * t[[pulling, releasing]] / 7.0 + 1.0),
        ),
    ):
        _, ratio = ratios(motion, friction)
        assert ratio[[pulling, releasing]] == pytest.approx(sign * factors, rel=1e-3)


def test_a_sheath_that_shifts_bends_by_the_tension_at_the_drive():
    motion = through([UP], speed_mm_s=SPEED, rate_Hz=400.0)
    rig = Rig(cells=40, friction=Friction(shift_per_N=0.004))
    last = {name: v[-1] for name, v in simulate(rig, motion).columns.items()}
    bent = 1.0 + 0.004 * (last["f_in_N"] - rig.preload_N)
    assert math.log(last["f_in_N"] / last["f_out_N"]) == pytest.approx(A * bent, rel=1e-3)


def test_a_tendon_that_stiffens_stretches_by_the_logarithm_of_its_force():
    """Without friction F − F0 = (exp(q k s) − 1) / q with k s = EA ε."""
    rig = Rig(cells=20, friction_coefficient=1e-9, stiffening_per_N=0.02)
    columns = simulate(rig, through([UP, 0.0, UP], speed_mm_s=SPEED, rate_Hz=200.0)).columns
    stretch = columns["x_in_mm"] - columns["x_out_mm"]
    ks = np.log1p(0.02 * (columns["f_in_N"] - rig.preload_N)) / 0.02
    expected = ks * rig.sheath_length_mm / rig.axial_stiffness
    np.testing.assert_allclose(stretch, expected, atol=2e-5)
