"""Plant, lumped plant and inverse with three nodes: each against another way to the same."""

import numpy as np
import pytest

from tests.physics.plant.open_loop import ACTUATOR, run
from tests.physics.references import GROUP_A
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
AT_DRIVE = {
    "nothing": {},
    "play": {"backlash.play_mm": 0.3},
    "ripple": {
        "drive_ripple.sine_mm": 0.01,
        "drive_ripple.cosine_mm": 0.006,
        "drive_ripple.period_mm": 0.9,
    },
    "friction": {"drive_friction.friction_N": 2.0},
    "spring": {"proximal_spring.stiffness_N_per_mm": 4.0},
    "damper": {"drive_damping.coefficient_N_s_per_mm": 0.05},
    "place": {"position_dependent_friction.slope_per_mm": 0.05},
    "damped load": {"load_damping.coefficient_N_s_per_mm": 0.02},
    "yielding load": {"load_hysteresis.force_N": 2.0},
    "relaxing load": {"load_relaxation.share": 0.3, "load_relaxation.time_s": 0.2},
    "pulley": {"load_ripple.sine_mm": 0.2},
    "guide": {"load_friction.before_sensor_N": 1.0, "load_friction.after_sensor_N": 0.5},
    "bend drift": {"bend_drift.rate_rad_per_s": 0.4},
    "preload loss": {"preload_loss.rate_N_per_s": 2.0},
}


RETURNS_BY_ITSELF = {"load_damping", "load_relaxation"}


@pytest.mark.parametrize("values", AT_DRIVE.values(), ids=AT_DRIVE.keys())
@pytest.mark.parametrize("way", [WAY, AWAY], ids=["taut", "slack at times"])
def test_a_lumped_tendon_does_to_the_drive_what_the_slip_chain_does(values, way):
    if way is AWAY and {name.partition(".")[0] for name in values} & RETURNS_BY_ITSELF:
        pytest.skip("how the load of a slack tendon returns is not modelled")
    rig = with_values(STIFF, values)
    how = {"n": N, "substeps": 8 if way is AWAY else 2, "actuator": DAMPED}
    slip, _, _ = run(rig, way, STEP_S, lumped=False, **how)
    lumped, _, unsettled = run(rig, way, STEP_S, lumped=True, **how)
    assert unsettled <= (way is AWAY)  # where it is caught
    for name, values in slip.items():
        off = np.abs(values - lumped[name]) / np.ptp(values)
        assert np.sqrt(np.mean(off**2)) < 0.01, name
        assert np.max(off) < (0.1 if way is AWAY else 0.01), name
    hangs = lumped["f_out_N"] < 1e-9
    assert np.any(hangs) == (way.min() < 0.0)
    assert not np.all(hangs)


INVERTED = {
    "nothing": {},
    "free tendon": {"free_tendon.proximal_length_mm": 152.0, "free_tendon.distal_length_mm": 61.0},
    "presliding": {"presliding.length_mm": 0.05},
    "load-dependent friction": {"load_dependent_friction.exponent": -0.2},
    "bent spring": {"load_spring_nonlinearity.quadratic_per_mm": 0.03},
    "guide": {"load_friction.before_sensor_N": 2.0, "load_friction.after_sensor_N": 1.0},
    "drifts": {
        "bend_drift.rate_rad_per_s": 0.4,
        "friction_drift.rate_per_s": 0.2,
        "preload_loss.rate_N_per_s": 2.0,
    },
    "mass": {"load_inertia.mass_kg": 2.0},
    "viscous": {"viscous_friction.coefficient_N_s_per_mm": 0.05},
    "uneven friction": {"uneven_friction.slope": 1.5},
    "damped load": {"load_damping.coefficient_N_s_per_mm": 0.05},
    "yielding load": {"load_hysteresis.force_N": 2.0},
    "relaxing load": {"load_relaxation.share": 0.3, "load_relaxation.time_s": 0.2},
    "pulley": {"load_ripple.sine_mm": 0.2},
}
WANTED = np.array([25.0, 26.0, 31.0, 44.0, 43.9, 43.0, 43.4, 38.0, 30.0, 30.0, 21.0, 24.0])


@pytest.mark.parametrize("values", INVERTED.values(), ids=INVERTED.keys())
def test_a_path_to_a_force_gives_that_force(values):
    rig, time_s = with_values(GROUP_A, values), STEP_S * np.arange(WANTED.size)
    friction = losses_over(time_s, *np.zeros((2, WANTED.size)), 0.0, rig)
    path, tension, missed = inverse_chain(WANTED, friction, STEP_S, rig, N)
    assert missed == 0
    # As fast as it is, the path has no speed to the inverse: none is given to it.
    still = with_values(rig, {"viscous_friction.coefficient_N_s_per_mm": 0.0})
    there = simulate(still, DriveInput(path, time_s=time_s), on_mesh=True, nodes=N)
    np.testing.assert_allclose(there.f_out_N, WANTED, atol=1e-5)
    np.testing.assert_allclose(there.f_in_N, tension, atol=1e-4)
    assert path[9] == path[8] or "drifts" in str(values) or rig != GROUP_A
    assert np.all(np.diff(path)[:3] > 0.0)
