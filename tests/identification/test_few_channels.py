"""Few channels, and little or wrong things said of the rig: right numbers, or a sentence."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.identification.recorded import TRUE, VALUES
from tests.identification.test_odd_recordings import (
    CHANNELS,
    calibrated,
    fitted,
    is_right,
    ran,
    recorded,
)
from tsas_cli.support.errors import InputError
from tsas_studies.challenge.rig.recordings import DATA_SHEET
from tsas_studies.challenge.rig.sensors import PERFECT


@pytest.mark.parametrize(
    ("factor", "channels"), [(1.0 / 3.0, ("f_in_N",)), (3.0, CHANNELS), (3.0, ("f_in_N",))]
)
def test_a_wrong_data_sheet_does_not_lead_astray(factor, channels):
    columns = {n: v for n, v in recorded().items() if n in ("time_s", "x_in_mm", *channels)}
    run = ran(columns, preload_N=27.0 * factor)
    wrong = {
        key: factor * DATA_SHEET[key]
        for key in ("friction_coefficient", "load_stiffness_N_per_mm", "tendon_modulus_GPa")
    }
    is_right(calibrated(run, **wrong), part=0.02)


def test_positions_alone_and_a_tendon_that_is_known():
    """What nobody states is fitted from far off: neither friction nor preload is the default."""
    exact = recorded(sensors=replace(PERFECT, rate_Hz=200.0))
    columns = {n: v for n, v in exact.items() if not n.endswith("_N")}
    result = calibrated(
        ran(columns, preload_N=None), friction_coefficient=None, load_stiffness_N_per_mm=None
    )
    estimates = fitted(result)
    for name, value in VALUES.items():
        if name != "tendon_stiffness_N":
            assert estimates[name].value == pytest.approx(value, rel=1e-3), name
    assert "tendon_stiffness_N" not in estimates
    assert any(s.startswith("Without a force sensor all forces") for s in result.cannot_tell)


@pytest.mark.parametrize("far_mm", [0.0, 60.0])
def test_positions_alone_and_a_preload_that_is_known(far_mm):
    """The preload is the scale of all forces then; encoders may be far from their zeros."""
    exact = recorded(sensors=replace(PERFECT, rate_Hz=200.0))
    moved = {n: v + far_mm for n, v in exact.items() if n.endswith("_mm")}
    names = ("friction_coefficient", "load_stiffness_N_per_mm", "tendon_modulus_GPa")
    columns = moved | {"time_s": exact["time_s"]}
    result = calibrated(ran(columns), **dict.fromkeys((*names, "tendon_diameter_mm")))
    estimates = fitted(result)
    for name, value in VALUES.items():
        if name != "preload_N":
            assert estimates[name].value == pytest.approx(value, rel=2e-3), name
    assert "preload_N" not in estimates
    assert estimates["x_in_zero_mm"].value == pytest.approx(far_mm, abs=0.01)


def test_a_force_sensor_at_the_load_alone_shows_the_friction_that_nobody_states():
    columns = {n: v for n, v in recorded().items() if n != "f_in_N"}
    result = calibrated(ran(columns, preload_N=None), friction_coefficient=None)
    is_right(result, part=0.03)


def test_nothing_but_the_columns():
    """No rig, no conditions: friction stands for μθ, and the stiffness for that of a metre."""
    run = ran(recorded(), sheath_length_mm=None, total_bend_rad=None, preload_N=None, load="spring")
    result = calibrated(run, **dict.fromkeys(DATA_SHEET))
    product = {
        "friction_coefficient": 0.135 * math.pi,
        "load_stiffness_N_per_mm": 1.45,
        "preload_N": 27.0,
        "tendon_stiffness_N": TRUE.axial_stiffness * 1000.0 / TRUE.sheath_length_mm,
    }
    is_right(result, values=product)
    assert any("product of friction and bend" in s for s in result.cannot_tell)


def test_a_straight_sheath_with_friction_is_told_to_be_wrong():
    """Friction does not act in a straight sheath; the data sheet's value stays, and it shows."""
    result = calibrated(ran(recorded(), total_bend_rad=0.0))
    friction = next(e for e in result.model.estimates if e.name == "friction_coefficient")
    assert (friction.value, friction.origin) == (0.125, "data sheet")
    said = next(s for s in result.cannot_tell if "reduced chi-square" in s)
    assert " for f_in_N" in said


@pytest.mark.parametrize("off_mm", [0.0, -4.0, 7.0, 60.0])
@pytest.mark.parametrize(
    "channels",
    [("x_out_mm",), ("f_out_N",), ("f_in_N",), ("f_in_N", "x_out_mm"), ("f_out_N", "x_out_mm")],
)
def test_few_channels_and_zeros_anywhere_give_the_friction_all_the_same(channels, off_mm):
    """The data sheet's, at little more than a third of it, gives way to what the data show."""
    columns = {n: v for n, v in recorded().items() if n in ("time_s", "x_in_mm", *channels)}
    columns["x_in_mm"] = columns["x_in_mm"] + off_mm
    if "x_out_mm" in columns:
        columns["x_out_mm"] = columns["x_out_mm"] - 1.5 * off_mm
    result = calibrated(ran(columns), friction_coefficient=0.05)
    friction = fitted(result)["friction_coefficient"]
    assert friction.interval_low < 0.135 < friction.interval_high
    assert not any("chi-square" in sentence for sentence in result.cannot_tell)


@pytest.mark.parametrize(
    ("load", "names", "says"),
    [
        ("spring", ("x_in_mm", "motor_speed_rpm"), "nothing to compare a model with"),
        ("spring", ("x_out_mm",), "no column drives the tendon"),
        ("force", ("x_in_mm", "f_in_N"), "load = 'force' needs the column f_out_N"),
        ("displacement", ("x_in_mm", "f_in_N"), "load = 'displacement' needs the column x_out_mm"),
        ("force", ("f_in_N", "f_out_N", "x_out_mm"), "forces at both ends"),
    ],
)
def test_columns_that_do_not_suffice(load, names, says):
    columns = recorded()
    columns["motor_speed_rpm"] = np.sin(columns["time_s"])
    with pytest.raises(InputError, match=says):
        ran({name: columns[name] for name in ("time_s", *names)}, load=load)
