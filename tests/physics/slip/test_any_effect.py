"""Any effects together, on any rig, motion and load: samples settle, and are told where not."""

import math

import numpy as np
import pytest

from tests.physics.references import branches, slip_chain
from tests.physics.test_any_rig import any_motion, any_rig, blocks
from tsas_cli.physics.ends import DriveInput, ends_of
from tsas_cli.physics.phases import UNCONVERGED
from tsas_cli.physics.rig import with_values

SEEDS = range(300)
MOST_UNSETTLED = 1e-4  # of the samples; with friction alone it is none (test_any_rig)
NODES = (1, 2, 20)


def any_effects(rng, rig, x_in, x_out):
    """Some of the effects, of sizes from next to nothing to the rig's own, as far as they act here.

    The load spring keeps rising, and friction varies with the tension by a power of up to 0.3.
    """

    def between(low, high):
        return float(np.exp(rng.uniform(math.log(low), math.log(high))))

    def sign():
        return float(rng.choice([-1.0, 1.0]))

    stroke, moved, F0 = np.ptp(x_in), np.abs(x_out).max() + 1e-9, rig.preload_N
    period = moved * between(0.3, 10.0)
    values = {
        "backlash.play_mm": stroke * between(1e-3, 0.3),
        "drive_friction.friction_N": F0 * between(1e-3, 1.0),
        "drive_ripple.sine_mm": stroke * between(1e-4, 1e-2),
        "drive_compliance.compliance_mm_per_N": (
            rig.sheath_length_mm / rig.tendon_stiffness_N * between(1e-2, 10.0)
        ),
        "proximal_spring.stiffness_N_per_mm": rig.load_stiffness_N_per_mm * between(1e-2, 10.0),
        "sheath_compression.compliance_ratio": between(1e-2, 10.0),
        "direction_dependent_friction.asymmetry": rng.uniform(-0.9, 0.9),
        "stribeck_friction.excess": between(1e-2, 3.0),
        "stribeck_friction.velocity_mm_per_s": stroke * between(1e-3, 10.0),
        "viscous_friction.coefficient_N_s_per_mm": F0 / stroke * between(1e-3, 0.3),
        "load_dependent_friction.exponent": rng.uniform(-0.3, 0.3),
        "presliding.length_mm": stroke * between(1e-6, 0.3),
        "bend_drift.rate_rad_per_s": rig.total_bend_rad * sign() * between(1e-3, 0.3),
        "friction_drift.rate_per_s": sign() * between(1e-3, 0.3),
        "preload_loss.rate_N_per_s": F0 * between(1e-3, 0.1),
        "load_spring_nonlinearity.quadratic_per_mm": sign() * between(1e-3, 0.1) / moved,
        "load_spring_nonlinearity.cubic_per_mm2": between(1e-2, 0.3) / moved**2,
        "load_friction.after_sensor_N": F0 * between(1e-3, 0.5),
        "load_friction.before_sensor_N": F0 * between(1e-3, 0.5),
        "load_inertia.mass_kg": rig.load_stiffness_N_per_mm * between(1e-2, 1e2),
        "drive_damping.coefficient_N_s_per_mm": F0 / stroke * between(1e-3, 0.3),
        "drive_inertia.mass_kg": rig.load_stiffness_N_per_mm * between(1e-2, 1e2),
        "position_dependent_friction.slope_per_mm": rng.uniform(-0.5, 0.5) / stroke,
        "uneven_friction.slope": rng.uniform(-1.9, 1.9),
        "pulley_friction.drive_loss": between(1e-3, 0.5),
        "pulley_friction.load_loss": between(1e-3, 0.5),
        "load_ripple.sine_mm": period * between(1e-3, 0.1),
        "load_ripple.period_mm": period,
        "load_damping.coefficient_N_s_per_mm": F0 / stroke * between(1e-3, 0.3),
        "load_hysteresis.force_N": F0 * between(1e-3, 0.5),
        "load_hysteresis.travel_mm": moved * between(1e-2, 1.0),
        "load_relaxation.share": between(1e-2, 3.0),
        "load_relaxation.time_s": between(1e-2, 10.0),
        "force_sensor_hysteresis.f_out_share": between(1e-2, 0.3),
        "sensor_lag.f_in_lag_s": between(1e-3, 0.3),
        "sheath_drag.force_N": F0 * between(1e-3, 0.5),
    }
    effects = sorted({name.partition(".")[0] for name in values})
    chosen = rng.choice(effects, rng.integers(1, len(effects) + 1), replace=False)
    return {name: v for name, v in values.items() if name.partition(".")[0] in chosen}


def every_load(rng, x_in, f_in, f_out, x_out, preload):
    """Loads near what the spring does, a pair of tendons that pushes, and a drive by force."""
    time_s = np.linspace(0.0, 5.0, x_in.size)
    near = np.interp(time_s, np.arange(6), rng.normal(1.0, 0.2, 6))
    yield "spring", DriveInput(x_in, time_s=time_s)
    yield "force", DriveInput(x_in, load="force", load_values=near * f_out, time_s=time_s)
    pushing = near * f_out - 1.5 * preload
    yield "push-pull", DriveInput(x_in, load="force", load_values=pushing, time_s=time_s)
    yield (
        "displacement",
        DriveInput(x_in, load="displacement", load_values=near * x_out, time_s=time_s),
    )
    yield "drive by force", DriveInput(near * f_in + 0.02 * preload, kind="force", time_s=time_s)


@pytest.mark.parametrize("samples", [16, 60, 300])
@pytest.mark.parametrize("seeds", blocks(SEEDS, 100))
def test_samples_settle(seeds, samples):
    count, unsettled = 0, 0
    for seed in seeds:
        rng = np.random.default_rng(seed)
        nominal = any_rig(rng)
        x_in = any_motion(rng, nominal, samples)
        f_in, f_out, _ = branches(x_in, nominal)
        x_out = (f_out - nominal.preload_N) / nominal.load_stiffness_N_per_mm
        rig = with_values(nominal, any_effects(rng, nominal, x_in, x_out))
        for load, drive in every_load(rng, x_in, f_in, f_out, x_out, nominal.preload_N):
            ends = ends_of(rig, drive)
            answer = slip_chain(ends.course, rig, ends.boundary, NODES[seed % len(NODES)])
            where = f"seed {seed}, {load}, {rig}"
            assert np.isfinite(answer[:4]).all(), where
            count += answer[4].size
            unsettled += np.count_nonzero(answer[4] == UNCONVERGED)
    assert unsettled <= MOST_UNSETTLED * count
