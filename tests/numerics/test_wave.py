"""A wave of two harmonics, against its Fourier coefficients and a difference of its values."""

import math

import numpy as np
import pytest

from tsas_cli.numerics.wave import Wave, wave_at, wave_from

WAVE = Wave(0.3, -0.4, 5.0, 0.2, 0.1)
TURN = 5.0 * np.arange(1000) / 1000.0


def test_the_second_harmonic_is_a_share_of_the_first():
    values, _ = wave_at(TURN, WAVE)
    turned = np.fft.rfft(values) / (0.5 * TURN.size)
    size = math.hypot(0.3, 0.4)
    assert turned[1] == pytest.approx(-0.4 - 0.3j)
    assert turned[2] == pytest.approx(size * (0.1 - 0.2j))
    assert np.abs(turned[3:]).max() < 1e-12
    assert wave_at(0.0, WAVE)[0] == 0.0


@pytest.mark.parametrize("wave", [WAVE, Wave(0.3, 0.0, 5.0), Wave(0.0, 0.2, 3.0, 0.0, -0.5)])
def test_the_slope_is_that_of_the_values_and_none_is_beyond_the_reach(wave):
    values, slope = wave_at(TURN, wave)
    ahead, behind = wave_at(TURN + 1e-5, wave)[0], wave_at(TURN - 1e-5, wave)[0]
    np.testing.assert_allclose(slope, (ahead - behind) / 2e-5, atol=1e-8)
    assert np.abs(values).max() <= wave.reach_mm


@pytest.mark.parametrize("origin", [0.0, 1.3, -7.0, 49.9])
def test_from_an_origin_it_is_the_same_but_for_a_constant(origin):
    apart = wave_at(TURN, WAVE)[0] - wave_at(TURN - origin, wave_from(WAVE, origin))[0]
    assert np.ptp(apart) < 1e-12
    assert wave_at(0.0, wave_from(WAVE, origin))[0] == 0.0


def test_a_distant_origin_tells_no_phase():
    assert wave_from(WAVE, 50.1) == wave_from(WAVE, -50.1) == WAVE


def test_a_wave_of_no_size_has_no_harmonic():
    assert Wave(second_sine=0.5).is_flat
    assert np.abs(wave_at(TURN, Wave(second_sine=0.5))[0]).max() == 0.0
