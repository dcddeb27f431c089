"""What a described model is worth in the loop: its laws act in the plant and are known ahead."""

import numpy as np
import pytest

from tests.tracking.runs import loop_of, settings_of
from tsas_cli.controllers.closed_loop import F_IN, X_OUT
from tsas_cli.effects.laws.load_law import load_law_motion
from tsas_cli.physics.rig import with_values
from tsas_cli.tracking.recorded import table_of
from tsas_cli.tracking.track import Known, Plant, plan, run_loop

RANGES = {"travel_mm": 3.0, "low_mm": 0.0, "high_mm": 25.0, "fast_mm_per_s": 50.0}
LAWS = {
    "drive": {"drive_law": RANGES | {"friction_1_N": 4.0, "friction_3_N": 2.0, "curve_4_N": 3.0}},
    "tendon": {"tendon_law": RANGES | {"start_1": 0.5, "curve_4": 0.4, "speed_3": -0.1}},
}
SILENT = {"sensor": {"rate_Hz": 500.0, "noise_mm": 0.0, "step_mm": 0.0, "force_noise_N": 0.0}}


def described(rig, laws):
    return with_values(rig, {f"{law}.{n}": v for law, own in laws.items() for n, v in own.items()})


@pytest.mark.parametrize("laws", LAWS.values(), ids=LAWS.keys())
def test_a_feedforward_that_knows_the_law_removes_what_it_does_to_the_force(laws):
    """What the controller leaves on the same rig without the law is none of the law's."""
    settings = settings_of()
    wanted, _, _, plant = loop_of(settings)
    real = Plant(described(plant.rig, laws), plant.actuator)

    def error(rig, on):
        known = Known(rig, plant.actuator)
        path = plan(wanted, known, settings)
        return run_loop(wanted, path, known, on, "pid", settings, seed=1).score.rmse_N

    ideal = error(plant.rig, plant)
    nominal, extended = error(plant.rig, real), error(real.rig, real)
    assert nominal > 3.0 * ideal
    assert extended - ideal < 0.12 * (nominal - ideal)


def test_a_recording_has_each_law_once():
    settings = settings_of(**SILENT)
    wanted, path, known, plant = loop_of(settings)
    load = {"travel_mm": 1.0, "lost_1_mm": 0.2}
    rig = described(plant.rig, LAWS["drive"] | {"load_law": load})
    one = run_loop(wanted, path, known, Plant(rig, plant.actuator), "pid", settings, seed=1)
    table = table_of(one, path, rig, "pid", 1, settings)
    np.testing.assert_array_equal(table["f_in_N"], one.columns[F_IN])
    x = one.columns[X_OUT]
    lost = load_law_motion(rig.effects.load_law, x, x, np.full(11, np.nan))
    np.testing.assert_allclose(table["x_out_mm"], x + lost)
    assert np.ptp(lost) > 0.2
