"""What acts at the load over time; its laws at a sample: physics/slip/test_small_chains.py."""

import math

import numpy as np
import pytest

from tests.effects.runs import run
from tests.physics.references import GROUP_A
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.response import NODES, simulate
from tsas_cli.physics.rig import with_values
from tsas_cli.physics.slip.ends import SLIPS_ALONG_S

KL = GROUP_A.load_stiffness_N_per_mm


def spring_of(answer):
    return 25.0 + KL * answer.x_out_mm


@pytest.mark.parametrize(
    ("settling", "lost"), [(0.0, 0.3 * 28.0), (0.2, 1.5 * (1 - math.exp(-5.6)))]
)
def test_an_anchor_that_gives_way(settling, lost):
    values = {"rate_N_per_s": 0.3, "settling_per_s": settling}
    answer = run({f"preload_loss.{name}": value for name, value in values.items()})
    missing = spring_of(answer) - answer.f_out_N
    assert missing[0] == pytest.approx(0.0, abs=1e-9)
    assert missing[-1] == pytest.approx(lost, rel=1e-9)


MASS, OMEGA = 3.0, 4.0


def of_a_mass(samples):
    """Return f_out and what it should be, for a load that is made to follow a known motion.

    The load moves with 1 − cos ωt, and its mass with the same after a lag of the first order.
    Without friction the drive's travel is that of the load and the stretch of the tendon.
    """
    t = np.linspace(0.0, 3.0, samples)
    x_out = t - np.sin(OMEGA * t) / OMEGA
    phase = math.atan(OMEGA * SLIPS_ALONG_S)
    lagging = 1.0 - math.cos(phase) * np.cos(OMEGA * t - phase)
    lagging -= math.sin(phase) ** 2 * np.exp(-t / SLIPS_ALONG_S)
    taken_up = (1.0 - np.cos(OMEGA * t) - lagging) / SLIPS_ALONG_S
    tension = 25.0 + KL * x_out + 1e-3 * MASS * taken_up
    smooth = GROUP_A._replace(friction_coefficient=1e-12)
    x_in = x_out + (tension - 25.0) * smooth.sheath_length_mm / smooth.tendon_stiffness_N
    return run({"load_inertia.mass_kg": MASS}, x_in, rig=smooth, time_s=t), tension, x_out, t


def test_a_mass_needs_a_force_to_speed_up():
    """Newton's law but for the lag, and of second order in the time between samples."""
    apart = []
    for samples in (3001, 6001):
        answer, tension, x_out, t = of_a_mass(samples)
        np.testing.assert_allclose(answer.x_out_mm, x_out, atol=1e-3)
        apart.append(np.abs(answer.f_out_N - tension).max())
    newton = 1e-3 * MASS * OMEGA * np.sin(OMEGA * t)
    most = np.abs(newton).max()
    assert np.abs(tension - 25.0 - KL * x_out - newton).max() < OMEGA * SLIPS_ALONG_S * most
    assert apart[0] < 0.001 * most
    assert apart[0] / apart[1] == pytest.approx(4.0, rel=0.2)


K = 4.0  # of the tendon [N/mm]
SOFT = GROUP_A._replace(
    friction_coefficient=1e-9, tendon_stiffness_N=K * GROUP_A.sheath_length_mm, preload_N=40.0
)
BOTH = pytest.mark.parametrize("dynamics", ["slip", "lugre"])


def softly(values, x_in, time_s, dynamics):
    """Return the answer of a rig without friction on a soft tendon, for which four nodes do."""
    drive = DriveInput(x_in, time_s=time_s)
    return simulate(with_values(SOFT, values), drive, dynamics, nodes=4)


@BOTH
def test_a_damped_load_comes_late(dynamics):
    """c x′ + (K + kL) x = K r t."""
    t, rate, damping = np.arange(0.0, 2.0, 2e-3), 6.0, 1.5
    answer = softly({"load_damping.coefficient_N_s_per_mm": damping}, rate * t, t, dynamics)
    late = damping / (K + KL)
    exact = K * rate / (K + KL) * (t - late * (1.0 - np.exp(-t / late)))
    assert late > 0.2
    np.testing.assert_allclose(answer.x_out_mm, exact, atol=2e-3 * exact[-1])
    np.testing.assert_allclose(answer.f_out_N, 40.0 + K * (rate * t - exact), atol=0.1)


