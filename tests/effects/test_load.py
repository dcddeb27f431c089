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
    """Return f_out and what it should be, for a load that is made to follow a known motion."""
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


def test_a_load_without_times_is_relaxed():
    x_in = np.linspace(0.0, 8.0, 50)
    rig = with_values(GROUP_A, {"load_relaxation.share": 0.8})
    relaxed, plain = (simulate(r, DriveInput(x_in), nodes=NODES) for r in (rig, GROUP_A))
    np.testing.assert_array_equal(relaxed.f_out_N, plain.f_out_N)
