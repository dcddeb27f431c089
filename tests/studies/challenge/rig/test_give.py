import math

import numpy as np
import pytest

from tsas_studies.challenge.rig.give import Give, Path, given
from tsas_studies.challenge.rig.motions import through
from tsas_studies.challenge.rig.tendon import Rig, simulate


def test_a_loose_clamp_jumps_when_pulled_hard_and_comes_back_late():
    state, jumps = Path(Give(clamp_step_mm=0.3, clamp_up_N=50.0, clamp_down_N=30.0)), []
    for tension in (40.0, 51.0, 40.0, 31.0, 29.0, 40.0):
        state = given(state, tension, 25.0, 0.01)
        jumps.append(state.jumped)
    assert jumps == [0.0, 0.3, 0.3, 0.3, 0.0, 0.0]


def test_creep_comes_to_its_end_exponentially():
    state = Path(Give(creep_mm_per_N=0.01, creep_time_s=2.0))
    for _ in range(300):
        state = given(state, 45.0, 25.0, 0.01)
    assert state.crept == pytest.approx(0.2 * (1.0 - math.exp(-1.5)))


def test_what_the_clamp_gives_is_lost_to_the_tendon():
    """In full slip a lost displacement costs the slope of contraction, 2.287 N/mm."""
    motion = through([10.0], rate_Hz=200.0)
    firm = simulate(Rig(cells=100), motion).columns
    loose = simulate(Rig(cells=100, give=Give(clamp_step_mm=0.2, clamp_up_N=40.0)), motion).columns
    lost = firm["f_in_N"] - loose["f_in_N"]
    before = firm["f_in_N"] < 40.0
    np.testing.assert_array_equal(lost[before], 0.0)
    assert lost[-1] == pytest.approx(2.287 * 0.2, rel=1e-3)


def test_creep_that_has_settled_is_a_compliance_in_series():
    motion = through([10.0], rate_Hz=200.0)
    give = Give(creep_mm_per_N=0.01, creep_time_s=0.05)
    soft = simulate(Rig(cells=60, give=give), motion).columns["f_in_N"]
    length = 0.01 * Rig().axial_stiffness
    free = simulate(Rig(cells=60, proximal_length_mm=length), motion).columns["f_in_N"]
    assert soft[-1] == pytest.approx(free[-1], abs=0.03)
