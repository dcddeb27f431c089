"""Whether sliding is stable is said before a run, and what the chain then does agrees."""

import math

import numpy as np
import pytest

from tests.physics.lugre.test_chain import SINE, TIME_S, follow
from tests.physics.references import TABLE_1
from tsas_cli.effects import Effects, StribeckFriction
from tsas_cli.physics.bristles import Bristles
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.lugre.chain import OWN_STEPS
from tsas_cli.physics.lugre.stability import Sliding, growth_rate, stability
from tsas_cli.physics.response import simulate
from tsas_cli.physics.rig import with_values

AS_PRINTED = TABLE_1._replace(bristles=Bristles(damping_N_s_per_mm=50 * 0.31622))
WRAP = math.pi / 8.0


def contraction(speed, f_out=40.0):
    """Full slip towards the drive; the load's spring winds up with the motion."""
    return Sliding(f_out * math.exp(WRAP), 2.29 * speed, speed, whole=True)


def test_as_printed_contraction_is_unstable_above_17_7_mm_per_s():
    """The limit that a study of the printed model found with other tools, at 40 N."""
    assert growth_rate(AS_PRINTED, contraction(17.0)) < -20.0
    assert growth_rate(AS_PRINTED, contraction(18.3)) > 20.0


def test_as_printed_the_bristles_chatter_in_every_dead_band_of_loosening():
    loosening = Sliding(60.0, -170.0, -1.0, whole=False)
    contracting = Sliding(25.0, 170.0, 1.0, whole=False)
    assert growth_rate(AS_PRINTED, loosening) > 1e5
    assert growth_rate(AS_PRINTED, contracting) < 0.0


@pytest.mark.parametrize("speed", [-20.0, -5.0, -0.5, 0.5, 5.0, 20.0])
def test_with_critical_bristles_sliding_is_stable(speed):
    for f_in in (15.0, 30.0, 80.0):
        for whole, stiffness in ((True, 2.0), (False, 175.0)):
            assert growth_rate(TABLE_1, Sliding(f_in, stiffness * speed, speed, whole)) < 0.0


def test_friction_that_falls_with_speed_is_unstable_where_it_falls():
    rig = TABLE_1._replace(effects=Effects(stribeck_friction=StribeckFriction(0.3, 5.0)))
    assert growth_rate(rig, contraction(3.0)) > 1e3
    assert growth_rate(rig, contraction(40.0)) < 0.0


def test_a_run_is_judged_by_its_least_stable_moment():
    slow, fast = np.arange(0.0, 2.0 * math.pi, 1e-3), np.arange(0.0, math.pi, 1e-3)
    for time_s, omega in ((slow, 1.0), (fast, 2.0)):
        x = 10.0 - 10.0 * np.cos(omega * time_s)
        quasi = simulate(TABLE_1, DriveInput(x, time_s=time_s))
        run = (time_s, x, quasi.f_in_N, quasi.phase)
        assert not stability(TABLE_1, *run).unstable
        found = stability(AS_PRINTED, *run)
        assert found.unstable
        assert found.moment.speed_mm_s < 0.0
        assert not found.moment.whole


def test_the_chain_chatters_where_it_is_said_to():
    """In the dead band of loosening, after the turn at 3142 ms, and only with steps short enough.

    Longer ones glide over it: that is why it has to be said.
    """

    def rough(rig, begin, end, steps):
        f_in = follow(SINE[:3400], TIME_S[:3400], rig=rig, steps=steps)[0][2]
        return np.max(np.abs(np.diff(f_in[begin:end], 3)))

    short = np.arange(1e-4, 3.4, 1e-4)
    assert rough(AS_PRINTED, 3250, 3350, short) > 0.1
    assert rough(TABLE_1, 3250, 3350, short) < 2e-3
    assert rough(AS_PRINTED, 2500, 3100, short) < 2e-3
    assert rough(AS_PRINTED, 3250, 3350, OWN_STEPS) < 0.03


def test_a_drive_that_never_moves_is_not_judged():
    still = np.zeros(100)
    assert stability(TABLE_1, TIME_S[:100], still, still + 25.0, still) is None


@pytest.mark.parametrize("smooth", [{"friction_coefficient": 0.0}, {"total_bend_rad": 0.0}])
def test_without_friction_nothing_is_judged_and_the_chain_answers(smooth):
    """Before, it ended with a text of LAPACK."""
    rig = TABLE_1._replace(**smooth)
    x, tension = SINE[:200], np.full(200, 25.0)
    assert stability(rig, TIME_S[:200], x, tension, np.ones(200)) is None
    drive = DriveInput(x, time_s=TIME_S[:200])
    slip, lugre = (simulate(rig, drive, dynamics) for dynamics in ("slip", "lugre"))
    assert lugre.f_in_N == pytest.approx(slip.f_in_N, rel=0.02)


FALLING = with_values(
    TABLE_1._replace(bristles=Bristles(tendon_damping_N_s_per_mm=0.0)),
    {"stribeck_friction.excess": 0.3, "stribeck_friction.velocity_mm_per_s": 5.0},
)
BAND = Sliding(30.0, 170.0, 3.0, whole=False)


@pytest.mark.parametrize(
    ("mass_kg", "kL", "alike", "moment"),
    [
        *((1e-7, 400.0, 400.0, contraction(3.0)), (1e6, 1.579, 1e9, contraction(3.0))),
        *((0.0, 400.0, 1.579, BAND), (2.0, 1.579, 1.579, BAND)),
    ],
    ids=["no mass", "any mass", "band on a spring", "band on a mass"],
)
def test_a_load_is_its_spring_or_a_wall_by_its_mass_and_none_in_a_dead_band(
    mass_kg, kL, alike, moment
):
    """Beyond the lumps that slide it is held by those that stick."""
    bent = {"load_spring_nonlinearity.quadratic_per_mm": 0.2}  # which is straight at rest
    heavy = with_values(FALLING, bent | {"load_inertia.mass_kg": mass_kg})
    growth = growth_rate(heavy._replace(load_stiffness_N_per_mm=kL), moment)
    without = growth_rate(FALLING._replace(load_stiffness_N_per_mm=alike), moment)
    assert growth == pytest.approx(without, rel=1e-3)
