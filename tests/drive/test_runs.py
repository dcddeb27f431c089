"""Recordings of a drive: what is taken, what is refused, and whether they begin at rest."""

import re
from types import SimpleNamespace

import numpy as np
import pytest

from tests.refusals import refusal
from tsas_cli.drive import runs as d
from tsas_cli.drive.runs import drive_runs
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.recording import Recording

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


def test_without_a_speed_that_of_the_motors_angle_counts():
    by_speed = checked()
    angle = np.concatenate(([0.0], np.cumsum(0.5 * STEP_S * (SPEED[1:] + SPEED[:-1]))))
    run = checked(motor_speed_rpm=None, motor_angle_rad=2.0 + angle * np.pi / 30.0)
    np.testing.assert_allclose(run.u.values[1:-1], SPEED[1:-1], atol=0.01)
    np.testing.assert_allclose(run.u.integral, by_speed.u.integral, atol=0.01)
    np.testing.assert_array_equal(checked(motor_angle_rad=0.0 * SPEED).u.values, SPEED)


@pytest.mark.parametrize(("part", "at_rest"), [(0.0099, True), (0.0101, False)])
@pytest.mark.parametrize("largest", [0.5, 300.0])
def test_a_run_begins_at_rest_below_a_hundredth_of_its_largest_speed(part, at_rest, largest):
    speed = largest * np.sin(2.0 * TIME_S)
    speed /= np.abs(speed).max() / largest
    speed[0] = -part * largest
    place = PLACE * largest / 300.0
    noise = 1e-4 * np.random.default_rng(1).standard_normal(N) * largest / 300.0
    assert checked(motor_speed_rpm=speed, x_in_mm=place + noise).at_rest == at_rest


@pytest.mark.parametrize(
    ("last", "by", "said"),
    [
        (901, 0.019, None),
        (901, 0.021, "time_s goes on by 0.005105 s, by 0.005 s on average"),
        (N, 1.0, "time_s goes on by 0.01 s, by 0.005003 s on average"),
    ],
)
def test_a_clock_may_be_uneven_by_a_fiftieth_of_a_step(last, by, said):
    time_s = TIME_S.copy()
    time_s[900:last] += by * STEP_S
    if said is None:
        checked(time_s=time_s)
    else:
        line = refusal(checked, time_s=time_s)
        assert "row 900" in line
        assert said in line


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
    line = refusal(checked, **columns)
    assert said in line
    assert "runs/a.parquet" in line


def test_fewer_than_five_hundred_samples_are_too_few():
    cut = {
        size: {name: values[:size] for name, values in recorded().columns.items()}
        for size in (499, 500)
    }
    assert checked(**cut[500]).x_in.size == 500
    assert "499 samples are too few" in refusal(checked, **cut[499])


@pytest.mark.parametrize(
    ("rows", "said"), [([7], "1 gap"), ([9, 30], "2 gaps"), ([4, 5, 6], "3 gaps")]
)
def test_gaps_are_counted_and_the_first_is_named(rows, said):
    x = PLACE.copy()
    x[rows] = np.nan
    line = refusal(checked, x_in_mm=x)
    assert re.search(rf"x_in_mm has {said}\b", line)
    assert f"row {rows[0]}" in line


@pytest.mark.parametrize(("samples", "times"), [(500, 1), (620, 1), (4000, 1), (500, 2), (2000, 3)])
def test_the_noise_of_x_in_is_that_of_its_sensor(samples, times):
    """In short runs too, and in those laid on a clock so many times as fast."""
    time_s = np.arange(samples) / 200.0
    x_in = 5.0 * np.sin(2.0 * time_s) + 5e-3 * np.random.default_rng(1).standard_normal(samples)
    clock = np.linspace(0.0, time_s[-1], times * (samples - 1) + 1)
    run = checked(
        time_s=clock,
        motor_speed_rpm=400.0 * np.cos(2.0 * clock),
        x_in_mm=np.interp(clock, time_s, x_in),
    )
    assert run.noise_mm == pytest.approx(5e-3, rel=0.2)


T = np.linspace(-1.0, 1.0, 201)


def related(follows):
    """Return a run whose travel has a given correlation with the motor's turns, beside lines."""
    basis = np.linalg.qr(np.column_stack((np.ones(201), T, T**2, np.sin(9.0 * T))))[0]
    turns, other = basis[:, 2], basis[:, 3]
    travel = follows * turns + np.sqrt(1.0 - follows**2) * other
    return SimpleNamespace(
        time_s=3.0 + T,
        u=SimpleNamespace(integral=40.0 * turns + 7.0 + 300.0 * T),
        x_in=0.5 * travel - 3.0 - 20.0 * T,
    )


@pytest.mark.parametrize(
    ("follows", "said"),
    [
        (0.52, None),
        (1.0, None),
        (0.48, "motor (correlation 0.48)"),
        (-0.48, "motor (correlation -0.48)"),
        (-0.52, "motor but its opposite (correlation -0.52)"),
    ],
)
def test_travel_has_to_go_with_the_turns(follows, said):
    if said is None:
        d._refuse_unrelated(related(follows), "here")
    else:
        line = refusal(d._refuse_unrelated, related(follows), "here")
        assert f"x_in_mm does not follow the turns of the {said}" in line
