"""A sample that stands out is found at any size, and so is a position that jumps alone."""

import numpy as np
import pytest

from tests.recordings.quality.bench import Bench, columns
from tests.recordings.quality.test_faults import GOOD, codes, found, remarks
from tsas_cli.recordings.quality.samples import outlying, size_of

N = GOOD["time_s"].size
ROWS = np.arange(2000)
TIME = ROWS / 500.0


def standing_out(values, time_s=TIME):
    """Return the rows that stand out of a channel."""
    return np.flatnonzero(outlying(time_s, values, size_of(values, time_s), most=1e6)).tolist()


def with_wild(name, rows, value):
    values = GOOD[name].copy()
    values[rows] += value
    return GOOD | {name: values}


@pytest.mark.parametrize("name", ["x_in_mm", "x_out_mm", "f_in_N", "f_out_N"])
@pytest.mark.parametrize("value", [8.0, -60.0, 1e3, -9e5, -9e8, 1e10, 3.4e38])
def test_one_wild_sample_is_found_in_each_channel_and_by_no_other_check(name, value):
    remark = found(with_wild(name, 1234, value), "outlier", name)
    assert remark.severity == "error"
    assert remark.first_s == GOOD["time_s"][1234]
    assert "1 sample far from" in remark.sentence
    assert remark.sentence.endswith("at 6.17 s, row 1234")


def test_zeros_that_a_drive_reads_now_and_then_are_found():
    x_in = columns(Bench(rate_Hz=100.0))["x_in_mm"]
    x_in[::97] = 0.0
    found(columns(Bench(rate_Hz=100.0)) | {"x_in_mm": x_in}, "outlier", "x_in_mm")


@pytest.mark.parametrize("rows", [[0], [N - 1], [7, 8, 9], [100, 101, 700, 1500]])
def test_a_few_are_counted_wherever_they_are(rows):
    remark = found(with_wild("f_in_N", rows, 500.0), "outlier", "f_in_N")
    assert f"{len(rows)} sample" in remark.sentence
    assert remark.first_s == GOOD["time_s"][rows[0]]


@pytest.mark.parametrize("noise", [0.0, 0.01])
@pytest.mark.parametrize("step", [0.0, 0.05])
def test_it_is_found_in_motion_without_noise_and_in_steps(noise, step):
    values = 10.0 * np.sin(6.0 * TIME) + noise * np.random.default_rng(1).standard_normal(TIME.size)
    values = np.round(values / step) * step if step else values
    assert standing_out(values) == []
    values[900] += 5.0
    assert standing_out(values) == [900]


@pytest.mark.parametrize(
    "values",
    [
        5.0 * np.abs((20.0 * TIME) % 2.0 - 1.0),  # a triangle with 50 samples a stroke
        5.0 * np.sign(np.sin(9.0 * TIME)),  # steps that stay
        np.where(TIME < 2.0, 0.0, 5.0),
        5.0 * ((7.0 * TIME) % 1.0),  # slow stick, fast slip
        np.clip(40.0 * np.sin(3.0 * TIME), -5.0, 5.0),
        np.round(np.sin(TIME)),  # three levels
        (np.arange(TIME.size) % 97 == 0) * 1.0,  # one bit flickers
        5.0 * np.sin(TIME * TIME * 150.0),  # up to four samples a period
        np.random.default_rng(2).standard_normal(TIME.size),
        np.random.default_rng(3).standard_t(3, TIME.size),
        np.cumsum(np.random.default_rng(4).standard_normal(TIME.size)),
        np.exp(-50.0 * (TIME % 1.0)) * np.cos(800.0 * TIME),  # blows that ring
        np.repeat(np.sin(6.0 * TIME[::4]), 4),  # held between updates
        np.zeros(TIME.size),
        (np.arange(TIME.size) == 700) * 0.1,  # one bit flickers once
        # What comes often is the signal.
        np.random.default_rng(5).standard_normal(TIME.size) + 200.0 * (ROWS % 30 == 0),
        # Two samples between gaps.
        np.where(ROWS % 40 < 2, 10.0 * np.sin(9.0 * TIME) * (np.abs(ROWS - 1000) < 900), np.nan),
    ],
    ids=str,
)
def test_motion_is_left_in_peace(values):
    assert standing_out(values) == []


def test_a_fast_rig_without_noise_is_left_in_peace():
    for shape in ("sine", "triangle", "chirp", "dwells", "nested", "decaying", "ramp"):
        measured = columns(Bench(shape=shape, noise_mm=0.0, noise_N=0.0, rate_Hz=20.0))
        time_s = measured.pop("time_s")
        assert [standing_out(v, time_s) for v in measured.values()] == [[]] * 4


def after(value):
    return np.where(np.arange(N) >= 1234, value, 0.0)


@pytest.mark.parametrize("name", ["x_in_mm", "x_out_mm"])
@pytest.mark.parametrize("value", [3.0, -40.0, 3e3])
def test_a_jump_of_one_position_is_said_with_its_row(name, value):
    jump = dict(remarks(GOOD | {name: GOOD[name] + after(value)}))["jump"]
    assert (jump.severity, jump.column, jump.first_s) == ("error", name, GOOD["time_s"][1234])
    assert "row 1234" in jump.sentence


def test_what_all_channels_do_what_comes_back_and_a_usual_step_are_no_jump_of_an_encoder():
    moved = {name: GOOD[name] + after(3.0) for name in ("x_in_mm", "x_out_mm")}
    assert "jump" not in codes(GOOD | moved | {"f_in_N": GOOD["f_in_N"] + after(20.0)})
    assert "jump" not in codes(with_wild("x_in_mm", 1234, 50.0))
    usual = float(np.abs(np.diff(GOOD["x_in_mm"])).max())
    assert "jump" not in codes(GOOD | {"x_in_mm": GOOD["x_in_mm"] + after(3.0 * usual)})
    assert "jump" not in codes(GOOD)
