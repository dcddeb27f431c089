"""Ordinary recordings are left in peace: no error and no warning."""

import dataclasses
from itertools import product

import numpy as np
import pytest
from scipy.signal import butter, sosfiltfilt

from tests.recordings.quality.bench import Bench, columns, motion, remarks, spring, trial
from tsas_cli.recordings.quality import RUN_CHECKS

SHAPES = ("sine", "triangle", "chirp", "dwells", "nested", "decaying")
LOADS = ("spring", "force", "displacement")


def complaints(measured, load="spring"):
    """Return the codes of the errors and warnings."""
    return [code for code, remark in remarks(measured, load=load) if remark.severity != "note"]


@pytest.mark.parametrize(
    ("shape", "load"),  # each shape and each load has all sensors
    [
        pytest.param(*both, marks=() if "spring" in both or "nested" in both else pytest.mark.large)
        for both in product(SHAPES, LOADS)
    ],
)
@pytest.mark.parametrize(
    "sensors",
    [
        {"rate_Hz": 100.0, "noise_mm": 0.02, "noise_N": 0.3},
        {"rate_Hz": 500.0, "noise_mm": 0.005, "noise_N": 0.05, "step_mm": 0.01, "step_N": 0.05},
        {"rate_Hz": 500.0, "noise_mm": 0.0, "noise_N": 0.1, "step_mm": 0.02, "step_N": 0.005},
        {"rate_Hz": 200.0, "noise_mm": 0.0, "noise_N": 0.0},
        {"rate_Hz": 2000.0, "noise_mm": 0.01, "noise_N": 0.1, "step_mm": 0.002, "step_N": 0.01}
        | {"duration_s": 8.0},
    ],
    ids=["noisy", "dithered", "encoder", "noiseless", "fast"],
)
def test_nothing_is_reported_about_an_ordinary_recording(shape, load, sensors):
    bench = Bench(shape=shape, load=load, seed=7, **sensors)
    assert complaints(columns(bench), load) == []


@pytest.mark.parametrize("shape", SHAPES)
def test_nothing_is_reported_where_only_the_drive_is_recorded(shape):
    for seed in range(3):
        measured = columns(Bench(shape=shape, seed=seed))
        drive = {name: measured[name] for name in ("time_s", "x_in_mm", "f_in_N")}
        assert complaints(drive) == []


def test_nothing_is_reported_in_twenty_repeats_of_one_experiment():
    bench = Bench(rate_Hz=200.0, noise_mm=0.02, noise_N=0.3, step_mm=0.01, step_N=0.05)
    for seed in range(20):
        assert complaints(columns(dataclasses.replace(bench, seed=seed))) == []


def test_a_run_that_ends_just_after_a_reversal_has_no_wrong_sign():
    """Friction has f_in fall below its first value, while x_in is still far above its own."""
    whole = columns(Bench(rate_Hz=64.0))
    rows = (whole["time_s"] > 0.9) & (whole["time_s"] < 2.35)
    measured = {name: values[rows] for name, values in whole.items()}
    assert measured["f_in_N"][-1] < measured["f_in_N"][0] - 10.0
    assert measured["x_in_mm"][-1] > measured["x_in_mm"][0] + 5.0
    assert "sign" not in complaints(measured)
    assert "sign" in complaints(measured | {"f_in_N": -measured["f_in_N"]})


def test_a_band_brake_whose_tight_side_changes_with_the_direction_is_no_exchange():
    measured = columns(Bench(load="force"))
    forward = np.gradient(np.convolve(measured["x_in_mm"], np.ones(9) / 9, mode="same")) > 0
    noise = np.random.default_rng(3).standard_normal((2, forward.size))
    brake = measured | {
        "f_in_N": np.where(forward, 2300.0, 20.0) + noise[0],
        "f_out_N": np.where(forward, 80.0, 1600.0) + noise[1],
    }
    assert complaints(brake, "force") == []
    swapped = brake | {"f_in_N": brake["f_out_N"], "f_out_N": brake["f_in_N"]}
    assert complaints(swapped, "force") == ["exchanged"]


