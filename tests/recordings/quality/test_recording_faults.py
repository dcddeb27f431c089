"""What is recorded wrongly on a sound rig is found by its own check; the rest stay silent."""

import numpy as np
import pytest
from scipy.signal import butter, lfilter, sosfiltfilt

from tests.recordings.quality.bench import Bench, columns, motion, remarks

BENCH = Bench(rate_Hz=200.0, step_mm=0.002, step_N=0.01)
GOOD = columns(BENCH)
TIME = GOOD["time_s"]
N = TIME.size
STEPS = {"x_in_mm": 0.002, "x_out_mm": 0.002, "f_in_N": 0.01, "f_out_N": 0.01}


def told(measured, code, **run):
    """Return the only remark of a check."""
    (remark,) = (remark for found, remark in remarks(measured, **run) if found == code)
    return remark


def number(remark, begin, end):
    """Return the number that a sentence says between two words."""
    return float(remark.sentence.split(begin)[1].split(end)[0])


def rows_of(rows):
    return {n: v[: rows.size] if n == "time_s" else v[rows] for n, v in GOOD.items()}


def jumping(column, size, driver="x_in_mm"):
    """Return the recording with a channel that jumps with the direction of another one."""
    speed = np.gradient(columns(Bench(noise_mm=0.0, noise_N=0.0))[driver], TIME)
    return GOOD | {column: GOOD[column] + size * np.clip(speed / 0.3, -1.0, 1.0)}


def test_the_recording_without_a_fault_is_sound():
    assert remarks(GOOD) == []


@pytest.mark.parametrize(
    ("column", "cut_Hz"), [("f_out_N", 4.0), ("f_out_N", 8.0), ("f_in_N", 8.0), ("x_in_mm", 6.0)]
)
def test_a_channel_behind_a_low_pass_filter(column, cut_Hz):
    sections = butter(2, cut_Hz, fs=200.0, output="sos")
    step, smooth = STEPS[column], sosfiltfilt(sections, GOOD[column])
    remark = told(GOOD | {column: np.round(smooth / step) * step}, "filtered")
    assert remark.column == column
    said_Hz = number(remark, "about ", " Hz")
    assert 0.5 * cut_Hz < said_Hz < 2.5 * cut_Hz


@pytest.mark.parametrize(
    ("order", "quiet", "seen"), [(4, 1.0, True), (0, 1.0, False), (0, 0.03, False)]
)
def test_a_steep_filter_below_a_fast_motion_is_seen_beside_the_other_tension(order, quiet, seen):
    """The motion, up to 20 Hz, hides where the noise ends; a quiet sensor is white."""
    rng = np.random.default_rng(3)
    time = np.arange(4000) / 250.0
    way = sum(np.sin(2.0 * np.pi * f * time + f**2) / f for f in np.linspace(0.3, 20.0, 60))
    force, noise = 30.0 + 4.0 * way, 0.05 * rng.normal(size=(2, time.size))
    f_in = force + quiet * noise[0]
    if order:
        f_in = lfilter(*butter(order, 10.0, fs=250.0), f_in - f_in[0]) + f_in[0]
    moved = {"x_in_mm": 5.0 + way, "x_out_mm": 5.0 + 0.9 * way}
    positions = {n: x + 0.002 * rng.normal(size=time.size) for n, x in moved.items()}
    forces = {"f_in_N": f_in, "f_out_N": 0.8 * force + noise[1]}
    found = {
        r.column for c, r in remarks({"time_s": time, **positions, **forces}) if c == "filtered"
    }
    assert found == ({"f_in_N"} if seen else set())


def test_samples_that_are_lost_and_closed_up():
    lost = 700, 1500
    kept = np.delete(np.arange(N), [*range(lost[0], lost[0] + 12), *range(lost[1], lost[1] + 12)])
    remark = told(rows_of(kept), "lost-samples")
    assert "at 2 places" in remark.sentence
    assert remark.first_s == pytest.approx(TIME[lost[0] - 1], abs=0.02)
    seconds = number(remark, "closed up: ", " s")
    assert seconds == pytest.approx(12 * 0.005, rel=0.25)


def test_a_gap_that_the_times_show_is_no_lost_sample():
    kept = np.delete(np.arange(N), range(700, 750))
    assert {code for code, _ in remarks({n: v[kept] for n, v in GOOD.items()})} == {"gap"}


def test_a_buffer_that_is_written_twice():
    rows = np.concatenate((np.arange(1020), np.arange(1000, N)))[:N]
    remark = told(rows_of(rows), "repeated-buffer")
    assert "1 block of rows repeat" in remark.sentence
    assert "has 20 rows" in remark.sentence
    assert remark.first_s == pytest.approx(TIME[1020])


@pytest.mark.parametrize("column", ["f_in_N", "f_out_N"])
def test_a_buffer_of_one_channel_that_is_written_twice(column):
    again = GOOD[column].copy()
    again[1020:1040] = again[1000:1020]
    remark = told(GOOD | {column: again}, "repeated-buffer")
    assert f"1 block of rows repeat the block before in {column}" in remark.sentence
    assert remark.first_s == pytest.approx(TIME[1020])


