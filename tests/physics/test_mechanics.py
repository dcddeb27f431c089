"""What the sensors read changes nothing of what the rig does: one solution serves them all."""

import re
from dataclasses import replace

import numpy as np
import pytest

from tests.physics.references import GROUP_A
from tsas_cli.effects import EFFECTS
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.mechanics import mechanics_of
from tsas_cli.physics.response import read, simulate, solve
from tsas_cli.physics.rig import with_values

X_IN = np.interp(np.linspace(0, 4, 200), np.arange(5), [0.0, 14.0, 3.0, 9.0, 5.0])
RUN = DriveInput(X_IN, time_s=np.linspace(0.0, 8.0, X_IN.size))
WRONG = {
    f"{e.name}.{p.name}": p.start for e in EFFECTS if e.acts_on == "sensor" for p in e.parameters
} | {"x_out_zero_mm": 0.7}
CHANNELS = ("x_in_mm", "x_out_mm", "f_in_N", "f_out_N", "phase")


@pytest.mark.parametrize("nodes", [None, 3])
def test_the_solution_of_perfect_sensors_read_by_wrong_ones_is_the_prediction(nodes):
    rig = with_values(GROUP_A, WRONG | {"backlash.play_mm": 0.1})
    mechanics = mechanics_of(rig, RUN)
    assert mechanics == with_values(GROUP_A, {"backlash.play_mm": 0.1})
    again = read(rig, RUN, solve(mechanics, RUN, nodes=nodes))
    whole = simulate(rig, RUN, nodes=nodes)
    for name in CHANNELS:
        np.testing.assert_array_equal(getattr(again, name), getattr(whole, name))


@pytest.mark.parametrize(
    ("load", "own"),
    [
        ("force", r".*\.(f_out|settling|span).*"),
        ("displacement", r"x_out.*|.*\.x_out.*|position_sensor_ripple.*"),
    ],
)
def test_a_load_that_is_prescribed_needs_the_sensor_that_reads_it_and_no_other(load, own):
    """f_in never, as long as the drive is given by its displacement."""
    load_values = 20.0 + X_IN if load == "force" else 0.8 * X_IN
    drive = replace(RUN, load=load, load_values=load_values)
    rig, laws = with_values(GROUP_A, WRONG), {"drive_law.friction_1_N": 2.0}
    kept = {n: v for n, v in WRONG.items() if re.fullmatch(own, n)}
    mechanics = mechanics_of(with_values(rig, laws), drive)
    assert mechanics == with_values(GROUP_A, kept)
    again, whole = read(rig, drive, solve(mechanics, drive)), simulate(rig, drive)
    for name in CHANNELS:
        np.testing.assert_array_equal(getattr(again, name), getattr(whole, name))
    wrong, perfect = (solve(each, drive).output for each in (rig, GROUP_A))
    assert np.abs(wrong.f_in - perfect.f_in).max() > 1e-3


@pytest.mark.parametrize(
    "drive",
    [
        replace(RUN, values=25.0 + X_IN, kind="force"),
        replace(RUN, values=6.0 + X_IN, start_f_in_N=36.0),
    ],
)
def test_where_a_reading_determines_the_motion_the_sensors_are_a_part_of_it(drive):
    rig = with_values(GROUP_A, WRONG)
    assert mechanics_of(rig, drive) is rig
    wrong, perfect = (solve(each, drive).output for each in (rig, GROUP_A))
    assert np.abs(wrong.f_in - perfect.f_in).max() > 1e-3
