import numpy as np
import pytest

from tsas_studies.challenge.rig import motions

ALL = ("chirp", "dwell", "nested", "sine", "steps", "triangle", "two_sines")


@pytest.mark.parametrize("name", ALL)
def test_motions_start_at_zero_pull_first_and_keep_an_even_clock(name):
    motion = getattr(motions, name)(rate_Hz=250.0)
    assert motion.x_in_mm[0] == motion.time_s[0] == 0.0
    assert motion.x_in_mm[20] > 0.0
    assert motion.x_in_mm.min() > -1e-9
    assert np.diff(motion.time_s) == pytest.approx(0.004)


def test_sine_is_the_papers():
    motion = motions.sine(amplitude_mm=7.0, omega_rad_s=2.0, periods=2.0)
    t = motion.time_s
    np.testing.assert_allclose(motion.x_in_mm, 7.0 * np.sin(2.0 * t - np.pi / 2.0) + 7.0, atol=1e-9)
    assert t[-1] == pytest.approx(2.0 * np.pi, abs=1e-3)


def test_through_goes_at_its_speed_and_waits_where_a_point_is_given_twice():
    motion = motions.through([4.0, 4.0, 1.0], speed_mm_s=2.0)
    at = np.interp([1.0, 2.5, 3.5, 4.5], motion.time_s, motion.x_in_mm)
    assert at == pytest.approx([2.0, 4.0, 3.0, 1.0])
    assert motion.time_s[-1] == pytest.approx(4.5)


def test_chirp_grows_from_the_first_frequency_to_the_last():
    motion = motions.chirp(from_Hz=0.5, to_Hz=4.0, duration_s=20.0)
    bottoms = motion.time_s[1:-1][
        (motion.x_in_mm[1:-1] < motion.x_in_mm[:-2]) & (motion.x_in_mm[1:-1] <= motion.x_in_mm[2:])
    ]
    periods = np.diff(np.concatenate(([0.0], bottoms)))
    assert 1.0 / periods[0] == pytest.approx(0.5, rel=0.15)
    assert 1.0 / periods[-1] == pytest.approx(4.0, rel=0.05)
