"""What holds the load back, each against its closed form with f_out = F0 + kL x + what it adds."""

import numpy as np
import pytest

from tsas_studies.challenge.rig.motions import Motion, through
from tsas_studies.challenge.rig.restraint import Restraint
from tsas_studies.challenge.rig.tendon import Rig, simulate

KL, F0 = 1.579, 25.0
MOTION = through([10.0, 2.0, 10.0, 2.0], speed_mm_s=4.0, rate_Hz=400.0)


def added(motion=MOTION, **options):
    """Return time, x_out and what the restraint adds to the spring's force."""
    rig = Rig(cells=30, restraint=Restraint(**options))
    columns = simulate(rig, motion).columns
    x = columns["x_out_mm"]
    return motion.time_s, x, columns["f_out_N"] - F0 - KL * x


def test_inner_friction_costs_work_in_a_closed_loop_and_turns_over_its_length():
    _, x, force = added(hysteresis_N=1.2, hysteresis_mm=0.4)
    tops = np.flatnonzero(MOTION.x_in_mm > 10.0 - 1e-9)
    loop = slice(tops[0], tops[-1] + 1)
    stroke = np.ptp(x[loop])
    # Twice force times stroke less what turning round saves, 2 · force · length at each reversal.
    expected = 2.0 * 1.2 * (stroke - 2.0 * 0.4)
    assert np.trapezoid(force[loop], x[loop]) == pytest.approx(expected, rel=0.02)
    assert force[tops[0]] == pytest.approx(1.2, rel=1e-3)


def test_a_clamp_slides_in_its_slot_between_its_forces():
    _, x, force = added(clamp_play_mm=0.8, clamp_up_N=34.0, clamp_down_N=31.0)
    gone = -force / KL
    assert gone.min() > -1e-6
    assert gone.max() == pytest.approx(0.8, abs=1e-6)
    spring = F0 + KL * (x - gone)
    inside = (gone > 0.01) & (gone < 0.79)
    assert inside.sum() > 20
    moving = np.concatenate(([0.0], np.diff(gone)))
    np.testing.assert_allclose(spring[inside & (moving > 1e-6)], 34.0, atol=1e-3)
    np.testing.assert_allclose(spring[inside & (moving < -1e-6)], 31.0, atol=1e-3)


@pytest.mark.parametrize("load", ["force", "displacement"])
def test_a_restraint_needs_a_spring(load):
    rig = Rig(load=load, restraint=Restraint(damping_N_s_per_mm=0.1))
    with pytest.raises(ValueError, match="no load end"):
        simulate(rig, Motion(np.arange(3.0), np.zeros(3)), distal=np.full(3, 25.0))
