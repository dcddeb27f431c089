"""Laws at one point, and those of unnamed origin in a run, against what their equations say."""

import numpy as np
import pytest

from tests.physics.references import GROUP_A
from tsas_cli.effects import LAWS, Effects
from tsas_cli.effects.bend_drift import BendDrift, drifted_bend
from tsas_cli.effects.friction_drift import FrictionDrift, friction_factor
from tsas_cli.effects.laws.tendon_law import TendonLaw, tendon_law_factor
from tsas_cli.effects.load_dependent_friction import LOAD_DEPENDENT_FRICTION, load_factor
from tsas_cli.effects.load_hysteresis import LoadHysteresis, element_force
from tsas_cli.effects.presliding import friction_share, friction_share_rate
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.response import NODES, simulate
from tsas_cli.physics.rig import with_values


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


def test_an_element_follows_by_its_stiffness_and_yields():
    law = LoadHysteresis(force_N=2.0, travel_mm=0.5)
    assert element_force(0.0, 0.25, law) == (1.0, 4.0)
    assert element_force(1.5, 0.25, law) == (2.0, 0.0)
    assert element_force(2.0, -0.75, law) == (-1.0, 4.0)
    assert element_force(2.0, -9.0, law) == (-2.0, 0.0)


def test_a_drift_never_turns_bend_or_friction_the_other_way():
    assert drifted_bend(3.0, BendDrift(-1.0, 0.0), 20.0) == 0.0
    drift = FrictionDrift(rate_per_s=-1.0, settling_per_s=0.0, session_rate_per_s=0.0005)
    assert friction_factor(drift, 20.0, 0.0) == 0.0
    both = drift._replace(rate_per_s=0.002)
    assert friction_factor(both, 20.0, 100.0) == pytest.approx(1.04 + 0.05)


@pytest.mark.parametrize("preload_N", [8.0, 40.0])
@pytest.mark.parametrize("exponent", [-0.36, 0.2])
def test_friction_follows_the_tension_and_not_the_preload(preload_N, exponent):
    """Along the sheath dT = μ (T/10 N)^n T dθ, so that T^−n falls by n μθ (10 N)^−n."""
    rig = with_values(
        GROUP_A, {"preload_N": preload_N, "load_dependent_friction.exponent": exponent}
    )
    found = simulate(rig, DriveInput(np.linspace(0.0, 12.0, 400)), nodes=200)
    wrap = rig.friction_coefficient * rig.total_bend_rad
    f_in = (found.f_out_N[-1] ** -exponent - exponent * wrap * 10.0**-exponent) ** (-1.0 / exponent)
    assert found.f_in_N[-1] == pytest.approx(f_in, rel=1e-4)


@pytest.mark.parametrize("tension_N", [0.2, 2.0, 600.0])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_exponent_of_the_tension_is_screened_where_friction_is_linear_in_it(tension_N, sign):
    """At −0.2 and 600 N it is not, and a true exponent looked as if it explained nothing."""
    exponent = sign * LOAD_DEPENDENT_FRICTION.parameters[0].start
    linear = 1.0 + exponent * np.log(tension_N / 10.0)
    assert load_factor(tension_N, exponent) == pytest.approx(linear, rel=0.03)


TIME_S = np.linspace(0.0, 12.0, 1201)
X_MM = 8.0 + 6.0 * np.sin(TIME_S)
DRIVE = DriveInput(X_MM, time_s=TIME_S)
SETTLED = TIME_S > 7.0  # all elements have yielded


def run(drive=DRIVE, **values):
    named = {name.replace("__", "."): value for name, value in values.items()}
    return simulate(with_values(GROUP_A, named), drive)


def test_no_law_acts_by_default():
    """A range without a weight changes nothing, to the last bit."""
    plain = run()
    ranges = run(drive_law__travel_mm=3.0, load_law__high_mm=9.0)
    for name in ("f_in_N", "f_out_N", "x_out_mm"):
        assert (getattr(ranges, name) == getattr(plain, name)).all()
    assert {law.name for law in LAWS} <= set(Effects._fields)


