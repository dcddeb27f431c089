"""`tsas track` in a process of its own, and in this one where only its answer counts."""

import json

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from tests.commands.documented import documented
from tests.refusals import refusal
from tsas_cli.app import app
from tsas_cli.controllers import CONTROLLERS
from tsas_cli.recordings.dataset import read_dataset

QUICK = """
[reference]
duration_s = 2.0
mean_N = 44.0
angular_frequency_rad_per_s = 3.0
[sensor]
rate_Hz = 500
[loop]
nodes = 8
"""
CONDITIONS = ("undisturbed", "disturbed")


@pytest.fixture
def quick(tmp_path):
    """Return a function that writes quick settings, with more text behind them."""

    def write(more=""):
        path = tmp_path / "settings.toml"
        path.write_text(QUICK + more, encoding="utf-8")
        return path

    return write


@pytest.fixture
def track(capsys, tmp_path):
    """Return a function that runs the command in this process and returns its JSON."""

    def run(*options, out="out"):
        call = ["track", *map(str, options), "--out", str(tmp_path / out), "--json"]
        app(call, prog_name="tsas", standalone_mode=False)
        return json.loads(capsys.readouterr().out)

    return run


def test_it_writes_what_is_documented_and_a_dataset(done, quick, tmp_path):
    out = tmp_path / "out"
    call = ("track", "--settings", quick(), "--controller", "pid, adaptive-sliding-mode", "--json")
    summary = json.loads(done(*call, "--disturb", "friction_coefficient=0.16@1", "--out", out))
    assert summary == json.loads((out / "tracking.json").read_text(encoding="utf-8"))
    scores = summary["results"][0]["scores"]
    nested = {"shape", "file", "sha256", *scores, "mean", "sd", "unsettled_steps", "relay"}
    nested |= {"quantity", "value", "from_s", "controller", "condition", "run", "scores"}
    nested |= {"slip", "lugre", "printed_rmse_N"}
    assert set(summary) == documented("tracking.json") - nested
    assert summary["conditions"]["disturbed"] == [
        {"quantity": "friction_coefficient", "value": 0.16, "from_s": 1.0}
    ]
    assert summary["settings"]["file"] == "settings.toml"
    assert summary["settings"]["controllers"]["sliding-mode"]["c1"] == 800.0
    runs = {f"{name}-disturbed" for name in ("pid", "adaptive-sliding-mode")}
    assert {row["run"] for row in summary["results"]} == runs
    dataset = read_dataset(out)
    assert {run.id for run in dataset.runs} == runs
    done("check", out)


def test_a_recording_is_what_the_sensors_saw_at_their_rate(track, quick, tmp_path):
    scores = track("--settings", quick())["results"][0]["scores"]
    name = "adaptive-sliding-mode-undisturbed"
    table = pq.read_table(tmp_path / "out" / "runs" / f"{name}.parquet")
    column = {n: table.column(n).to_numpy() for n in table.column_names}
    np.testing.assert_allclose(np.diff(column["time_s"]), 0.002)
    assert len(column["time_s"]) == 1001
    error = column["f_out_ref_N"] - column["f_out_true_N"]
    assert scores["rmse_N"] == {"mean": pytest.approx(np.sqrt(np.mean(error**2))), "sd": None}
    assert np.std(column["f_out_N"] - column["f_out_true_N"]) == pytest.approx(0.05, rel=0.15)
    spring = 25.0 + 1.579 * column["x_out_mm"]
    assert np.std(spring - column["f_out_true_N"]) == pytest.approx(0.005 * 1.579, rel=0.15)
    assert np.abs(column["x_inv_mm"] - column["x_in_mm"]).max() < 1.0
    assert {"sliding_distance_mm_per_s2", "phi2_rpm_s_per_mm"} <= set(column)
    assert table.schema.field("motor_speed_rpm").metadata[b"unit"] == b"rpm"


