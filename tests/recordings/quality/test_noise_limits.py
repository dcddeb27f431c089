"""Limits of the checks of noise: nothing just below, a finding just above."""

from dataclasses import replace

import numpy as np
import pytest

from tests.recordings.quality.even_runs import FINE, N, are, of
from tsas_cli.recordings.quality.checks import bursts, filtering, noise
from tsas_cli.recordings.quality.samples import NoiseSpectrum


def spectrum(power, steady=()):
    frequency = np.arange(1.0, len(power) + 1.0)
    is_steady = np.isin(np.arange(len(power)), steady)
    return NoiseSpectrum(frequency, np.array(power), np.ones(len(power), bool), is_steady)


@pytest.mark.parametrize(
    ("line", "beside", "steady", "found"),
    [
        (20.1, {}, (9,), 10.0),
        (19.9, {}, (9,), None),
        (20.1, {}, (), None),
        (20.1, {8: 5.0, 10: 5.0, 12: 5.0}, (9,), 10.0),  # within a third of its frequency
        *((20.1, {at: 1.01}, (9,), None) for at in (4, 5, 13, 16)),
        (20.1, {3: 9.0, 17: 9.0}, (9,), 10.0),  # two bands below, four above
        (20.1, {15: 25.0}, (9,), None),
    ],
)
def test_a_line_is_twenty_times_what_is_on_both_of_its_sides(line, beside, steady, found):
    power = np.ones(40)
    for at, value in ({9: line} | beside).items():
        power[at] = value
    assert noise._line(spectrum(power, steady)) == found


@pytest.mark.parametrize(("at", "found"), [(0, None), (39, None), (2, 3.0)])
def test_a_line_without_anything_beside_it_is_none(at, found):
    assert noise._line(spectrum(np.where(np.arange(40) == at, 99.0, 1.0), (at,))) == found


@pytest.mark.parametrize(
    ("bands", "top", "rounding", "found"),
    [
        (20, 1.0 / 31.0, 0.03, 20),
        (20, 1.0 / 29.0, 0.03, 0),  # it falls by less than thirty times
        (20, 1.0 / 31.0, 0.0228, 0),  # white noise of its own above, beyond 1.4 times the rounding
        (20, 1.0 / 31.0, 0.0233, 20),
        (1, 1e-4, 8e-5, 0),  # what is left of a motion
        (2, 1e-4, 8e-5, 2),
        (2, 1e-4, 1.1e-3, 0),  # nothing is rounded: it was computed
        (3, 1e-4, 1.1e-3, 3),
        (2, 0.0, 0.0, 0),
        (3, 0.0, 0.0, 3),
    ],
)
def test_noise_ends_where_it_falls_thirtyfold_after_two_even_bands(bands, top, rounding, found):
    power = np.where(np.arange(1, 101) <= bands, 1.0, top)
    assert (filtering._end_of_noise(spectrum(power), rounding) or 0) == found


def test_a_spectrum_that_is_white_at_the_top_has_no_end():
    power = np.where(np.arange(1, 101) <= 20, 99.0, 1.0)
    power[29:50] = 2.4
    assert filtering._end_of_noise(spectrum(power), 0.4) is None
    power[29:50] = 2.6  # it still falls there
    assert filtering._end_of_noise(spectrum(power), 0.4) == 20.0


@pytest.mark.parametrize(
    ("times", "blocks", "found"), [(4.1, 2, 1), (3.9, 2, 0), (4.1, 1, 0), (4.1, 3, 1), (4.1, 4, 0)]
)
def test_noise_bursts_by_four_times_in_two_blocks_and_few_of_all(times, blocks, found):
    """Of 24 blocks of 16 rows a seventh at most."""
    size = np.ones(N)
    size[160 : 160 + 16 * blocks + 3] = times
    loud = (-1.0) ** np.arange(N) * size
    told = of(bursts.bursts, sizes={"f_in_N": replace(FINE, noise=1.0)}, f_in_N=loud)
    are(told, found, "rises to 4.1 times its level in 1 burst, the first at 1.6 s")
