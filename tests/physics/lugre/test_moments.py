"""Which moments of a run its stability is looked at, on a run that is written down."""

import numpy as np

from tests.physics.references import GROUP_A
from tsas_cli.physics.lugre.stability import Sliding, Stability, moments
from tsas_cli.physics.rig import with_values

TIME_S = np.arange(12.0)
SPEED = np.array([0.0, 1.0, 2.0, 4.0, 3.0, 0.0, -1.0, -2.0, -6.0, -3.0, -1.0, 0.0])
PLACE = np.concatenate(([0.0], np.cumsum(0.5 * (SPEED[1:] + SPEED[:-1]))))
TENSION = np.array([25.0, 40.0, 50.0, 52.0, 20.0, 54.0, 40.0, 28.0, 26.0, 5.0, 24.0, 24.0])
PHASE = np.array([0, 0, 1, 1, 1, 0, 0, -1, -1, -1, -1, 0], dtype=np.int8)
RIG = with_values(GROUP_A, {"stribeck_friction.velocity_mm_per_s": 2.0 * 2.0**0.5})


def found(phase=PHASE, tension=TENSION):
    return moments(RIG, TIME_S, PLACE, tension, phase)


def test_both_directions_are_looked_at_where_they_are_fastest_and_where_friction_falls():
    speed = np.gradient(PLACE, TIME_S)
    whole = [m for m in found() if m.whole]
    for direction in (1.0, -1.0):
        own = [m for m in whole if np.sign(m.speed_mm_s) == direction]
        slips = direction == PHASE
        fast = np.abs(speed[slips])
        assert max(abs(m.speed_mm_s) for m in own) == fast.max()
        assert max(abs(m.speed_mm_s) / m.f_in_N for m in own) == (fast / TENSION[slips]).max()
        nearest = min(abs(abs(m.speed_mm_s) - 2.0) for m in own)
        assert nearest == np.abs(fast - 2.0).min()
        assert len(own) == len({m.f_in_N for m in own})


def test_in_a_dead_band_the_middle_one_by_steepness_is_looked_at():
    halves = [m for m in found() if not m.whole]
    assert {np.sign(m.speed_mm_s) for m in halves} == {1.0, -1.0}
    speed, rate = np.gradient(PLACE, TIME_S), np.gradient(TENSION, TIME_S)
    for m in halves:
        band = (PHASE == 0) & (np.sign(speed) == np.sign(m.speed_mm_s))
        steep = np.sort(np.abs(rate[band] / speed[band]))
        assert abs(m.f_in_rate / m.speed_mm_s) == steep[steep.size // 2]


def test_a_moment_lasts_as_long_as_its_speed_and_no_longer_than_the_run():
    speed = np.gradient(PLACE, TIME_S)
    faster = np.gradient(speed, TIME_S)
    for m in found():
        (k,) = np.flatnonzero((m.f_in_N == TENSION) & (speed == m.speed_mm_s))
        lasts = abs(speed[k]) / abs(faster[k]) if faster[k] else np.inf
        assert m.lasts_s == min(lasts, 11.0)
        assert m.f_in_rate == np.gradient(TENSION, TIME_S)[k]


def test_nothing_slides_without_tension():
    assert found(tension=np.zeros(12)) == []
    hanging = np.where(PHASE == -1, 0.0, TENSION)
    assert {np.sign(m.speed_mm_s) for m in found(tension=hanging) if m.whole} == {1.0}


def test_it_is_unstable_from_three_e_folds_on():
    for growth, unstable in ((1.4, False), (1.6, True)):
        one = Stability(growth, Sliding(30.0, 0.0, 5.0, whole=True, lasts_s=2.0))
        assert one.folds == 2.0 * growth
        assert one.unstable == unstable
