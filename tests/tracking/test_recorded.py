"""What a recording of the closed loop holds: readings, not truths."""

import numpy as np
import pytest

from tests.tracking.runs import loop_of, run, settings_of
from tsas_cli.controllers.closed_loop import F_IN, F_OUT, X_IN, X_OUT
from tsas_cli.physics.rig import with_values
from tsas_cli.stages.track import track
from tsas_cli.support.errors import InputError
from tsas_cli.tracking.recorded import table_of

TABLES = {"sensor": {"rate_Hz": 500.0, "noise_mm": 0.02, "step_mm": 0.0, "force_noise_N": 0.3}}


def columns_of(rig=None, seed=3):
    """Return the run and its recording's columns."""
    settings = settings_of(**TABLES)
    _, path, _, plant = loop_of(settings)
    one = run(seed=seed, **TABLES)
    name = "disturbance-observer"
    table = table_of(one, path, rig or plant.rig, name, seed, settings)
    return one, {n: table.column(n).to_numpy() for n in table.column_names}


def noises():
    """Return what each channel shows beside the truth."""
    one, column = columns_of()
    truths = {"x_in_mm": X_IN, "x_out_mm": X_OUT, "f_in_N": F_IN, "f_out_N": F_OUT}
    return {name: column[name] - one.columns[row] for name, row in truths.items()}


def test_every_channel_has_its_noise_and_no_two_the_same():
    found = noises()
    sd = {name: float(np.std(noise)) for name, noise in found.items()}
    expected = {"x_in_mm": 0.02, "x_out_mm": 0.02, "f_in_N": 0.3, "f_out_N": 0.3}
    assert sd == pytest.approx(expected, rel=0.1)
    alike = np.corrcoef(list(found.values())) - np.eye(4)
    assert np.abs(alike).max() < 0.15


def test_what_no_dataset_may_hold_is_refused():
    """A mean of 100 MN winds up kilometres, which no other stage reads."""
    with pytest.raises(InputError, match=r"x_in_mm goes to 6.* at most 1e\+06 mm, as in every rec"):
        track(settings={"reference": {"mean_N": 1e8, "duration_s": 1.0}})


def test_sensors_with_errors_show_them():
    _, _, _, plant = loop_of(settings_of(**TABLES))
    values = {"force_sensor_gain.f_out_gain": 1.1, "force_sensor_offset.f_in_offset_N": 2.0}
    rig = with_values(plant.rig, values | {"position_sensor_gain.x_out_gain": 0.9})
    _, true = columns_of()
    _, column = columns_of(rig)
    np.testing.assert_allclose(column["f_out_N"] - true["f_out_N"], 0.1 * true["f_out_true_N"])
    np.testing.assert_allclose(column["f_in_N"] - true["f_in_N"], 2.0)
    assert np.ptp(column["x_out_mm"]) == pytest.approx(0.9 * np.ptp(true["x_out_mm"]), rel=0.01)
    np.testing.assert_array_equal(column["f_out_true_N"], true["f_out_true_N"])


def test_another_seed_is_other_noise():
    assert np.abs(columns_of(seed=3)[1]["f_out_N"] - columns_of(seed=4)[1]["f_out_N"]).max() > 0.1
