"""How the loop begins, and that it is the same program compiled and in plain Python."""

import math

import numpy as np
import pytest

from tests.both_ways import answers
from tests.physics.references import GROUP_A
from tsas_cli.controllers import CONTROLLERS
from tsas_cli.controllers.closed_loop import COLUMNS, plant_at_rest
from tsas_cli.physics.plant.turntable import Actuator
from tsas_cli.physics.rig import with_values
from tsas_cli.physics.slip.state import POSITION

DRIVE = Actuator(0.0236, 52.0, 1.8e-4, 0.007, 0.002, 3000.0)
PROGRAM = """
import json, sys
from tests.tracking.runs import run
from tsas_cli.controllers import CONTROLLERS

form = {"duration_s": 0.12, "mean_N": 44.0, "angular_frequency_rad_per_s": 40.0}
tables = {
    "reference": form, "sensor": {"rate_Hz": 250.0},
    "loop": {"nodes": 4, "crossing_s": 0.05, "substeps": 2},
}
rows = [run(name, **tables).columns.tolist() for name in CONTROLLERS]
print(json.dumps(["numba" in sys.modules, sum(rows, [])]))
"""


def test_it_begins_at_rest_in_balance():
    """Pulled from the preload the whole tendon slips: F(0) by the closure, Eq. (9)."""
    a = GROUP_A.friction_coefficient * GROUP_A.total_bend_rad
    EA, L = GROUP_A.tendon_stiffness_N, GROUP_A.sheath_length_mm
    for drive_mm, way in ((6.0, 1.0), (-4.0, -1.0)):
        motor, table, chain, _ = plant_at_rest(drive_mm, GROUP_A, DRIVE, 200)
        ratio, mean = math.exp(-way * a), (1.0 - math.exp(-way * a)) / (way * a)
        per_N = ratio / 1.579 + mean * L / EA
        expected = (drive_mm + 25.0 / 1.579 + 25.0 * L / EA) / per_N
        assert table.f_in == pytest.approx(expected, rel=1e-4)
        assert table.x == table.x_before == chain[POSITION] == drive_mm
        assert (table.v, motor.rpm, table.speed) == (0.0, 0.0, 0.0)
        wound = (table.f_in - 25.0) / 52.0
        assert motor.mm == pytest.approx(drive_mm + wound)


def test_at_zero_nothing_is_wound_up():
    motor, table, *_ = plant_at_rest(0.0, GROUP_A, DRIVE, 20)
    assert (motor.mm, table.f_in) == (0.0, 25.0)


def test_a_spring_beside_the_tendon_is_wound_up_too():
    spring = with_values(GROUP_A, {"proximal_spring.stiffness_N_per_mm": 12.5})
    plain, more = (plant_at_rest(6.0, rig, DRIVE, 20) for rig in (GROUP_A, spring))
    assert more.table.f_in - plain.table.f_in == pytest.approx(12.5 * 6.0)
    assert more.motor.mm - plain.motor.mm == pytest.approx(12.5 * 6.0 / 52.0)


def test_a_zero_of_the_sensor_does_not_move_the_start():
    shifted = GROUP_A._replace(x_in_zero_mm=3.0)
    one, other = (plant_at_rest(6.0, rig, DRIVE, 20) for rig in (GROUP_A, shifted))
    assert one.motor == pytest.approx(other.motor)
    assert one.table == pytest.approx(other.table)


def test_compiled_is_plain_python_to_rounding():
    plain, compiled = answers(PROGRAM, plain=True), answers(PROGRAM, plain=False)
    assert len(plain) == len(CONTROLLERS) * COLUMNS
    for ours, theirs in zip(plain, compiled, strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=1e-6, atol=1e-6)
