"""The measured response, held against its definition: means over segments, written out."""

import numpy as np
import pytest

from tsas_cli.drive.runs import DriveRun, FrequencyResponse, frequency_response
from tsas_cli.numerics.linear_response import sampled


def run_of(u, x, step_s):
    return DriveRun("a", sampled(step_s, np.asarray(u), "first"), np.asarray(x), 1.0, at_rest=True)


def noise_of(seconds, step_s=0.02, seed=1, part=0.7):
    """A run whose x_in follows low frequencies only: x is u smoothed, and noise."""
    rng = np.random.default_rng(seed)
    u = rng.standard_normal(round(seconds / step_s) + 1)
    x = np.convolve(u, np.ones(7) / 7.0, mode="same") + part * 0.3 * rng.standard_normal(u.size)
    return run_of(u, x, step_s)


def spectra(run, segment_s):
    """Return means of |U|², U*X and |X|² over segments of one length that overlap by half."""
    step_s = run.u.step_s
    n = round(segment_s / step_s)
    k = np.arange(n)
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * k / n)
    found = []
    for first in range(0, run.x_in.size - n + 1, n - n // 2):
        pair = []
        for values in (run.u.values, run.x_in):
            part = values[first : first + n]
            line = np.polyval(np.polyfit(k, part, 1), k)
            pair.append(np.fft.rfft(window * (part - line)))
        U, X = pair
        found.append([np.conj(U) * U, np.conj(U) * X, np.conj(X) * X])
    return 2.0 * step_s / np.sum(window**2) * np.mean(found, axis=0)


@pytest.mark.parametrize(
    ("lengths", "segment_s"),
    [
        ((80.0,), 5.0),  # the longest there is
        ((20.0,), 2.0),  # a tenth of the run
        ((3.0, 20.0), 1.5),  # a half of the shorter one
        ((20.0, 40.0), 4.0),
    ],
)
def test_it_is_the_mean_of_segments_each_run_as_long_as_it_is(lengths, segment_s):
    runs = [noise_of(seconds, seed=k) for k, seconds in enumerate(lengths)]
    seen = frequency_response(runs)
    bins = round(segment_s / 0.02) // 2
    assert seen.frequency_Hz == pytest.approx(np.arange(1, bins) / segment_s)
    uu, ux, xx = sum(run.time_s[-1] * spectra(run, segment_s)[:, 1:bins] for run in runs)
    np.testing.assert_allclose(seen.response, ux / uu, rtol=1e-6)
    coherence = np.abs(ux) ** 2 / (uu * xx).real
    np.testing.assert_allclose(seen.coherence, coherence, rtol=1e-6)
    told = (coherence > 0.8) & (uu.real > 1e-5 * uu.real.max())
    beside = [told[max(k - 1, 0) : k + 2].sum() > 1 for k in range(told.size)]
    np.testing.assert_array_equal(seen.excited, told & beside)
    assert 0 < seen.excited.sum() < seen.excited.size
    at = seen.frequency_Hz[seen.excited]
    assert seen.band == (at[0], at[-1])


def test_runs_of_two_clocks_share_the_frequencies_of_the_slower():
    fast, slow = noise_of(20.0, 0.01), noise_of(20.0, 0.04, seed=2)
    seen = frequency_response([fast, slow])
    assert seen.frequency_Hz == pytest.approx(np.arange(1, 25) / 2.0)
    uu, ux, _ = spectra(fast, 2.0)[:, 1:25] + spectra(slow, 2.0)[:, 1:25]
    np.testing.assert_allclose(seen.response, ux / uu, rtol=1e-6)


def test_a_frequency_of_next_to_no_power_says_nothing():
    """Two tones that x_in follows, and a third at a thousandth of their size: 1e-6 of the power."""
    step_s, t = 0.02, 0.02 * np.arange(1001)
    faint = {}
    for size in (1e-3, 1e-2):
        u = np.sin(2 * np.pi * 3.0 * t) + size * np.sin(2 * np.pi * 12.0 * t)
        seen = frequency_response([run_of(u, 2.0 * u, step_s)])
        faint[size] = bool(seen.excited[np.argmin(np.abs(seen.frequency_Hz - 12.0))])
        assert seen.excited[np.argmin(np.abs(seen.frequency_Hz - 3.0))]
        assert seen.coherence.max() <= 1.0 + 1e-9
    assert faint == {1e-3: False, 1e-2: True}


def test_a_motor_at_rest_has_no_response():
    rest = run_of(np.zeros(1001), np.random.default_rng(1).standard_normal(1001), 0.02)
    seen = frequency_response([rest])
    assert not seen.response.any()
    assert seen.band is None
    one = FrequencyResponse(np.array([1.0, 2.0]), np.ones(2), np.ones(2), np.array([False, True]))
    assert one.band == (2.0, 2.0)
