"""Friction of every kind against the closed form of its profile along the sheath."""

import math

import pytest

from tsas_studies.challenge.rig.friction import Friction
from tsas_studies.challenge.rig.motions import through
from tsas_studies.challenge.rig.tendon import Rig, simulate

A = 0.125 * math.pi
UP, DOWN = 10.0, 3.0


def run(speed=4.0, session_s=0.0, **options):
    motion = through([UP, DOWN, DOWN + 0.5], speed_mm_s=speed, rate_Hz=50.0 * speed)
    rig = Rig(cells=80, friction=Friction(**options))
    columns = simulate(rig, motion, session_s=session_s).columns
    at = [int(UP * 50), int((2.0 * UP - DOWN) * 50)]
    return columns, [math.log(columns["f_in_N"][i] / columns["f_out_N"][i]) for i in at]


@pytest.mark.parametrize("speed", [2.0, 6.0])
def test_friction_falls_with_speed(speed):
    _, (pulling, releasing) = run(speed, stribeck_excess=0.3, stribeck_velocity_mm_per_s=5.0)
    expected = A * (1.0 + 0.3 * math.exp(-((speed / 5.0) ** 2)))
    assert pulling == pytest.approx(expected, rel=0.01)
    assert releasing == pytest.approx(-expected, rel=0.01)


def test_friction_and_bend_never_turn_negative():
    motion = through([10.0], speed_mm_s=4.0, rate_Hz=100.0)
    for gone in (Friction(rate_per_s=-1.0), Friction(bend_rate_rad_per_s=-4.0)):
        last = {k: v[-1] for k, v in simulate(Rig(cells=40, friction=gone), motion).columns.items()}
        assert last["f_in_N"] == pytest.approx(last["f_out_N"], rel=1e-6)
