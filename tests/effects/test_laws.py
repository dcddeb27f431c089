"""The law of every effect at one point, against its formula worked out by hand."""

import math

import numpy as np
import pytest

from tsas_cli.effects import (
    BendDrift,
    DriveRipple,
    FrictionDrift,
    LoadFriction,
    LoadHysteresis,
    LoadRipple,
    LoadSpringNonlinearity,
    PreloadLoss,
    StribeckFriction,
)
from tsas_cli.effects.backlash import follow_play
from tsas_cli.effects.bend_drift import drifted_bend
from tsas_cli.effects.direction_dependent_friction import direction_factor
from tsas_cli.effects.drive_compliance import drive_deflection
from tsas_cli.effects.drive_damping import drive_damper_force
from tsas_cli.effects.drive_friction import drive_friction_force
from tsas_cli.effects.drive_inertia import drive_inertia_force
from tsas_cli.effects.drive_ripple import rippled
from tsas_cli.effects.force_crosstalk import with_crosstalk
from tsas_cli.effects.force_sensor_curvature import read_curved, straightened
from tsas_cli.effects.force_sensor_drift import drift_reading
from tsas_cli.effects.force_sensor_gain import read_gain
from tsas_cli.effects.force_sensor_hysteresis import read_hysteresis
from tsas_cli.effects.force_sensor_offset import offset_reading
from tsas_cli.effects.friction_drift import friction_factor
from tsas_cli.effects.load_damping import load_damper_force
from tsas_cli.effects.load_dependent_friction import load_factor
from tsas_cli.effects.load_friction import guide_friction
from tsas_cli.effects.load_hysteresis import element_force
from tsas_cli.effects.load_inertia import inertia_force
from tsas_cli.effects.load_relaxation import relaxing_force
from tsas_cli.effects.load_ripple import spring_wave
from tsas_cli.effects.load_spring_nonlinearity import spring_force, spring_tangent
from tsas_cli.effects.position_dependent_friction import position_factor
from tsas_cli.effects.position_sensor_gain import read_position
from tsas_cli.effects.preload_loss import lost_preload
from tsas_cli.effects.presliding import friction_share, friction_share_rate
from tsas_cli.effects.proximal_spring import proximal_spring_force
from tsas_cli.effects.sheath_compression import softened
from tsas_cli.effects.stribeck_friction import stribeck_factor
from tsas_cli.effects.uneven_friction import place_factor
from tsas_cli.effects.viscous_friction import viscous_loss

ODD = 12.345678901234567  # a value whose last bit shows any arithmetic that is done with it


@pytest.mark.parametrize(
    ("left", "expected"),
    [
        (follow_play(-3.0, ODD, 0.0), ODD),
        (rippled(ODD, DriveRipple()), ODD),
        (softened(ODD, 0.0), ODD),
        (drifted_bend(ODD, BendDrift(), 7.0), ODD),
        (drifted_bend(ODD, BendDrift(0.0, 0.05), 7.0), ODD),
        (drift_reading(ODD, 0.0, 0.05, 7.0), ODD),
        (read_gain(ODD, 1.0), ODD),
        (read_position(ODD, 1.0), ODD),
        (offset_reading(ODD, 0.0), ODD),
        (ODD * direction_factor(0.0, -1.0), ODD),
        (ODD * stribeck_factor(0.1, StribeckFriction()), ODD),
        (ODD * load_factor(1.7, 0.0), ODD),
        (ODD * load_factor(0.0, 0.0), ODD),
        (ODD * friction_factor(FrictionDrift(), 7.0, 900.0), ODD),
        (ODD + drive_friction_force(0.0, -1.0), ODD),
        (ODD + proximal_spring_force(3.0, 0.0), ODD),
        (ODD - drive_deflection(3.0, 0.0), ODD),
        (ODD + viscous_loss(3.0, 0.0), ODD),
        (ODD + inertia_force(3.0, 0.0), ODD),
        (ODD + guide_friction(LoadFriction()), ODD),
        (ODD - lost_preload(PreloadLoss(), 7.0), ODD),
        (spring_force(ODD, 1.579, LoadSpringNonlinearity()), 1.579 * ODD),
        (spring_tangent(ODD, 1.579, LoadSpringNonlinearity()), 1.579),
        (ODD * friction_share(0.3, 1e-9, 0.0), ODD),
        (ODD + drive_damper_force(3.0, 0.0), ODD),
        (ODD + drive_inertia_force(3.0, 0.0), ODD),
        (ODD + load_damper_force(3.0, 0.0), ODD),
        (ODD + element_force(0.0, 3.0, LoadHysteresis())[0], ODD),
        (ODD + relaxing_force(3.0, 2.0, 0.0), ODD),
        (ODD + spring_wave(3.0, LoadRipple())[0], ODD),
        (ODD * position_factor(3.0, 0.0), ODD),
        (ODD * place_factor(0.3, 0.0), ODD),
        (read_curved(ODD, 0.0), ODD),
        (straightened(ODD, 0.0), ODD),
        (with_crosstalk(ODD, 3.0, 0.0), ODD),
        (read_hysteresis(ODD, 3.0, 0.0), ODD),
    ],
)
def test_neutral_gives_back_what_went_in_to_the_last_bit(left, expected):
    assert left == expected