def test_rows_that_repeat_at_rest_between_bursts_of_vibration_are_no_fault():
    rng = np.random.default_rng(5)
    measured = columns(Bench(rate_Hz=1000.0, shape="dwells", noise_mm=0.0, noise_N=0.0))
    burst = np.where(np.abs(np.gradient(measured["x_in_mm"])) > 1e-4, 40.0, 0.6)
    for name, step in (("x_in_mm", 0.01), ("x_out_mm", 0.01), ("f_in_N", 0.05), ("f_out_N", 0.05)):
        noisy = measured[name] + burst * step * rng.standard_normal(burst.size)
        measured[name] = np.round(noisy / step) * step
    assert "repeated-rows" not in complaints(measured)


def test_an_encoder_that_waits_for_the_load_at_the_start_is_not_clipped():
    measured = columns(Bench(load="force", noise_mm=0.0, step_mm=0.005))
    start = measured["time_s"] < 0.2
    measured["x_in_mm"][start] = measured["x_in_mm"].min()
    measured["x_out_mm"] -= np.where(measured["time_s"] > 0.02, 1.5, 0.0)
    assert "clipped" not in complaints(measured, "force")


def test_a_drive_at_rest_whose_load_swings_on_is_not_clipped():
    """A mass at the load goes on by a tenth of the travel, and slackens the tendon."""
    measured = columns(Bench(shape="dwells", rate_Hz=500.0, noise_mm=0.0, step_mm=0.004))
    at_rest = measured["x_in_mm"] == measured["x_in_mm"].max()
    stops = np.flatnonzero(np.diff(at_rest.astype(int)) == 1)
    for first, end in zip(stops, np.flatnonzero(np.diff(at_rest.astype(int)) == -1), strict=False):
        since = measured["time_s"][first:end] - measured["time_s"][first]
        swing = np.exp(-4.0 * since) * np.sin(9.0 * since)
        measured["x_out_mm"][first:end] += 2.5 * swing
        measured["f_in_N"][first:end] -= 3.0 * swing
    assert "clipped" not in complaints(measured)


def test_a_force_that_falls_with_the_speed_at_the_end_of_a_stroke_is_not_clipped():
    measured = columns(Bench())
    speed = np.gradient(motion(Bench(), measured["time_s"]), measured["time_s"])
    size = np.maximum(np.abs(speed), 0.5)
    measured["f_in_N"] *= np.exp(0.05 * np.sign(speed) * np.log(size / size.max()))
    assert complaints(measured) == []


@pytest.mark.parametrize("shape", SHAPES)
def test_a_computed_recording_that_was_interpolated_is_not_stuck_in_the_dead_band(shape):
    measured = columns(Bench(shape=shape, noise_mm=0.0, noise_N=0.0))
    time = np.arange(0.0, 15.9, 0.001)
    finer = {name: np.interp(time, measured["time_s"], v) for name, v in measured.items()}
    assert complaints(finer) == []


def test_a_spring_that_pulls_beside_the_tendon_is_no_other_unit_of_f_out():
    measured = columns(Bench())
    level = np.median(measured["f_out_N"])
    wanted = 4.448 * level - np.median(measured["f_in_N"])
    measured["f_in_N"] += wanted / np.median(measured["x_in_mm"]) * measured["x_in_mm"]
    assert "unit" not in complaints(measured)
    # Where no stiffness of the load is stated it cannot be told apart.
    unit = next(check for check in RUN_CHECKS if check.code == "unit")
    assert any("pound-force" in remark.sentence for remark in unit.find(trial(measured)))