def elastoplastic(x, force, travel):
    """Return an element's force for an input, sample by sample: back inside its limits."""
    z = [0.0]
    for moved in np.diff(x):
        z.append(float(np.clip(z[-1] + force / travel * moved, -force, force)))
    return np.array(z)


@BOTH
def test_an_element_that_yields_makes_a_loop_of_its_own(dynamics):
    """f_out is the spring and the element for the motion of x_out that comes out."""
    t = np.arange(0.0, 6.0, 2e-3)
    values = {"load_hysteresis.force_N": 6.0, "load_hysteresis.travel_mm": 1.5}
    x_in = np.interp(t, [0.0, 2.0, 2.6, 3.2, 4.5, 6.0], [0.0, 10.0, 8.0, 10.5, 2.0, 8.0])
    answer = softly(values, x_in, t, dynamics)
    element = elastoplastic(answer.x_out_mm, 6.0, 1.5)
    assert element.max() == -element.min() == 6.0
    assert np.abs(element[(t > 2.1) & (t < 2.6)]).max() < 6.0  # a small loop, which does not yield
    spring = 40.0 + KL * answer.x_out_mm
    np.testing.assert_allclose(answer.f_out_N, spring + element, atol=0.02)
    np.testing.assert_allclose(answer.f_out_N, 40.0 + K * (x_in - answer.x_out_mm), atol=0.02)


@BOTH
def test_a_load_that_relaxes_falls_back_by_an_exponential(dynamics):
    """A ramp, then rest: K (x_in − x) = kL x + k w with dw/dt = dx/dt − w/τ, solved for x.

    (K + kL + k) dx/dt = K dx_in/dt + k w/τ; with y = x − w that is dy/dt = (x − y)/τ, and x is
    (K x_in + k y)/(K + kL + k): y follows x_in by a low pass of its own, slower by k.
    """
    share, time_s = 0.8, 0.5
    t = np.arange(0.0, 4.0, 2e-3)
    x_in, rate = np.minimum(8.0 * t, 8.0), 8.0
    values = {"load_relaxation.share": share, "load_relaxation.time_s": time_s}
    answer = softly(values, x_in, t, dynamics)
    k = share * KL
    low, slower = K / (K + KL), time_s * (K + KL + k) / (K + KL)
    since = np.maximum(t - 1.0, 0.0)
    y = low * rate * (t - slower * (1.0 - np.exp(-t / slower)))
    y -= low * rate * (since - slower * (1.0 - np.exp(-since / slower)))
    x = (K * x_in + k * y) / (K + KL + k)
    np.testing.assert_allclose(answer.x_out_mm, x, atol=5e-3)
    np.testing.assert_allclose(answer.f_out_N, 40.0 + KL * x + k * (x - y), atol=0.02)
    assert answer.f_out_N.max() - answer.f_out_N[-1] > 1.0


def test_a_load_without_times_is_relaxed():
    x_in = np.linspace(0.0, 8.0, 50)
    rig = with_values(SOFT, {"load_relaxation.share": 0.8})
    relaxed, plain = (simulate(r, DriveInput(x_in), nodes=NODES) for r in (rig, SOFT))
    np.testing.assert_array_equal(relaxed.f_out_N, plain.f_out_N)


@BOTH
def test_an_eccentric_pulley_makes_a_wave_on_the_spring(dynamics):
    t = np.arange(0.0, 4.0, 2e-3)
    x_in = np.interp(t, [0.0, 2.0, 4.0], [0.0, 14.0, 2.0])
    wave = {"sine_mm": 0.2, "cosine_mm": -0.1, "period_mm": 5.0}
    answer = softly({f"load_ripple.{n}": v for n, v in wave.items()}, x_in, t, dynamics)
    x = answer.x_out_mm
    angle = 2.0 * np.pi * x / 5.0
    stretched = x + 0.2 * np.sin(angle) - 0.1 * (np.cos(angle) - 1.0)
    assert x.max() > 8.0
    np.testing.assert_allclose(answer.f_out_N, 40.0 + KL * stretched, atol=5e-3)
    # At a corner of the input, which the dynamic chain follows by a cubic, less exactly.
    np.testing.assert_allclose(answer.f_out_N, 40.0 + K * (x_in - x), atol=0.02)
    assert np.abs(answer.f_out_N - 40.0 - KL * x).max() > 0.3
