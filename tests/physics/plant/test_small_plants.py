"""Plant, lumped plant and inverse with three nodes: each against another way to the same."""

import numpy as np
import pytest

from tests.physics.plant.open_loop import ACTUATOR, run
from tests.physics.references import GROUP_A
from tsas_cli.effects import EFFECTS
from tsas_cli.physics.bristles import Bristles
from tsas_cli.physics.ends import DriveInput, losses_over
from tsas_cli.physics.response import simulate
from tsas_cli.physics.rig import with_values
from tsas_cli.physics.slip.inverse import inverse_chain

N = 3
STEP_S = 0.02
TIME_S = STEP_S * np.arange(40)
WAY = 2.0 - 2.0 * np.cos(np.pi * TIME_S / 0.4)
AWAY = 10.0 * np.cos(2.0 * np.pi * TIME_S / TIME_S[-1]) - 10.0
STIFF = GROUP_A._replace(bristles=Bristles(stiffness_N_per_mm=2e5))
DAMPED = ACTUATOR._replace(damping_N_s_per_mm=1.0)
# What changes with time is so much larger that it shows within a second.
LARGER = {"viscous_friction": 10.0, "bend_drift": 10.0, "friction_drift": 10.0}
STARTS = {
    e.name: {
        f"{e.name}.{p.name}": min(LARGER.get(e.name, 1.0) * p.start, p.upper) for p in e.parameters
    }
    for e in EFFECTS
    if e.acts_on != "sensor" and e.name != "antagonist"  # plants have one tendon
}
# Their own frequency or their own instability shows where the slip chain has neither.
DYNAMIC = {"drive_inertia", "load_inertia", "stribeck_friction"}


def both(values, way, substeps):
    """Return the channels of both plants, and how many steps of the lumped one did not settle."""
    how = {"n": N, "substeps": substeps, "actuator": DAMPED}
    rig = with_values(STIFF, values)
    lumped, _, unsettled = run(rig, way, STEP_S, lumped=True, **how)
    return run(rig, way, STEP_S, lumped=False, **how)[0], lumped, unsettled


def off(channels, others):
    """Return the difference (rms, largest) of the channel that is farthest off, over its range."""
    apart = [np.abs(others[name] - values) / np.ptp(values) for name, values in channels.items()]
    return max(np.sqrt(np.mean(each**2)) for each in apart), max(map(np.max, apart))


@pytest.fixture(scope="module")
def plain():
    return both({}, WAY, 2)[1]


@pytest.mark.parametrize("name", sorted(STARTS.keys() - DYNAMIC))
def test_a_lumped_tendon_does_to_the_drive_what_the_slip_chain_does(name, plain):
    slip, lumped, unsettled = both(STARTS[name], WAY, 2)
    assert unsettled == 0
    assert off(slip, lumped)[0] < min(0.01, 0.1 * off(plain, lumped)[0])


AT_DRIVE = {
    "nothing": {},
    "play": {"backlash.play_mm": 0.3},
    "friction and spring": {
        "drive_friction.friction_N": 2.0,
        "proximal_spring.stiffness_N_per_mm": 4.0,
    },
    "preload loss": {"preload_loss.rate_N_per_s": 2.0},
    "a load that yields": {"load_hysteresis.force_N": 2.0},
}


@pytest.mark.parametrize("values", AT_DRIVE.values(), ids=AT_DRIVE.keys())
def test_a_tendon_that_is_slack_at_times_does_what_the_slip_chain_does(values):
    slip, lumped, unsettled = both(values, AWAY, 8)
    assert unsettled <= 1  # where it is caught
    mean, largest = off(slip, lumped)
    assert mean < 0.01
    assert largest < 0.1
    hangs = lumped["f_out_N"] < 1e-9
    assert np.any(hangs)
    assert not np.all(hangs)


# The path is that of the tendon's end, and has no speed or place to the inverse: none is given.
INVERTED = {"drive_compliance", *(e.name for e in EFFECTS if e.acts_on in ("tendon", "load"))}
INVERTED -= {"stribeck_friction", "position_dependent_friction", "antagonist"}
WANTED = np.array([25.0, 26.0, 31.0, 44.0, 43.9, 43.0, 43.4, 38.0, 30.0, 30.0, 21.0, 24.0])


def inverted(rig):
    """Return times, the path to the wanted force and the tension at the drive; none is missed."""
    time_s = STEP_S * np.arange(WANTED.size)
    friction = losses_over(time_s, *np.zeros((2, WANTED.size)), 0.0, rig)
    path, tension, missed = inverse_chain(WANTED, friction, STEP_S, rig, N)
    assert missed == 0
    return time_s, path, tension


@pytest.mark.parametrize("name", sorted(INVERTED))
def test_a_path_to_a_force_gives_that_force(name):
    rig = with_values(GROUP_A, STARTS[name])
    time_s, path, tension = inverted(rig)
    still = with_values(rig, {"viscous_friction.coefficient_N_s_per_mm": 0.0})
    there = simulate(still, DriveInput(path, time_s=time_s), nodes=N)
    np.testing.assert_allclose(there.f_out_N, WANTED, atol=1e-5)
    np.testing.assert_allclose(there.f_in_N, tension, atol=1e-4)
    moved = np.abs(path - inverted(GROUP_A)[1]).max()
    assert (moved > 1e-5) == (name != "viscous_friction")
    assert np.all(np.diff(path)[:3] > 0.0)


def test_the_path_rests_where_the_force_does():
    _, path, _ = inverted(GROUP_A)
    assert (path[0], path[9]) == (0.0, path[8])