def test_rows_of_a_rest_that_are_alike_by_chance_are_no_buffer():
    """A rest in which the channels take seven values, as an encoder and its servo do."""
    rest = {n: np.full(200, v[0]) for n, v in GOOD.items() if n != "time_s"}
    digits = np.random.default_rng(3).integers(0, 7, 200)
    digits[96:105] = [4, 0, 5, 1, 4, 0, 5, 1, 6]
    rest |= {n: rest[n] + 0.013 * digits for n in ("f_in_N", "x_in_mm")}
    rows = {n: np.concatenate((v, GOOD[n])) for n, v in rest.items()}
    time = {"time_s": 0.005 * np.arange(200 + N)}
    assert "repeated-buffer" not in {code for code, _ in remarks(time | rows)}


def test_sampling_at_other_times_than_are_written():
    at = TIME + 0.006 * np.random.default_rng(1).standard_normal(N)
    clean = columns(Bench(noise_mm=0.0, noise_N=0.0))
    rng = np.random.default_rng(2)
    moved = {
        n: np.interp(at, TIME, clean[n]) + 5.0 * step * rng.standard_normal(N)
        for n, step in STEPS.items()
    }
    remark = told({"time_s": TIME} | moved, "unsteady-sampling")
    said_ms = number(remark, "taken ", " ms")
    assert said_ms == pytest.approx(6.0, rel=0.25)


def test_sampling_at_uneven_times_that_are_written_is_no_fault():
    at = TIME + 0.001 * np.random.default_rng(1).uniform(-2.0, 2.0, N)
    clean = columns(Bench(noise_mm=0.0, noise_N=0.0))
    rng = np.random.default_rng(2)
    moved = {
        n: np.interp(at, TIME, clean[n]) + 0.2 * step * rng.standard_normal(N)
        for n, step in STEPS.items()
    }
    codes = [{code for code, _ in remarks({"time_s": time_s} | moved)} for time_s in (at, TIME)]
    assert "unsteady-sampling" not in codes[0]
    assert "unsteady-sampling" in codes[1]


def test_a_hum_is_told_with_its_frequency():
    hum = GOOD["f_out_N"] + 0.7 * np.sin(2.0 * np.pi * 7.3 * TIME)
    remark = told(GOOD | {"f_out_N": hum}, "hum")
    assert number(remark, "about ", " Hz") == pytest.approx(7.3, rel=0.1)


def test_bursts_are_counted():
    noisy = GOOD["f_in_N"].copy()
    for start in (500, 1400, 2300):
        noisy[start : start + 80] += np.random.default_rng(start).standard_normal(80)
    remark = told(GOOD | {"f_in_N": noisy}, "bursts")
    assert "3 bursts" in remark.sentence
    assert remark.first_s == pytest.approx(2.5, abs=0.1)


def wound_up(along, size, period_mm=0.8):
    """Return the sawtooth of a force that is wound up over a way, and slips [N]."""
    return size * (np.mod(along, period_mm) / period_mm - 0.5)


def test_a_tendon_that_sticks_and_slips():
    """Every 0.8 mm it has wound up 4 N, whichever way the drive goes."""
    x_in, speed = motion(BENCH, TIME), np.gradient(motion(BENCH, TIME))
    jumps = np.sign(speed) * wound_up(np.cumsum(np.abs(speed)), 4.0)
    remark = told(GOOD | {"f_in_N": GOOD["f_in_N"] + jumps}, "stick-slip")
    slips = np.abs(speed).sum() / 0.8
    assert number(remark, "drops ", " times") == pytest.approx(slips, rel=0.1)
    assert number(remark, "by ", " N") == pytest.approx(4.0, rel=0.15)
    assert remark.first_s == pytest.approx(TIME[np.argmax(x_in > 0.8)], abs=0.05)


@pytest.mark.parametrize(
    "added",
    [
        -wound_up(GOOD["x_in_mm"], 4.0),  # one that reverses with the drive: a gear, at a place
        3.0 * np.sin(GOOD["x_in_mm"] / 0.13),  # a ripple
        np.where(np.abs(TIME - 8.0) < 0.1, -4.0, 0.0),  # one drop
    ],
)
def test_what_rises_as_steeply_as_it_falls_or_drops_once_is_no_stick_slip(added):
    changed = GOOD | {"f_in_N": GOOD["f_in_N"] + added}
    assert "stick-slip" not in [code for code, _ in remarks(changed)]


def test_a_force_that_follows_small_reversals_of_the_drive_is_no_stick_slip():
    nested = columns(Bench("nested", rate_Hz=200.0))
    assert "stick-slip" not in [code for code, _ in remarks(nested)]


