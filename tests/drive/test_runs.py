"""Recordings of a drive: what is taken, what is refused, and whether they begin at rest."""

import numpy as np
import pytest

from tsas_cli.drive.runs import drive_runs
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.recording import Recording
from tsas_cli.support.errors import InputError

N, STEP_S = 2000, 0.005
TIME_S = STEP_S * np.arange(N)
SPEED = 300.0 * np.sin(2.0 * TIME_S)
PLACE = 0.02 * (150.0 - 150.0 * np.cos(2.0 * TIME_S))


def recorded(**columns):
    noise = 1e-3 * np.random.default_rng(1).standard_normal(N)
    values = {"time_s": TIME_S, "motor_speed_rpm": SPEED, "x_in_mm": PLACE + noise} | columns
    values = {name: v for name, v in values.items() if v is not None}
    return Recording(Run(id="a", file="runs/a.parquet", sha256="0" * 64), values)


def checked(**columns):
    (run,) = drive_runs([recorded(**columns)], "first")
    return run


def test_a_run_is_taken_as_it_is():
    run = checked(time_s=TIME_S + 77.0)
    assert run.id == "a"
    assert run.u.step_s == pytest.approx(STEP_S)
    np.testing.assert_array_equal(run.u.values, SPEED)
    np.testing.assert_allclose(run.time_s, TIME_S, atol=1e-9)
    assert run.noise_mm == pytest.approx(1e-3, rel=0.2)


@pytest.mark.parametrize(("part", "at_rest"), [(0.0, True), (0.0099, True), (0.0101, False)])
@pytest.mark.parametrize("largest", [0.5, 300.0])
def test_a_run_begins_at_rest_below_a_hundredth_of_its_largest_speed(part, at_rest, largest):
    speed = largest * np.sin(2.0 * TIME_S)
    speed /= np.abs(speed).max() / largest
    speed[0] = -part * largest
    place = PLACE * largest / 300.0
    noise = 1e-4 * np.random.default_rng(1).standard_normal(N) * largest / 300.0
    assert checked(motor_speed_rpm=speed, x_in_mm=place + noise).at_rest == at_rest


@pytest.mark.parametrize(("by", "fine"), [(0.019, True), (0.021, False)])
def test_a_clock_may_be_uneven_by_a_fiftieth_of_a_step(by, fine):
    time_s = TIME_S.copy()
    time_s[900] += by * STEP_S
    if fine:
        checked(time_s=time_s)
    else:
        with pytest.raises(InputError, match="row 900") as raised:
            checked(time_s=time_s)
        assert "0.005105" in raised.value.line()


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        ({"motor_speed_rpm": np.zeros(N)}, "the motor stands still"),
        ({"motor_speed_rpm": np.full(N, 40.0)}, "keeps one speed, 40 rpm"),
        ({"motor_speed_rpm": None}, "motor_speed_rpm"),
        ({"x_in_mm": None}, "x_in_mm"),
        ({"x_in_mm": np.where(TIME_S > 3.0, np.nan, PLACE)}, "x_in_mm"),
        ({"x_in_mm": np.full(N, 3.0)}, "x_in_mm"),
        ({"x_in_mm": 100.0 * np.random.default_rng(2).standard_normal(N)}, "x_in_mm"),
        ({"x_in_mm": np.cumsum(np.random.default_rng(8).standard_normal(N))}, "follow"),
    ],
)
def test_what_no_drive_can_be_told_from_is_refused(columns, said):
    with pytest.raises(InputError) as raised:
        checked(**columns)
    assert said in raised.value.line()
    assert "runs/a.parquet" in raised.value.line()


@pytest.mark.parametrize(("size", "fine"), [(499, False), (500, True)])
def test_fewer_than_five_hundred_samples_are_too_few(size, fine):
    cut = {"time_s": TIME_S[:size], "motor_speed_rpm": SPEED[:size], "x_in_mm": None}
    cut["x_in_mm"] = recorded().columns["x_in_mm"][:size]
    if fine:
        assert checked(**cut).x_in.size == 500
    else:
        with pytest.raises(InputError, match="499 samples are too few"):
            checked(**cut)