def test_the_controllers_model_and_the_plant_are_two_files(track, quick, tmp_path):
    model, plant = tmp_path / "m.toml", tmp_path / "p.toml"
    text = "format = 1\n[parameters.friction_coefficient]\nvalue = {}\nunit = '1'\n"
    model.write_text(text.format(0.125), encoding="utf-8")
    plant.write_text(text.format(0.2), encoding="utf-8")
    rmse = {}
    for name, given in {
        "right": ("--model", plant),
        "wrong": ("--model", model, "--plant", plant),
        "none": (),
        "both": ("--model", model, "--plant", model),
    }.items():
        call = ("--settings", quick(), "--controller", "disturbance-observer", *given)
        rmse[name] = track(*call, out=name)["results"][0]["scores"]["rmse_N"]["mean"]
    assert rmse["both"] == rmse["none"]
    assert rmse["wrong"] > 1.2 * rmse["right"]


def rmse_of(summary):
    """Return the RMSE of each controller under each condition, in the table's order."""
    return {(r["controller"], r["condition"]): r["scores"]["rmse_N"] for r in summary["results"]}


def has_the_order_of_the_paper(rmse):
    for condition in CONDITIONS:
        mean = {name: rmse[name, condition]["mean"] for name in CONTROLLERS}
        assert mean["adaptive-sliding-mode"] < mean["sliding-mode"] < mean["pid"]


def test_the_comparison_has_the_papers_order(track):
    summary = track("--compare", "--seeds", "2")
    rmse = rmse_of(summary)
    assert list(rmse) == [(name, condition) for condition in CONDITIONS for name in CONTROLLERS]
    has_the_order_of_the_paper(rmse)
    for condition in CONDITIONS:
        adaptive = rmse["adaptive-sliding-mode", condition]["mean"]
        assert rmse["disturbance-observer", condition]["mean"] < 0.5 * adaptive
    assert all(number["sd"] > 0.0 for number in rmse.values())
    assert summary["seeds"] == [1, 2]
    assert summary["notes"] == []


def test_the_gains_as_printed_have_the_same_order_and_are_told_to_be_relays(track):
    summary = track("--compare", "--as-printed", "--seeds", "1")
    notes = summary["notes"]
    has_the_order_of_the_paper(rmse_of(summary))
    assert summary["gains"] == "as printed"
    assert sum("the loop is a relay" in note for note in notes) == 4
    assert not any("pid" in note or "observer" in note for note in notes)


def test_the_table_has_a_row_for_each_controller_and_condition(done, quick, tmp_path):
    call = ("--compare", "--seeds", "2", "--settings", quick(), "--out", tmp_path / "out")
    rows = [line for line in done("track", *call).splitlines() if "disturbed " in line]
    assert len(rows) == 2 * len(CONTROLLERS)
    assert all(row.count("±") == 6 for row in rows)


def test_a_controller_named_twice_runs_once(track, quick):
    assert len(track("--settings", quick(), "--controller", "pid,pid")["results"]) == 1


def test_a_reference_faster_than_the_motor_is_told(track, quick):
    slow = quick("[drive]\nspeed_limit_rpm = 600\n")
    notes = track("--settings", slow, "--controller", "disturbance-observer")["notes"]
    assert notes[0].startswith("the reference asks for more than the motor's 600 rpm in ")


def test_a_recorded_force_is_a_reference(track, quick, tmp_path):
    time_s = np.linspace(0.0, 1.0, 101)
    path = tmp_path / "wanted.parquet"
    pq.write_table(pa.table({"time_s": time_s, "f_out_N": 30.0 + 5.0 * time_s}), path)
    summary = track("--settings", quick(), "--reference", path)
    assert set(summary["reference"]) == {"file", "folder", "sha256"}
    run = tmp_path / "out" / "runs" / "adaptive-sliding-mode-undisturbed.parquet"
    wanted = pq.read_table(run).column("f_out_ref_N").to_numpy()
    np.testing.assert_allclose(wanted, np.linspace(30.0, 35.0, 501))


@pytest.mark.parametrize(
    ("more", "options", "message"),
    [
        ("", ("--controller", "pidd"), "unknown controller pidd; did you mean pid?"),
        ("", ("--controller", ""), "unknown controller ; known are pid, sliding-mode"),
        ("", ("--disturb", "friction=0.2"), "--disturb: unknown quantity friction"),
        ("[loops]\n", (), "settings.toml: unknown key loops"),
    ],
)
def test_what_is_wrong_is_reported_and_nothing_is_written(
    track, quick, tmp_path, more, options, message
):
    assert message in refusal(track, "--settings", quick(more), *options)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["settings.toml"]
