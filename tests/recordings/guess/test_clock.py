import numpy as np
import pytest

from tests.recordings.guess.rig_files import judged, run, sources, write_csv, write_run
from tsas_cli.recordings.guess.proposal import propose


@pytest.mark.parametrize("other", [1, 2, 3, 4])
def test_a_time_that_is_none_is_not_believed(path, other):
    names = ["time", "x_in", "x_out", "f_in", "f_out"]
    names[0], names[other] = names[other], names[0]
    found = judged(path, names)
    assert "wrong" not in found.values()
    assert found["time_s"] == "open"


@pytest.mark.parametrize(
    ("name", "factor", "expected"),
    [
        ("time", 1.0, {"source": "time", "unit": "s"}),
        ("t", 1e3, {"source": "t", "unit": "ms"}),
        ("Time [ms]", 1.0, {"source": "Time [ms]", "unit": "?"}),  # 100 kHz in all of 12 ms
        ("Time [s]", 1e6, {"source": "Time [s]", "unit": "?"}),
        ("Sample", 100.0, {"rate_Hz": "?"}),
    ],
)
def test_the_unit_of_the_clock_has_to_make_sense(path, name, factor, expected):
    others = [(n, run()[n]) for n in ("x_in_mm", "f_in_N")]
    write_csv(path, [(name, run()["time_s"] * factor), *others])
    assert propose([path]).channels[0].entry == expected


@pytest.mark.parametrize(
    ("step", "first", "unit"),
    [
        (1_000_000, 0, "ns"),  # 1 kHz; in microseconds it were 1 Hz
        (10_000_000, 1_772_532_000_000_000_000, "ns"),  # since 1970
        (50_000, 1_772_532_000_000_000, "us"),  # 20 Hz; as nanoseconds it were 20 kHz, in 1970
        (10, 1_772_532_000_000, "ms"),
        (50_000, 0, "?"),
    ],
)
def test_the_unit_of_a_clock_follows_from_its_steps_and_its_date(path, step, first, unit):
    rows = zip(run()["x_in_mm"], run()["f_in_N"], strict=True)
    lines = [f"{first + i * step},{x:.7g},{f:.7g}" for i, (x, f) in enumerate(rows)]
    path.write_text("\n".join(["stamp,x_in [mm],f_in [N]", *lines]))
    assert propose([path]).channels[0].entry["unit"] == unit


@pytest.mark.parametrize(("every_s", "unit"), [(0.01, "s"), (1.001, "?")])
def test_a_clock_of_a_slow_logger_is_asked_about(path, every_s, unit):
    named = [(f"{n} [{n[5:]}]", run(step=40)[n]) for n in ("x_in_mm", "f_in_N")]
    write_csv(path, [("t", np.arange(named[0][1].size) * every_s), *named])
    assert propose([path]).channels[0].entry["unit"] == unit


def test_a_clock_that_repeats_its_times_is_found_and_asked_about(path):
    columns = list(run().values())
    columns[0] = np.repeat(columns[0][::4], 4)[: columns[0].size]
    write_csv(path, [("", values) for values in columns])
    proposal = propose([path])
    assert proposal.channels[0].entry["source"] == 1
    assert proposal.read["repeated_times"][0] == "?"


def test_a_number_of_the_stroke_is_no_clock(path):
    columns = list(run().values())
    columns[0] = np.arange(columns[0].size) // 100
    write_csv(path, [("", values) for values in columns])
    assert propose([path]).channels[0].entry == {"rate_Hz": "?"}


@pytest.mark.parametrize("name", ["tout", "Tout", "T out"])
def test_a_tension_by_its_name_that_rises_evenly_is_a_clock(path, name):
    write_run(path, time_s=name, x_in_mm="x_in_mm", f_in_N="f_in_N")
    assert sources(path)["time_s"] == name
    assert "f_out_N" not in sources(path)


def test_a_clock_in_an_unknown_form_is_named_in_the_question(path):
    some = zip(run()["x_in_mm"], run()["f_in_N"], strict=True)
    rows = [f"3/3/2026 2:05:06.{i:03} PM,{x},{f}" for i, (x, f) in enumerate(some)]
    path.write_text("\n".join(["Time,x_in [mm],f_in [N]", *rows]))
    question = propose([path]).questions["columns.time_s.rate_Hz"]
    assert "Time cannot be used as the clock: column Time holds '3/3/2026" in question