def test_friction_with_a_gap_changes_at_both_ends_of_the_travel_after_a_reversal():
    """Of width 2 mm: 1 mm until the spring is loose, 2 mm of gap, 1 mm until it yields."""
    rising = np.linspace(2.0, 10.0, 401)
    x = np.concatenate((rising, rising[::-1]))
    drive = DriveInput(x, time_s=np.arange(x.size) / 100.0)
    plain = run(drive)
    law = run(drive, drive_law__travel_mm=2.0, drive_law__gap_friction_1_N=3.0)
    back = 10.0 - x[401:]
    expected = np.interp(back, [0.0, 1.0, 3.0, 4.0], [3.0, 0.0, 0.0, -3.0])
    assert (law.f_in_N - plain.f_in_N)[401:] == pytest.approx(expected)
    shared = run(drive, drive_law__travel_mm=2.0, drive_law__gap_share_1=0.1)
    assert (shared.f_in_N - plain.f_in_N)[401:] == pytest.approx(
        0.1 * plain.f_in_N[401:] * expected / 3.0
    )


def test_a_share_grows_with_the_tension_of_the_tendon():
    plain, law = run(), run(drive_law__travel_mm=0.01, drive_law__share_1=0.1)
    moving = SETTLED & (np.abs(np.cos(TIME_S)) > 0.2)
    expected = 0.1 * plain.f_in_N[moving] * np.sign(np.cos(TIME_S[moving]))
    assert (law.f_in_N - plain.f_in_N)[moving] == pytest.approx(expected)


def test_motion_is_lost_at_the_load_and_the_forces_do_not_know():
    plain = run()
    law = run(load_law__travel_mm=0.05, load_law__lost_1_mm=0.2, load_law__compliance_mm_per_N=0.01)
    deep = SETTLED & (np.abs(np.cos(TIME_S)) > 0.8)  # beyond the dead band
    direction = np.sign(np.cos(TIME_S[deep]))
    expected = plain.x_out_mm - 0.01 * plain.f_out_N
    assert law.x_out_mm[deep] == pytest.approx(expected[deep] - 0.2 * direction)
    assert (law.f_in_N == plain.f_in_N).all()


def test_the_factor_of_the_friction_is_the_sum_of_its_parts():
    law = TendonLaw(
        travel_mm=1.0, low_mm=0.0, high_mm=4.0, slow_mm_per_s=1.0, fast_mm_per_s=100.0,
        start_1=0.3, curve_2=0.2, speed_2=0.5,
    )  # fmt: skip
    x, travel, speed = (
        np.array([1.0, 1.0, 4.0]),
        np.array([0.0, 1.0, np.inf]),
        np.array([1, -10, 0.1]),
    )
    expected = [1.0 + 0.2 + 0.3, 1.0 + 0.2 + 0.3 * np.exp(-1.0) + 0.5, 1.0]
    assert tendon_law_factor(law, x, travel, speed) == pytest.approx(expected)
    negative = law._replace(start_1=-3.0)
    assert tendon_law_factor(negative, x, travel, speed)[0] == 0.0


def test_a_factor_beyond_the_low_end_is_another_friction_coefficient():
    """The curve reaches 0.4 below all places of this motion."""
    curve = {f"tendon_law__curve_{k}": 0.4 for k in range(2, 6)}
    ranges = {"tendon_law__low_mm": -40.0, "tendon_law__high_mm": 0.0}
    more = GROUP_A._replace(friction_coefficient=1.4 * GROUP_A.friction_coefficient)
    law = run(**curve, **ranges)
    assert law.f_in_N == pytest.approx(simulate(more, DRIVE, nodes=NODES).f_in_N, rel=1e-9)
    assert np.ptp(law.f_in_N - simulate(GROUP_A, DRIVE, nodes=NODES).f_in_N) > 1.0
