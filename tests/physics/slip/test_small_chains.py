"""A slip chain of three nodes: after every sample each law holds, written down once more by hand.

Segments stretch by their compliance; a node that has moved towards the drive leaves e^(−a/n) of the
tension, one that has moved away takes as much, one that has not is in between; and both ends are in
balance with what is there.
"""

import math

import numpy as np
import pytest

from tests.physics.references import (
    DRIVEN_BY_FORCE,
    LOADED_BY_DISPLACEMENT,
    LOADED_BY_FORCE,
    LOADED_BY_SPRING,
    course_of,
    slip_chain,
)
from tests.physics.slip.laws_by_hand import (
    EFFECTS,
    ROUNDING,
    SPRINGY,
    UP_AND_DOWN,
    A,
    N,
    gives,
    hold_everywhere,
    states,
    varying,
)
from tsas_cli.effects import Effects
from tsas_cli.physics.rig import with_values
from tsas_cli.physics.slip.chain import rest_after


@pytest.mark.parametrize("name", EFFECTS)
def test_every_effect_at_a_spring(name):
    rig = with_values(SPRINGY, EFFECTS[name])
    drag = np.linspace(0.5, 1.5, UP_AND_DOWN.size)
    course = varying(UP_AND_DOWN, rig, drag=drag)
    ways = hold_everywhere(course, rig, LOADED_BY_SPRING)
    assert ways[1:3, 1:].min() > 0.05  # all nodes, and the load, are pulled, and later let go
    assert ways[10, 1:].max() < -0.05


@pytest.mark.parametrize("name", ["friction alone", "free tendon", "presliding"])
@pytest.mark.parametrize("pushes", [False, True])
def test_a_force_at_the_load(name, pushes):
    """Where it pushes, the net tension of a pair of tendons is negative all along."""
    rig = with_values(SPRINGY, EFFECTS[name] | {"load_friction.before_sensor_N": 1.5})
    load = 25.0 + 3.0 * np.sin(np.arange(12.0))
    if pushes:
        load -= 60.0
    drive = 0.9 * UP_AND_DOWN - (1.6 if pushes else 0.0)
    course = course_of(drive, rig, load=load, released=0.8 * A)
    ways = hold_everywhere(course, rig, LOADED_BY_FORCE)
    assert ways.min() < -0.1
    assert ways[1:].max() > 0.1
    f_in, f_out = slip_chain(course, rig, LOADED_BY_FORCE, N)[2:4]
    np.testing.assert_array_equal(f_out, load)
    assert (f_in[2:].max() < 0.0) == pushes


@pytest.mark.parametrize("name", ["friction alone", "presliding"])
def test_a_place_at_the_load(name):
    """The sensor at the load does not feel the friction that is before it."""
    rig = with_values(SPRINGY, EFFECTS[name] | {"load_friction.before_sensor_N": 1.5})
    load = 0.3 * np.array([0.0, 0.5, 1.0, 1.0, 1.2, 0.9, 0.9, 1.0, 0.2, 0.2, 0.1, 0.3])
    course = course_of(UP_AND_DOWN, rig, load=load, pulled=1.2 * A)
    hold_everywhere(course, rig, LOADED_BY_DISPLACEMENT)
    f_out = slip_chain(course, rig, LOADED_BY_DISPLACEMENT, N)[3]
    way, felt = 0.0, []
    for moved in np.diff(load, prepend=0.0):
        way = math.copysign(1.0, moved) if moved else way
        felt.append(1.5 * way)
    tensions = [T[-1] for _, T in states(course, rig, LOADED_BY_DISPLACEMENT)]
    np.testing.assert_allclose(tensions - f_out, felt, atol=ROUNDING)


@pytest.mark.parametrize("name", ["friction alone", "presliding"])
def test_a_force_at_the_drive(name):
    """Its friction and a spring beside the tendon take their part of the force."""
    beside = {"drive_friction.friction_N": 2.0, "proximal_spring.stiffness_N_per_mm": 4.0}
    rig = with_values(SPRINGY, EFFECTS[name] | beside)
    drive = 25.0 + np.append(25.0 * UP_AND_DOWN[:-1], -20.0)
    ways = hold_everywhere(course_of(drive, rig, pulled=1.2 * A), rig, DRIVEN_BY_FORCE)
    assert ways[1:3].min() > 0.02
    assert ways[-1].max() < -0.05


def test_a_slack_tendon_waits_where_its_spring_leaves_it():
    """The load rests where the spring has let the preload go; the next pull is that of a new run.

    A straight spring rests at −F0/kL; the tendon is shorter by what the preload had stretched.
    """
    rig = SPRINGY._replace(effects=Effects())
    slack_below = -rig.preload_N * (1.0 / 30.0 + 300.0 / 5e3)
    drive = np.array([0.5, slack_below - 0.3, slack_below - 0.01, slack_below + 0.2])
    x_in, x_out, f_in, f_out, phase = slip_chain(course_of(drive, rig), rig, LOADED_BY_SPRING, N)
    np.testing.assert_array_equal(x_in[[0, 3]], drive[[0, 3]])
    assert phase.tolist() == [1, 2, 2, 1]
    assert f_in[1:3].tolist() == f_out[1:3].tolist() == [0.0, 0.0]
    np.testing.assert_allclose(x_out[1:3], -rig.preload_N / 30.0)
    places, tensions = rest_after(course_of(drive[:2], rig), rig, LOADED_BY_SPRING, N)
    np.testing.assert_allclose(np.diff(places[1:]), gives(rig)[1:] * rig.preload_N)  # straight
    assert not tensions[:-1].any()
    # From no tension, all of it slips: F_out over the spring, F_in's mean over the sheath.
    share = A / N
    passed = math.exp(-share) ** np.arange(N + 1.0)
    stiffness = 1.0 / (passed[-1] / 30.0 + np.sum(gives(rig) * passed))
    assert f_in[3] == pytest.approx(stiffness * 0.2, rel=1e-9)
    assert f_out[3] == pytest.approx(f_in[3] * math.exp(-A), rel=1e-9)