def by_steps(rate_Hz, hold_s, levels, natural=20.0, damping=0.8):
    """Return the times of 12 s, and a position that goes to each level as a second-order loop."""
    time = np.arange(int(12.0 * rate_Hz)) / rate_Hz
    step = (time // hold_s).astype(int)
    since = time - hold_s * step
    damped = natural * np.sqrt(1.0 - damping**2)
    left = np.exp(-damping * natural * since) * (
        np.cos(damped * since) + damping * natural / damped * np.sin(damped * since)
    )
    to = np.resize(levels, step[-1] + 1)
    before = np.append(0.0, to)[:-1]
    return time, to[step] + (before - to)[step] * left


def counted(values, step, jitter=0.0):
    """Return what an encoder reads, with so many counts of jitter."""
    noise = jitter * np.random.default_rng(1).standard_normal(values.size)
    return np.round(values / step + noise) * step


def all_channels(time, x, x_out):
    noise = 0.1 * np.random.default_rng(2).standard_normal((2, x.size))
    forces = {"f_in_N": 30.0 + 3.0 * x + noise[0], "f_out_N": 25.0 + 1.5 * x_out + noise[1]}
    return {"time_s": time, "x_in_mm": counted(x, 0.002), "x_out_mm": x_out, **forces}


@pytest.mark.parametrize("rate_Hz", [50.0, 100.0])
def test_a_drive_that_goes_by_steps_loses_no_samples(rate_Hz):
    for natural in (14.0, 20.0, 28.0):
        time, x = by_steps(rate_Hz, 2.0, [20.0, 0.0], natural)
        assert "lost-samples" not in complaints(all_channels(time, x, counted(x, 0.005, 0.3)))


def test_samples_that_a_drive_loses_as_it_goes_by_a_step_are_missed():
    time, x = by_steps(100.0, 2.0, [20.0, 0.0], 14.0)
    left = np.delete(x, range(206, 210))
    measured = all_channels(time[: left.size], left, counted(left, 0.005, 0.3))
    assert "lost-samples" in complaints(measured)


def test_a_load_that_swings_between_rests_is_behind_no_median_filter():
    """Near half the sampling rate that looks like noise; the encoder itself is quiet."""
    time, x = by_steps(50.0, 2.0, [20.0, 0.0])
    swing = 0.3 * np.exp(-8.0 * np.mod(time, 2.0)) * np.sin(2.0 * np.pi * 21.5 * time)
    measured = all_channels(time, x, counted(x + swing, 0.005, 0.3))
    assert trial(measured).is_noisy("x_out_mm")
    assert "repeated-values" not in complaints(measured)


def of_a_spring(time, x, step):
    """Return what the sensors say of a drive that pulls a spring, x_in counted in steps."""
    x_out, f_in, f_out = spring(x, time)
    noise = 0.1 * np.random.default_rng(2).standard_normal((2, x.size))
    positions = {"x_in_mm": counted(x, step), "x_out_mm": counted(x_out, 0.005, 0.3)}
    return {"time_s": time, **positions, "f_in_N": f_in + noise[0], "f_out_N": f_out + noise[1]}


@pytest.mark.parametrize("amplitude_mm", [2.5, 5.0])
def test_a_smooth_motion_is_not_filtered_where_it_is_alike_in_all_parts_of_a_run(amplitude_mm):
    time = np.arange(650) / 50.0
    x = amplitude_mm * (2.0 - np.cos(np.pi * time) - np.cos(2.3 * np.pi * time))
    assert "filtered" not in complaints(of_a_spring(time, x, 0.002))


@pytest.mark.parametrize("first", [0.3, 1.0])
def test_harmonics_of_a_stroke_that_repeats_are_no_noise_behind_a_filter(first):
    """A shaking table whose motion has harmonics up to a seventh of the rate."""
    time = np.arange(2600) / 100.0
    angle = 2.0 * np.pi * 0.97 * time
    wave = sum(0.004 * np.sin(n * angle + n * n) for n in range(2, 15))
    x = 5.0 - 5.0 * np.cos(angle + first) + wave
    assert "filtered" not in complaints(of_a_spring(time, x, 5e-4))


@pytest.mark.parametrize("felt", [True, False])
def test_what_an_unsteady_drive_does_is_not_filtered_where_a_force_feels_it(felt):
    """Steps of a few counts at random, up to 8 Hz, on the way of 10 mm; else it is a sensor's."""
    time, rng = np.arange(4000) / 200.0, np.random.default_rng(3)
    way = 5.0 - 5.0 * np.cos(0.8 * time)
    unrest = sosfiltfilt(butter(2, 8.0, fs=200.0, output="sos"), rng.normal(size=time.size))
    x_in = way + 0.02 * unrest
    forces = {
        name: 20.0 + slope * (x_in if felt else way) + 0.005 * rng.normal(size=time.size)
        for name, slope in (("f_in_N", 2.0), ("f_out_N", 1.5))
    }
    found = complaints({"time_s": time, "x_in_mm": np.round(x_in, 3), **forces})
    assert ("filtered" in found) is not felt


@pytest.mark.parametrize("rows", [0, 200])
def test_a_corner_of_the_force_where_the_drive_reverses_is_no_burst(rows):
    """A stretch and its return, whose force jumps in a few rows; the same later is a burst."""
    time = np.arange(1600) / 50.0
    x = np.interp(time, [0.0, 16.0, 32.0], [0.0, 40.0, 0.0])
    noise = 0.002 * np.random.default_rng(5).standard_normal(time.size)
    f_in = 0.05 * x + noise
    f_in[780 + rows : 812 + rows] += 0.05 * np.tile([1.0, -1.0], 16)
    found = complaints({"time_s": time, "x_in_mm": x, "f_in_N": f_in})
    assert ("bursts" in found) == (rows > 0)


@pytest.mark.parametrize("noise", [0.0, 1.0])
def test_the_load_of_a_slack_tendon_is_not_clipped(noise):
    """It rests where its spring is relaxed while the drive moves on; so do the tensions."""
    time = np.arange(1200) / 100.0
    x = -10.0 * np.sin(np.pi * time / 2.0)
    random = noise * np.random.default_rng(4).standard_normal((3, x.size))
    x_out = np.maximum(x, -6.0)
    f_out = 12.0 + 2.0 * x_out + 0.05 * random[1]
    f_in = (12.0 + 2.0 * x_out) * np.where(np.gradient(x) > 0.0, 1.2, 1.0 / 1.2)
    measured = {"time_s": time, "x_in_mm": x, "x_out_mm": x_out + 0.005 * random[2]}
    measured |= {"f_in_N": f_in + 0.05 * random[0], "f_out_N": f_out}
    assert "clipped" not in complaints(measured)
    stopped = measured | {"f_out_N": f_out + 5.0, "f_in_N": measured["f_in_N"] + 5.0}
    assert "clipped" in complaints(stopped)  # taut: the load is at a stop, or its sensor at an end


def test_a_stroke_that_hardly_leaves_the_dead_band_is_not_clipped():
    """The tension rises no further once the whole tendon slips against a soft load."""
    time = np.arange(1200) / 100.0
    x = 5.0 - 5.0 * np.cos(np.pi * time)
    slipped = np.zeros(x.size)
    for i in range(1, x.size):
        slipped[i] = np.clip(slipped[i - 1], x[i] - 9.0, x[i])
    noise = np.random.default_rng(3).standard_normal((2, x.size))
    f_in = 20.0 + 3.0 * (x - slipped) + 0.02 * slipped + 0.05 * noise[0]
    measured = {"time_s": time, "x_in_mm": x, "f_in_N": f_in}
    moves = {"x_out_mm": 0.3 * slipped + 0.005 * noise[1]}
    assert "clipped" not in complaints(measured | moves)
    assert "clipped" in complaints(measured | {"x_out_mm": 0.3 * x + 0.005 * noise[1]})


@pytest.mark.parametrize(("drops_for", "found"), [(0.03, False), (0.6, True)])
def test_a_tension_that_falls_before_the_encoder_counts_does_not_hang_it(drops_for, found):
    """A drive moves within a count at the end of a rest; a sensor that hangs misses more."""
    time = np.arange(800) / 100.0
    noise = np.random.default_rng(4).standard_normal((2, time.size))
    x = np.interp(time, [0.0, 3.0, 5.0, 6.0, 8.0], [0.0, 10.0, 10.0, 6.0, 14.0]) + 0.01 * noise[0]
    x[300:500] = 10.0
    f_in = np.interp(time, [0.0, 3.0, 5.0 - drops_for, 5.1, 8.0], [20.0, 60.0, 60.0, 40.0, 20.0])
    measured = {"time_s": time, "x_in_mm": x, "f_in_N": f_in + 0.1 * noise[1]}
    assert ("stuck" in complaints(measured)) is found


def test_a_drive_that_hunts_within_a_count_is_not_stuck():
    """The tension follows what the encoder does not resolve."""
    time, x = by_steps(100.0, 1.5, [20.0, 8.0, 14.0, 0.0], damping=0.99)
    hunts = 0.45 * np.sin(1.8 * np.pi * time)
    tension = 30.0 + x + 4.0 * hunts + 0.1 * np.random.default_rng(2).standard_normal(x.size)
    hunting = {"time_s": time, "x_in_mm": counted(x + 0.004 * hunts, 0.004), "f_in_N": tension}
    assert "stuck" not in complaints(hunting)


def test_a_rest_within_each_stroke_exchanges_no_tensions():
    """There the friction may have either sign, and longer than the drive moves."""
    measured = columns(Bench(shape="triangle", noise_mm=0.0))
    x, f_out = measured["x_in_mm"], measured["f_out_N"]
    rests = np.flatnonzero(np.diff(np.sign(x - 12.0)))
    held = {name: np.insert(v, np.repeat(rests, 900), np.repeat(v[rests], 900))
            for name, v in measured.items()}  # fmt: skip
    at_rest = np.insert(np.zeros(x.size), np.repeat(rests, 900), 1.0) > 0.0
    held["f_in_N"][at_rest] = np.repeat(f_out[rests] ** 2 / measured["f_in_N"][rests], 900)
    held["time_s"] = np.arange(at_rest.size) / 200.0
    assert "exchanged" not in complaints(held)


@pytest.mark.parametrize("rate_Hz", [20.0, 30.0])
def test_the_corners_of_a_triangle_are_no_outliers(rate_Hz):
    bench = Bench(shape="triangle", rate_Hz=rate_Hz, duration_s=40.0, noise_N=0.02, noise_mm=0.002)
    assert complaints(columns(bench)) == []


def test_a_commanded_speed_may_jump_and_be_back_as_no_sensor_may():
    measured = columns(Bench(rate_Hz=200.0, duration_s=10.0))
    speed = np.gradient(measured["x_in_mm"], measured["time_s"])
    speed[[500, 900]] += 20.0 * np.abs(speed).max()
    measured["motor_speed_rpm"] = speed
    assert complaints(measured) == []
    measured["x_out_mm"][500] += np.ptp(measured["x_out_mm"])
    assert complaints(measured) == ["outlier"]


@pytest.mark.parametrize(("hump_N", "expected"), [(0.0, True), (12.0, False)])
def test_a_force_that_was_higher_within_its_strokes_is_not_clipped(hump_N, expected):
    """A knot in the tendon passes a bend before the end of each stroke."""
    time = np.arange(1200) / 100.0
    x = 10.0 - 10.0 * np.cos(np.pi * time)
    noise = np.random.default_rng(5).normal(scale=0.05, size=(2, x.size))
    pulled = np.minimum(20.0 + 2.0 * x, 54.0) + hump_N * np.exp(-((x - 15.0) ** 2))
    f_in = np.where(np.diff(x, prepend=-1.0) > 0.0, pulled, 15.0 + 1.5 * x) + noise[0]
    found = complaints({"time_s": time, "x_in_mm": x, "f_in_N": f_in, "x_out_mm": x + noise[1]})
    assert ("clipped" in found) == expected