def test_the_tendon_stands_still_until_the_play_is_crossed():
    ends = [0.0]
    for drive in (0.05, 0.3, 0.25, 0.11, 0.05, 0.2, 0.3):
        ends.append(follow_play(ends[-1], drive, 0.2))
    assert ends[1:] == pytest.approx([0.0, 0.2, 0.2, 0.2, 0.15, 0.15, 0.2])


def test_drive_friction_resists_the_motion():
    assert drive_friction_force(1.5, 1.0) == 1.5
    assert drive_friction_force(1.5, -1.0) == -1.5
    assert drive_friction_force(1.5, 0.0) == 0.0


@pytest.mark.parametrize(
    ("turns", "expected"), [(0.0, 0.0), (0.25, 0.03 - 0.02), (0.5, -0.04), (0.75, -0.05), (1, 0)]
)
def test_a_ripple_is_a_wave_over_its_period_that_is_nothing_at_rest(turns, expected):
    ripple = DriveRipple(sine_mm=0.03, cosine_mm=0.02, period_mm=0.5)
    for drive in (0.5 * turns, 0.5 * (turns + 3)):
        assert rippled(drive, ripple) - drive == pytest.approx(expected, abs=1e-12)


def test_a_drive_gives_way_in_the_direction_of_the_pull():
    assert drive_deflection(40.0, 0.002) == pytest.approx(0.08)
    assert drive_deflection(-40.0, 0.002) == pytest.approx(-0.08)


def test_the_spring_of_the_paper_pulls_back():
    """Fig. 11: 12.5 N/mm."""
    assert proximal_spring_force(2.0, 12.5) == 25.0
    assert proximal_spring_force(-2.0, 12.5) == -25.0


def test_a_sheath_as_stiff_as_its_tendon_doubles_the_compliance():
    assert softened(0.0116, 1.0) == 2 * 0.0116
    assert softened(0.0116, 0.3) == pytest.approx(0.01508)


def test_friction_is_larger_in_one_direction_and_smaller_in_the_other():
    assert direction_factor(0.1, 1.0) == 1.1
    assert direction_factor(0.1, -1.0) == 0.9
    assert direction_factor(-0.1, 1.0) == 0.9


def test_the_excess_falls_to_its_eth_part_at_the_stribeck_velocity():
    stribeck = StribeckFriction(excess=0.2, velocity_mm_per_s=4.0)
    assert stribeck_factor(0.0, stribeck) == 1.2
    assert stribeck_factor(4.0, stribeck) == pytest.approx(1.0 + 0.2 * math.exp(-1.0))
    assert stribeck_factor(-8.0, stribeck) == pytest.approx(1.0 + 0.2 * math.exp(-4.0))


def test_the_lumps_of_the_paper_lose_together_what_its_coefficient_says():
    """Table 1: σ2 = 4e-4 N s/mm for each of 50 lumps, at the 10 mm/s of its group a."""
    assert viscous_loss(10.0, 50 * 4e-4) == pytest.approx(0.2)
    assert viscous_loss(-10.0, 50 * 4e-4) == pytest.approx(0.2)


