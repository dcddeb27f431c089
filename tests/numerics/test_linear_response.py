import numpy as np
import pytest

from tsas_cli.numerics.linear_response import delayed, integrator_with_lags, lagged, sampled

H = 1e-3
W = 2.0 * np.pi * 88.0
SPRING = np.array([1.0, 2.0 * 0.04 / W, 1.0 / W**2])
LAGS = {
    "none": np.ones(1),
    "first": np.array([1.0, 0.002]),
    "second": SPRING,
    "both": np.convolve([1.0, 0.002], SPRING),
    "equal": np.convolve([1.0, 0.01], [1.0, 0.01]),
}


def speed(samples=1500):
    rng = np.random.default_rng(1)
    return 300.0 + 20.0 * np.cumsum(rng.standard_normal(samples))


@pytest.mark.parametrize("leak", [0.0, 1e-6, 0.3])
@pytest.mark.parametrize("lags", LAGS.values(), ids=LAGS)
def test_linear_between_samples_it_is_python_controls_answer(lags, leak):
    import control  # takes as long to load as all tests of this file

    u = speed()
    G = control.tf([1.0], np.polymul([1.0, leak], lags[::-1]))
    exact = control.forced_response(G, H * np.arange(u.size), u).outputs
    ours = integrator_with_lags(sampled(H, u, "first"), leak, lags)
    assert np.abs(ours - exact).max() < 2e-12 * np.abs(exact).max()


@pytest.mark.parametrize("leak", [0.0, 0.3])
@pytest.mark.parametrize("lags", LAGS.values(), ids=LAGS)
def test_kept_between_samples_it_is_a_fine_staircase(lags, leak):
    u, finer = speed(200), 50
    steps = np.repeat(u, finer)
    ours = integrator_with_lags(sampled(H, u, "zero"), leak, lags)
    fine = integrator_with_lags(sampled(H / finer, steps, "first"), leak, lags)[::finer]
    late = 0.5 * H / finer * np.abs(u).max()  # the fine one's ramps
    assert np.abs(ours - fine).max() < 1.5 * late
    other = integrator_with_lags(sampled(H, u, "first"), leak, lags)
    assert np.abs(ours - other).max() > 5.0 * late


@pytest.mark.parametrize("hold", ["zero", "first"])
def test_a_delay_of_whole_samples_is_a_shift(hold):
    u = sampled(H, speed() - speed()[0], hold)
    answer, late = (integrator_with_lags(v, 0.0, LAGS["both"]) for v in (u, delayed(u, 7 * H)))
    np.testing.assert_allclose(late[7:], answer[:-7], atol=1e-9 * np.abs(answer).max())
    assert not late[:7].any()


@pytest.mark.parametrize("hold", ["zero", "first"])
def test_a_fraction_of_a_sample_is_a_delay_too(hold):
    t = H * np.arange(2000)
    u = sampled(H, 500.0 * np.sin(12.0 * t) ** 2, hold)
    late = integrator_with_lags(delayed(u, 0.0024), 0.0, LAGS["first"])
    answer = integrator_with_lags(u, 0.0, LAGS["first"])
    np.testing.assert_allclose(late[10:], np.interp(t[10:] - 0.0024, t, answer), atol=2e-3)


def test_what_is_lagged_arrives_whole():
    out = lagged(sampled(H, np.full(3000, 2.0), "first"), LAGS["both"])
    assert out[0] == 0.0
    assert out[-1] == pytest.approx(2.0)
    assert out[20] != pytest.approx(2.0, rel=1e-3)