def test_samples_on_lines_between_recorded_ones_have_no_bursts():
    seeds = (columns(Bench(rate_Hz=200.0, step_N=0.01, seed=seed))["f_out_N"] for seed in (1, 6))
    for coarse in seeds:
        on_lines = np.interp(TIME, TIME[::5], coarse[::5])
        assert "bursts" not in [code for code, _ in remarks(GOOD | {"f_out_N": on_lines})]
    noisy = GOOD["f_in_N"].copy()
    noisy[1500:1900:5] += np.random.default_rng(0).standard_normal(80)
    loud = np.interp(TIME, TIME[::5], noisy[::5])
    assert told(GOOD | {"f_in_N": loud}, "bursts").first_s == pytest.approx(8.0, abs=0.5)


def test_many_outliers():
    rng = np.random.default_rng(3)
    off = (rng.random(N) < 0.03) * rng.choice((-1.5, 1.5), N)
    remark = told(GOOD | {"f_out_N": GOOD["f_out_N"] + off}, "outlier")
    assert (remark.severity, remark.column) == ("warning", "f_out_N")
    assert float(remark.sentence.split(" %")[0]) == pytest.approx(3.0, abs=0.8)


def test_an_amplifier_that_is_coupled_to_ac():
    decay = np.exp(-0.005 / 3.0)
    coupled = lfilter([1.0, -1.0], [1.0, -decay], GOOD["f_in_N"])
    remark = told(GOOD | {"f_in_N": coupled}, "ac-coupled", preload_N=25.0)
    assert remark.column == "f_in_N"


@pytest.mark.parametrize(("column", "level"), [("f_in_N", 74.0), ("f_out_N", 46.0)])
def test_noise_behind_the_end_of_a_range(column, level):
    noise = 0.1 * np.random.default_rng(4).standard_normal(N)
    remark = told(GOOD | {column: np.minimum(GOOD[column], level) + noise}, "clipped")
    assert remark.column == column
    assert number(remark, "level ", " in") == pytest.approx(level, rel=0.01)


@pytest.mark.parametrize(
    ("column", "size", "severity"),
    [("f_out_N", 0.8, "error"), ("f_out_N", -0.8, "warning"), ("x_out_mm", -0.1, "warning")],
)
def test_an_interference_that_follows_the_motor(column, size, severity):
    """A mass of the load, or a delay, makes a channel jump too, against the direction."""
    remark = told(jumping(column, size), "interference")
    jump = number(remark, "by ", f" {column.rsplit('_', 1)[1]}")
    assert jump == pytest.approx(2.0 * abs(size), rel=0.15)
    assert remark.severity == severity
    assert ("a delay, or" in remark.sentence) == (severity == "warning")
    assert ("mass of the load" in remark.sentence) == (column == "f_out_N" and size < 0.0)


def test_a_damped_load_jumps_by_half_of_what_an_interference_does():
    """It stops with the drive, and its force jumps again where it moves on."""
    remark = told(jumping("f_out_N", 0.8, driver="x_out_mm"), "interference")
    assert remark.severity == "warning"
    assert "damping of the load, or interference" in remark.sentence


@pytest.mark.parametrize("x_out", [None, 5.0])
def test_without_the_travel_of_the_load_a_jump_may_be_its_damping(x_out):
    """It was not recorded, or its sensor is dead."""
    taken = jumping("f_out_N", 0.8)
    del taken["x_out_mm"]
    if x_out is not None:
        taken["x_out_mm"] = x_out + 0.01 * np.random.default_rng(5).standard_normal(N)
    remark = told(taken, "interference")
    assert (remark.column, remark.severity) == ("f_out_N", "warning")


@pytest.mark.parametrize(("turns", "said"), [(5, True), (3, False)])
def test_three_jumps_that_are_alike_are_an_interference(turns, said):
    """The drive turns so often, and the load rests at three or less of these times."""
    speed = np.gradient(columns(Bench(noise_mm=0.0))["x_in_mm"], TIME)
    stop = np.flatnonzero(np.diff(np.sign(speed)) != 0.0)[turns] - 40
    cut = {n: v[:stop] for n, v in jumping("f_out_N", 0.8).items()}
    codes = {code for code, _ in remarks(cut)}
    assert ("interference" in codes) == said


@pytest.mark.parametrize(("first", "end"), [(-20, 250), (30, 130)])
def test_the_slope_changes_among_the_samples_that_are_lost(first, end):
    """By a reversal, or as the drive gains speed: nothing tells how many they are."""
    x_in = GOOD["x_in_mm"]
    turn = 400 + int(np.argmax(x_in[400:1400]))
    kept = np.delete(np.arange(N), range(turn + first, turn + end))
    remark = told(rows_of(kept), "lost-samples")
    assert "jump from one row to the next" in remark.sentence
    assert remark.first_s == pytest.approx(TIME[turn + first - 1], abs=1e-9)


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_a_radius_taken_for_a_diameter(factor):
    both = {name: factor * GOOD[name] for name in ("x_in_mm", "x_out_mm")}
    remark = told(GOOD | both, "unit")
    assert remark.severity == "error"
    assert "of a wheel for its" in remark.sentence