def test_an_elastic_contact_has_less_friction_at_more_tension():
    assert load_factor(8.0, -1 / 3) == pytest.approx(0.5)
    assert load_factor(2.0, 1.5) == pytest.approx(2.0 * math.sqrt(2.0))
    assert load_factor(-2.0, 1.5) == load_factor(2.0, 1.5)
    assert load_factor(1e-9, -1.0) == load_factor(0.01, -1.0) == pytest.approx(100.0)


@pytest.mark.parametrize("way", [0.003, 0.02, 0.1, -0.003, -0.02, -0.1])
@pytest.mark.parametrize("before", [-1.0, -0.2, 0.0, 0.7, 1.0])
def test_friction_turns_round_by_dahls_law(before, way):
    """dz/dx = (1 − z sgn(dx))/length, integrated in small steps."""
    length, z = 0.02, before
    for step in np.full(20_000, way / 20_000):
        z += step * (1.0 - z * np.sign(step)) / length
    assert friction_share(before, way, length) == pytest.approx(z, abs=1e-3)
    slope = (
        friction_share(before, way + 1e-7, length) - friction_share(before, way, length)
    ) / 1e-7
    share = friction_share(before, way, length)
    assert friction_share_rate(share, way, length) == pytest.approx(slope, rel=1e-4, abs=1e-6)


@pytest.mark.parametrize("before", [-1.0, -0.2, 0.7])
def test_before_any_way_the_steeper_side_counts(before):
    sides = [friction_share_rate(before, way, 0.02) for way in (1e-12, -1e-12)]
    assert friction_share_rate(before, 0.0, 0.02) == pytest.approx(max(sides))


def test_a_bend_drifts_at_its_rate_settles_and_never_turns_the_other_way():
    assert drifted_bend(3.0, BendDrift(0.005, 0.0), 20.0) == pytest.approx(3.1)
    assert drifted_bend(3.0, BendDrift(0.005, 0.05), 1e6) == pytest.approx(3.1)
    assert drifted_bend(3.0, BendDrift(-0.005, 0.0), 20.0) == pytest.approx(2.9)
    assert drifted_bend(3.0, BendDrift(-1.0, 0.0), 20.0) == 0.0


def test_friction_drifts_within_the_run_and_over_the_session():
    drift = FrictionDrift(rate_per_s=0.002, settling_per_s=0.0, session_rate_per_s=0.0005)
    assert friction_factor(drift, 20.0, 0.0) == pytest.approx(1.04)
    assert friction_factor(drift, 0.0, 100.0) == pytest.approx(1.05)
    assert friction_factor(drift, 20.0, 100.0) == pytest.approx(1.09)
    settles = drift._replace(settling_per_s=0.05)
    assert friction_factor(settles, 1e6, 100.0) == pytest.approx(1.04 + 0.05)
    assert friction_factor(drift._replace(rate_per_s=-1.0), 20.0, 0.0) == 0.0


def test_preload_is_lost_at_its_rate_and_settles():
    assert lost_preload(PreloadLoss(0.02, 0.0), 20.0) == pytest.approx(0.4)
    assert lost_preload(PreloadLoss(0.02, 0.05), 1e6) == pytest.approx(0.4)
    assert lost_preload(PreloadLoss(0.02, 0.05), 20.0) == pytest.approx(0.4 * (1 - math.exp(-1)))


def test_a_hardening_spring():
    shape = LoadSpringNonlinearity(quadratic_per_mm=0.01, cubic_per_mm2=0.0005)
    assert spring_force(10.0, 2.0, shape) == pytest.approx(20.0 * (1 + 0.1 + 0.05))
    assert spring_force(-10.0, 2.0, shape) == pytest.approx(-20.0 * (1 - 0.1 + 0.05))
    assert spring_tangent(10.0, 2.0, shape) == pytest.approx(2.0 * (1 + 0.2 + 0.15))


