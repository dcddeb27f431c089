"""Friction of every kind against the closed form of its profile along the sheath."""

import math

import numpy as np
import pytest

from tsas_studies.challenge.rig.friction import Friction
from tsas_studies.challenge.rig.motions import through
from tsas_studies.challenge.rig.tendon import Rig, simulate

A = 0.125 * math.pi
F0 = 25.0
UP, DOWN = 10.0, 3.0


def run(speed=4.0, session_s=0.0, **options):
    motion = through([UP, DOWN, DOWN + 0.5], speed_mm_s=speed, rate_Hz=50.0 * speed)
    rig = Rig(cells=80, friction=Friction(**options))
    columns = simulate(rig, motion, session_s=session_s).columns
    at = [int(UP * 50), int((2.0 * UP - DOWN) * 50)]
    return columns, [math.log(columns["f_in_N"][i] / columns["f_out_N"][i]) for i in at]


def test_friction_by_direction_has_its_own_capstan_ratio_each_way():
    _, (pulling, releasing) = run(asymmetry=0.2)
    assert pulling == pytest.approx(1.2 * A, rel=1e-5)
    assert releasing == pytest.approx(-0.8 * A, rel=1e-5)


@pytest.mark.parametrize("speed", [2.0, 6.0])
def test_friction_falls_with_speed(speed):
    _, (pulling, releasing) = run(speed, stribeck_excess=0.3, stribeck_velocity_mm_per_s=5.0)
    expected = A * (1.0 + 0.3 * math.exp(-((speed / 5.0) ** 2)))
    assert pulling == pytest.approx(expected, rel=0.01)
    assert releasing == pytest.approx(-expected, rel=0.01)


def test_viscous_friction_adds_evenly_along_the_sheath():
    """dT/ds = μκT + c v/L from the load to the drive: T_in = T_out e^a + c v (e^a − 1)/a."""
    columns, _ = run(4.0, viscous_N_s_per_mm=0.5)
    i = int(UP * 50)
    expected = columns["f_out_N"][i] * math.exp(A) + 0.5 * 4.0 * math.expm1(A) / A
    assert columns["f_in_N"][i] == pytest.approx(expected, rel=2e-3)
    plain, _ = run(4.0)
    assert columns["f_in_N"][i] - plain["f_in_N"][i] > 1.5


def test_friction_by_load_has_a_power_law_as_profile():
    """dT/ds = μκT (T/F0)^n: (T_in/F0)^−n = (T_out/F0)^−n − n a."""
    columns, _ = run(load_exponent=0.4)
    for i, a in ((int(UP * 50), A), (int((2.0 * UP - DOWN) * 50), -A)):
        ratio = (columns["f_out_N"][i] / F0) ** -0.4 - 0.4 * a
        assert columns["f_in_N"][i] == pytest.approx(F0 * ratio ** (-1.0 / 0.4), rel=2e-4)


def test_presliding_turns_round_as_dahl_says():
    """Of a tendon that hardly stretches all places move alike: ln ratio = a (2 e^(−d/δ) − 1)."""
    motion = through([5.0, 4.8], speed_mm_s=0.5, rate_Hz=200.0)
    rig = Rig(cells=40, tendon_modulus_GPa=6e4, friction=Friction(presliding_mm=0.05))
    columns = simulate(rig, motion).columns
    turn = int(np.argmax(motion.x_in_mm))
    gone = motion.x_in_mm[turn] - motion.x_in_mm[turn:]
    ratio = np.log(columns["f_in_N"][turn:] / columns["f_out_N"][turn:])
    expected = A * (2.0 * np.exp(-gone / 0.05) - 1.0)
    np.testing.assert_allclose(ratio, expected, atol=2e-3)


def test_the_bend_grows_and_settles():
    for settling, grown in ((0.0, 0.1 * 2.5), (0.4, 0.1 * (1.0 - math.exp(-1.0)) / 0.4)):
        _, (pulling, _) = run(bend_rate_rad_per_s=0.1, bend_settling_per_s=settling)
        assert pulling == pytest.approx(0.125 * (math.pi + grown), rel=1e-4)


def test_friction_grows_over_the_run_and_over_the_session():
    _, (pulling, releasing) = run(rate_per_s=-0.05)
    assert pulling == pytest.approx(A * (1.0 - 0.05 * 2.5), rel=1e-4)
    assert releasing == pytest.approx(-A * (1.0 - 0.05 * 4.25), rel=1e-4)
    _, (pulling, _) = run(session_rate_per_s=1e-3, session_s=200.0)
    assert pulling == pytest.approx(1.2 * A, rel=1e-4)
    _, (pulling, _) = run(rate_per_s=0.1, settling_per_s=0.4)
    assert pulling == pytest.approx(A * (1.0 + 0.25 * (1.0 - math.exp(-1.0))), rel=1e-4)


def test_friction_and_bend_never_turn_negative():
    motion = through([10.0], speed_mm_s=4.0, rate_Hz=100.0)
    for gone in (Friction(rate_per_s=-1.0), Friction(bend_rate_rad_per_s=-4.0)):
        last = {k: v[-1] for k, v in simulate(Rig(cells=40, friction=gone), motion).columns.items()}
        assert last["f_in_N"] == pytest.approx(last["f_out_N"], rel=1e-6)


def test_a_sheath_that_is_compressed_makes_the_tendon_softer():
    motion = through([10.0, 3.0], rate_Hz=100.0)
    softer = simulate(Rig(cells=60, sheath_compliance_ratio=0.5), motion).columns
    tendon = simulate(Rig(cells=60, tendon_modulus_GPa=40.0), motion).columns
    for name in tendon:
        np.testing.assert_allclose(softer[name], tendon[name], atol=1e-6)
