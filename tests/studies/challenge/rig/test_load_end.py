import math
from dataclasses import replace

import numpy as np
import pytest

from tsas_studies.challenge.rig.load_end import LoadEnd
from tsas_studies.challenge.rig.motions import Motion, clock, sine, through
from tsas_studies.challenge.rig.tendon import Rig, simulate

KL, F0, A = 1.579, 25.0, 0.125 * math.pi
RIG = Rig(cells=60)
MOTION = through([10.0, 2.0, 10.0], speed_mm_s=4.0, rate_Hz=200.0)


def run(motion=MOTION, rig=RIG, **options):
    return simulate(replace(rig, load_end=LoadEnd(**options)), motion).columns


def test_a_mass_needs_force_to_be_accelerated():
    """At 30 mm/s² a load that has stopped swinging follows with 30 mm/s² less the stretch."""
    t = clock(0.9, 400.0)
    columns = run(mass_kg=12.0, loose_share=0.5, motion=Motion(t, 15.0 * t**2))
    x = columns["x_out_mm"]
    late = t > 0.5
    a = 2.0 * np.polyfit(t[late], x[late], 2)[0]
    assert a == pytest.approx(30.0, rel=0.05)
    inertia = np.mean((columns["f_out_N"] - F0 - KL * x)[late])
    assert inertia == pytest.approx(12e-3 * a, rel=0.05)


def test_a_loose_part_of_the_mass_calms_it():
    motion = sine(omega_rad_s=2.0, periods=1.0, rate_Hz=400.0)
    stiff, calm = (run(mass_kg=12.0, loose_share=s, motion=motion)["x_out_mm"] for s in (0.0, 0.5))
    late = (motion.time_s > 0.6) & (motion.time_s < 1.4)
    swings = [np.std(np.diff(x, 2)[late[1:-1]]) * 400.0**2 for x in (stiff, calm)]
    assert swings[1] < 0.3 * swings[0]


def test_a_mass_swings_on_the_tendon_at_its_own_frequency():
    t = clock(3.0, 2000.0)
    rig = Rig(cells=20, friction_coefficient=1e-9)
    columns = run(rig=rig, mass_kg=5.0, motion=Motion(t, 0.1 * np.minimum(t / 0.01, 1.0)))
    swings = columns["x_out_mm"][400:] - columns["x_out_mm"][400:].mean()
    ups = np.flatnonzero((swings[:-1] < 0.0) & (swings[1:] >= 0.0))
    period = np.mean(np.diff(ups)) / 2000.0
    stiffness = rig.axial_stiffness / rig.sheath_length_mm + KL
    assert period == pytest.approx(2.0 * math.pi * math.sqrt(5e-3 / stiffness), rel=0.01)


def test_a_stop_adds_its_stiffness_from_its_place_on():
    columns = run(stop_at_mm=6.0, stop_N_per_mm=2.0)
    x = columns["x_out_mm"]
    expected = F0 + KL * x + 2.0 * np.maximum(x - 6.0, 0.0)
    np.testing.assert_allclose(columns["f_out_N"], expected, atol=1e-6)
    assert x.max() > 7.0


@pytest.mark.parametrize("load", ["force", "displacement"])
def test_a_load_end_needs_a_spring(load):
    with pytest.raises(ValueError, match="no load end"):
        simulate(
            Rig(load=load, load_end=LoadEnd(mass_kg=1.0)),
            Motion(np.arange(3.0), np.zeros(3)),
            distal=np.full(3, 25.0),
        )
