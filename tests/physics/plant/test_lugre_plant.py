"""The plant with a dynamic tendon: the slip chain's where that holds, a linear one exactly."""

import math

import numpy as np
from scipy.linalg import expm

from tests.both_ways import answers
from tests.physics.plant.open_loop import ACTUATOR, run
from tests.physics.references import GROUP_A, LOADED_BY_SPRING
from tsas_cli.physics.bristles import TONNES_PER_KG, Bristles
from tsas_cli.physics.lugre.start import lugre_laws, segments
from tsas_cli.physics.rig import with_values

STEP_S = 2e-3
TIME_S = np.arange(0.0, 2.0 * math.pi, STEP_S)
NESTED = 10.0 - 10.0 * np.cos(TIME_S) + 1.5 * np.sin(5.0 * TIME_S)
STIFF = GROUP_A._replace(bristles=Bristles(stiffness_N_per_mm=5e5))


def apart(rig, motor_mm=NESTED, **how):
    """Return the difference (rms) of each channel of the two tendons, over its range."""
    slip, _, _ = run(rig, motor_mm, STEP_S, lumped=False, **how)
    lugre, _, unsettled = run(rig, motor_mm, STEP_S, lumped=True, **how)
    assert unsettled == 0
    return {
        name: np.sqrt(np.mean((slip[name] - lugre[name]) ** 2)) / np.ptp(slip[name])
        for name in slip
    }


def test_a_rig_that_changes_during_the_run():
    values = {"friction_coefficient": 0.16, "proximal_spring.stiffness_N_per_mm": 2.0}
    change = {"later": with_values(STIFF, values), "at": 1500}
    assert max(apart(STIFF, **change).values()) < 5e-4
    before, _, _ = run(STIFF, NESTED, STEP_S, lumped=True)
    after, _, _ = run(STIFF, NESTED, STEP_S, lumped=True, **change)
    differs = np.abs(before["f_in_N"] - after["f_in_N"]) > 0.0
    assert np.argmax(differs) == 1501


def linear(rig, actuator, n, speed_mm_s, step_s, samples):
    """Return x_in, x_out, f_in, f_out of a rig without friction whose motor sets off, exactly."""
    k, c = segments(rig, n)
    law, nodes = lugre_laws(rig, n, LOADED_BY_SPRING), n + 2
    load_mass = TONNES_PER_KG * rig.effects.load_inertia.mass_kg
    mass = np.array([actuator.inertia_N_s2_per_mm, *[law.lump.mass] * n, load_mass])
    spring, damper = np.zeros((nodes, nodes)), np.zeros((nodes, nodes))
    for matrix, values in ((spring, k), (damper, c)):
        for j, value in enumerate(values):
            matrix[j : j + 2, j : j + 2] += value * np.array([[1.0, -1.0], [-1.0, 1.0]])
    spring[0, 0] += actuator.stiffness_N_per_mm
    damper[0, 0] += actuator.damping_N_s_per_mm
    spring[-1, -1] += rig.load_stiffness_N_per_mm
    motor, v = 2 * nodes, slice(nodes, 2 * nodes)
    slope = np.zeros((motor + 2, motor + 2))
    slope[:nodes, v] = np.eye(nodes)
    slope[v, :nodes], slope[v, v] = -spring / mass[:, None], -damper / mass[:, None]
    slope[nodes, motor] = actuator.stiffness_N_per_mm / mass[0]
    slope[motor, motor + 1] = 1.0
    forward, state = expm(slope * step_s), np.zeros(motor + 2)
    state[-1] = speed_mm_s
    rows = []
    for _ in range(samples):
        x, v_now = state[:nodes], state[v]
        pull = rig.preload_N - k * np.diff(x) - c * np.diff(v_now)
        rows.append((x[0], x[-1], pull[0], pull[-1]))
        state = forward @ state
    return dict(zip(("x_in_mm", "x_out_mm", "f_in_N", "f_out_N"), np.array(rows).T, strict=True))


def test_without_friction_it_is_the_linear_rig_to_second_order():
    heavy = Bristles(tendon_mass_kg_per_m=25.0, tendon_damping_N_s_per_mm=0.02)
    rig = GROUP_A._replace(friction_coefficient=0.0, bristles=heavy)
    rig = with_values(rig, {"load_inertia.mass_kg": 0.5})
    actuator = ACTUATOR._replace(motor_lag_s=0.0, damping_N_s_per_mm=0.02)
    time_s = np.arange(300) * 1e-3
    exact = linear(rig, actuator, 6, 20.0, 1e-3, time_s.size)
    off = []
    for substeps in (32, 64, 128):  # with fewer, steps are cut
        how = {"n": 6, "actuator": actuator, "substeps": substeps}
        found, _, unsettled = run(rig, 20.0 * time_s, 1e-3, lumped=True, **how)
        assert unsettled == 0
        errors = {c: np.max(np.abs(found[c] - exact[c])) / np.ptp(exact[c]) for c in exact}
        assert max(errors.values()) < 1e-4
        off.append(max(errors["x_in_mm"], errors["x_out_mm"]))
    assert off[1] < off[0] / 3.5
    assert off[2] < off[1] / 3.5


def test_shorter_steps_come_closer_with_friction():
    exact, _, _ = run(STIFF, NESTED, STEP_S, lumped=True, substeps=64)
    off = []
    for substeps in (1, 4, 16):
        found, _, _ = run(STIFF, NESTED, STEP_S, lumped=True, substeps=substeps)
        off.append(np.max(np.abs(found["x_in_mm"] - exact["x_in_mm"])))
    assert off[0] < 1e-2
    assert off[1] < off[0] / 2.0
    assert off[2] < off[1] / 2.0


def test_a_rig_left_alone_rings_down_and_rests():
    jerk = np.full(1500, 8.0)
    jerk[:400], jerk[400:420] = np.linspace(0.0, 8.0, 400), 7.0
    lugre, _, unsettled = run(GROUP_A, jerk, 1e-3, lumped=True)
    assert unsettled == 0
    rings = lugre["x_in_mm"][422:]
    swings = [np.ptp(rings[i : i + 50]) for i in range(0, 1000, 50)]
    assert swings[0] > 0.01
    assert swings[1] < 0.05 * swings[0]
    assert swings[2] < 0.05 * swings[1]
    assert max(swings[10:]) < 1e-6


PROGRAM = """
import json
import sys
import numpy as np
from tests.physics.plant.open_loop import run
from tests.physics.references import TABLE_1
from tsas_cli.physics.rig import with_values

values = {"backlash.play_mm": 0.02, "drive_friction.friction_N": 1.0}
rig, way = with_values(TABLE_1, values), 0.3 * np.sin(np.arange(60) / 10.0)
far = np.concatenate((way, np.linspace(0.0, -40.0, 60), np.linspace(-40.0, 0.0, 60)))
channels, speed, unsettled = run(rig, far, 1e-2, lumped=True, n=5)
print(json.dumps(["numba" in sys.modules, [c.tolist() for c in channels.values()]]))
"""


def test_compiled_is_plain_python_to_rounding():
    plain, compiled = answers(PROGRAM, plain=True), answers(PROGRAM, plain=False)
    assert min(plain[3]) == 0.0
    for ours, theirs in zip(plain, compiled, strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=1e-6, atol=1e-6)
