"""The file of planned runs: what is read of it, and what is refused."""

import pytest

from tsas_cli.diagnosis.rig_file import Limits, PlannedRun, Sensors, read_rig_file
from tsas_cli.support.errors import InputError

TEXT = """
format = 1
kind = "plan"
name = "bench"

[rig]
friction_coefficient = 0.125

[sensors]
rate_Hz = 100
x_in_mm = 0.01
f_in_N = 0.1

[[run]]
id = "a"
sheath_length_mm = 785.4
total_bend_rad = 3.1416
preload_N = 25.0
motion = "sine"
amplitude_mm = 10.0
frequency_Hz = 0.25
"""


def read(tmp_path, text):
    path = tmp_path / "rig.toml"
    path.write_text(text, encoding="utf-8")
    return read_rig_file(path)


def test_a_frequency_means_a_highest_speed(tmp_path):
    (run,) = read(tmp_path, TEXT).run
    assert run.speed == pytest.approx(10.0 * 2.0 * 3.14159265 * 0.25)
    (ramps,) = read(tmp_path, TEXT.replace("sine", "ramps")).run
    assert ramps.speed == pytest.approx(2.0 * 2.0 * 10.0 * 0.25)


def test_only_named_sensors_record(tmp_path):
    assert read(tmp_path, TEXT).sensors.outputs == {"f_in_N": 0.1}


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("frequency_Hz = 0.25", "", "one of speed_mm_per_s and frequency_Hz"),
        ("0.25", "0.25\nspeed_mm_per_s = 3.0", "only one of speed_mm_per_s and frequency_Hz may"),
        ('"sine"', '"nested"', "nested needs speed_mm_per_s"),
        ('"sine"', '"chirp"\ndwell_s = 1.0', "chirp has no dwell_s"),
        ('"sine"', '"sinus"', "run.a.motion"),
        ("f_in_N = 0.1", "", "one of f_in_N, f_out_N, x_out_mm is needed"),
        ("friction_coefficient", "friction_coeficient", "did you mean friction_coefficient?"),
        ("rate_Hz", "rate_hz", "did you mean rate_Hz?"),
        ("preload_N = 25.0", "preload_N = -1.0", "run.a.preload_N"),
    ],
)
def test_what_is_wrong_is_said(tmp_path, old, new, said):
    with pytest.raises(InputError, match=r"rig\.toml") as raised:
        read(tmp_path, TEXT.replace(old, new))
    assert said in raised.value.line()


@pytest.mark.parametrize(
    ("limits", "said"),
    [
        ("preload_N = [40.0, 15.0]", "limits.preload_N: expected values that increase"),
        ("preload_N = [15.0, 15.0]", "limits.preload_N: expected values that increase"),
        ("preload_N = [15.0, 40.0, 20.0]", "got 15, 40, 20"),
        ("total_bend_rad = [3.14, 1.57]", "limits.total_bend_rad: expected values that increase"),
        ("preload_N = [0.0, 40.0]", "limits.preload_N.0: expected 1e-06 to 1e+09 N"),
        ("preload_N = [-15.0, 40.0]", "limits.preload_N.0: expected 1e-06 to 1e+09 N"),
        ("total_bend_rad = [-1.57]", "limits.total_bend_rad.0: expected 0, or 1e-09 to 1e+06 rad"),
    ],
)
def test_limits_that_no_rig_has_are_refused(tmp_path, limits, said):
    """Reversed ones passed; a preload of 0 ended as a defect of the program."""
    with pytest.raises(InputError, match=r"rig\.toml") as raised:
        read(tmp_path, TEXT.replace("[sensors]", f"[limits]\n{limits}\n\n[sensors]"))
    assert said in raised.value.line()
    levels = "[limits]\npreload_N = [15.0, 40.0]\ntotal_bend_rad = [0.0]\n\n[sensors]"
    assert read(tmp_path, TEXT.replace("[sensors]", levels)).limits.preload_N == (15.0, 40.0)


def test_two_runs_of_one_name(tmp_path):
    with pytest.raises(InputError, match="duplicate run id 'a'"):
        read(tmp_path, TEXT + TEXT[TEXT.index("[[run]]") :])


CONDITIONS = {
    "id": "a",
    "sheath_length_mm": 785.0,
    "total_bend_rad": 3.0,
    "preload_N": 25.0,
    "motion": "sine",
    "amplitude_mm": 10.0,
    "speed_mm_per_s": 8.0,
}


SENSORS = {"rate_Hz": 100.0, "x_in_mm": 0.01, "f_in_N": 0.1}


@pytest.mark.parametrize(
    ("of", "usual", "name", "allowed", "not_allowed"),
    [
        *(
            (PlannedRun, CONDITIONS, name, 1e-6, 0.0)
            for name in ("sheath_length_mm", "preload_N", "amplitude_mm", "speed_mm_per_s")
        ),
        (PlannedRun, CONDITIONS, "total_bend_rad", 0.0, -1e-6),  # a straight sheath is one
        (PlannedRun, CONDITIONS, "periods", 1, 0),
        (PlannedRun, CONDITIONS, "periods", 10_000, 10_001),
        (PlannedRun, CONDITIONS, "dwell_s", 0.0, -1e-6),
        *((Sensors, SENSORS, name, 1e-6, 0.0) for name in ("rate_Hz", "f_in_N", "f_out_N")),
        (Sensors, SENSORS, "x_out_mm", 1e-6, 0.0),
        (Sensors, SENSORS, "x_in_mm", 0.0, -1e-6),  # a motor that knows its place
        *((Limits, {}, name, 1e-6, 0.0) for name in ("amplitude_mm", "speed_mm_per_s")),
    ],
)
def test_what_no_rig_has_is_refused(of, usual, name, allowed, not_allowed):
    assert getattr(of(**usual | {name: allowed}), name) == allowed
    with pytest.raises(ValueError, match=name):
        of(**usual | {name: not_allowed})


def test_frequencies_above_0_and_two_periods_unless_said():
    frequent = CONDITIONS | {"speed_mm_per_s": None, "frequency_Hz": 1e-6}
    assert PlannedRun(**frequent).frequency_Hz == 1e-6
    with pytest.raises(ValueError, match="frequency_Hz"):
        PlannedRun(**frequent | {"frequency_Hz": 0.0})
    assert (PlannedRun(**CONDITIONS).periods, PlannedRun(**CONDITIONS).dwell_s) == (2, 0.0)
    chirp = PlannedRun(**frequent | {"motion": "chirp", "frequency_Hz": 0.5})
    assert chirp.speed == pytest.approx(10.0 * 3.14159265)
    with pytest.raises(ValueError, match="id"):
        PlannedRun(**CONDITIONS | {"id": ""})


def test_no_run_is_no_plan(tmp_path):
    with pytest.raises(InputError, match="run"):
        read(tmp_path, "run = []\n" + TEXT[: TEXT.index("[[run]]")])


def test_limits_are_finite_and_known():
    with pytest.raises(ValueError, match="finite"):
        Limits(preload_N=(float("inf"),))
    with pytest.raises(ValueError, match="Extra inputs"):
        Limits(preload=(1.0,))


@pytest.mark.parametrize("name", ["a/b", "..", " a", "nul"])
def test_a_run_has_a_name_that_files_can_have(tmp_path, name):
    """Before, it was noticed when the run was simulated, as a defect."""
    with pytest.raises(InputError, match=r"run.0.id: .*, got") as stopped:
        read(tmp_path, TEXT.replace('id = "a"', f'id = "{name}"', 1))
    assert "\n" not in stopped.value.line()