@pytest.mark.parametrize("position", [-7.0, 0.0, 7.0])
def test_the_tangent_is_the_slope_of_the_force(position):
    shape = LoadSpringNonlinearity(quadratic_per_mm=0.01, cubic_per_mm2=0.0005)
    ahead, behind = (spring_force(position + step, 2.0, shape) for step in (1e-4, -1e-4))
    slope = (ahead - behind) / 2e-4
    assert spring_tangent(position, 2.0, shape) == pytest.approx(slope, rel=1e-7)


@pytest.mark.parametrize("position", [-3.0, 0.0, 0.4])
def test_a_wave_has_its_period_its_slope_and_is_nothing_at_rest(position):
    ripple = LoadRipple(sine_mm=0.3, cosine_mm=-0.2, period_mm=7.0)
    ahead, behind = (spring_wave(position + step, ripple)[0] for step in (1e-4, -1e-4))
    wave, slope = spring_wave(position, ripple)
    assert slope == pytest.approx((ahead - behind) / 2e-4, rel=1e-6)
    assert spring_wave(position + 7.0, ripple)[0] == pytest.approx(wave)
    assert spring_wave(0.0, ripple)[0] == 0.0
    assert spring_wave(1.75, ripple)[0] == pytest.approx(0.3 + 0.2)


def test_an_element_follows_by_its_stiffness_and_yields():
    law = LoadHysteresis(force_N=2.0, travel_mm=0.5)
    assert element_force(0.0, 0.25, law) == (1.0, 4.0)
    assert element_force(1.5, 0.25, law) == (2.0, 0.0)
    assert element_force(2.0, -0.75, law) == (-1.0, 4.0)
    assert element_force(2.0, -9.0, law) == (-2.0, 0.0)


def test_friction_by_place_and_along_the_sheath():
    assert position_factor(10.0, 0.01) == pytest.approx(1.1)
    assert position_factor(-10.0, 0.2) == 0.0
    assert place_factor(0.0, 0.4) == pytest.approx(0.8)
    assert place_factor(1.0, 0.4) == pytest.approx(1.2)


def test_a_damper_and_a_mass_in_their_units():
    assert drive_damper_force(-8.0, 0.25) == load_damper_force(-8.0, 0.25) == -2.0
    assert drive_inertia_force(-500.0, 4.0) == pytest.approx(-2.0)
    assert relaxing_force(0.5, 3.0, 0.2) == pytest.approx(0.3)


def test_both_sides_of_the_sensor_rub():
    assert guide_friction(LoadFriction(after_sensor_N=0.5, before_sensor_N=0.25)) == 0.75


def test_a_kilogram_at_a_metre_per_second_squared_needs_a_newton():
    assert inertia_force(1000.0, 1.0) == pytest.approx(1.0)
    assert inertia_force(-1000.0, 3.0) == pytest.approx(-3.0)


def test_sensors_read_by_gain_offset_and_drift():
    assert read_gain(40.0, 1.05) == pytest.approx(42.0)
    assert read_position(-20.0, 1.02) == pytest.approx(-20.4)
    assert offset_reading(40.0, -0.5) == 39.5
    assert drift_reading(40.0, 0.02, 0.0, 20.0) == pytest.approx(40.4)
    assert drift_reading(40.0, -0.02, 0.05, 1e6) == pytest.approx(39.6)


TIMES = np.array([0.0, 3.0, 20.0])


@pytest.mark.parametrize(
    "law",
    [
        lambda t: rippled(t, DriveRipple(0.03, 0.02, 0.5)),
        lambda t: stribeck_factor(t, StribeckFriction(0.2, 4.0)),
        lambda t: viscous_loss(t, 0.02),
        lambda t: drifted_bend(1.0, BendDrift(-0.1, 0.05), t),
        lambda t: friction_factor(FrictionDrift(-0.1, 0.05, 0.0005), t, 100.0),
        lambda t: lost_preload(PreloadLoss(0.02, 0.05), t),
        lambda t: spring_force(t, 2.0, LoadSpringNonlinearity(0.01, 0.0005)),
        lambda t: drift_reading(40.0, 0.02, 0.05, t),
    ],
)
def test_a_law_of_many_points_is_the_law_of_each(law):
    np.testing.assert_allclose(law(TIMES), [law(time) for time in TIMES.tolist()], rtol=1e-14)
