"""`tsas close-loop` in a process of its own, with every warning an error."""

import json
from types import SimpleNamespace

import pytest

from tests.commands.documented import documented
from tsas_cli.identification.model import CORRECTION
from tsas_cli.identification.model_file import read_model
from tsas_cli.recordings.dataset import read_dataset
from tsas_studies.commands.close_loop import _of_each_case


def rmse(row, model):
    return row["models"][model]["rmse_N"]["mean"]


@pytest.fixture
def slow(tmp_path):
    """Settings of a loop that is quickly simulated."""
    path = tmp_path / "slow.toml"
    path.write_text("[sensor]\nrate_Hz = 320.0\n[loop]\nnodes = 10\n")
    return path


def test_wear_is_named_and_the_extended_model_tracks_as_the_true_one_does(strict, tmp_path, slow):
    out = tmp_path / "out"
    call = ("close-loop", "--cases", "friction_drift", "--seeds", "1", "--out", out, "--json")
    done = strict(*call, "--settings", slow)
    assert (done.returncode, done.stderr) == (0, "")
    summary = json.loads(done.stdout)
    assert json.loads((out / "closing.json").read_text(encoding="utf-8")) == summary
    case = summary["cases"][0]
    assert set(summary) | {"controllers"} == documented("closing.json")
    runs = {run.id for run in read_dataset(out / "friction_drift" / "dataset").manifest.run}
    assert runs == {"slow", "middle", "fast"}

    named = {e for cause in case["named"] for e in (cause["effect"], *cause["rivals"])}
    assert "friction_drift" in named
    observer = next(r for r in case["controllers"] if r["controller"] == "disturbance-observer")
    assert observer["over_limit"] == rmse(observer, "extended") / rmse(observer, "true")
    assert observer["over_limit"] < 1.1
    assert rmse(observer, "extended") < 0.5 * rmse(observer, "data sheet")
    assert rmse(observer, "extended") < 0.2 * rmse(observer, "calibrated")

    done = strict("report", out, "--out", tmp_path / "page.html", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    assert json.loads(done.stdout)["read"] == {"closing.json": str(out)}

    # The extended model's preloads are its own, also for runs that it has not seen.
    calibrated = read_model(out / "friction_drift" / "calibrate").value(CORRECTION)
    extended = read_model(out / "friction_drift" / "diagnose" / "model-extended.toml")
    assert abs(extended.value(CORRECTION)) < 0.01 < 0.05 < abs(calibrated)
    nominal = read_model(out / "friction_drift" / "diagnose" / "model-nominal.toml")
    effects = [
        {e.name.split(".")[0] for e in m.estimates if "." in e.name} for m in (extended, nominal)
    ]
    assert effects[0] - effects[1] == {cause["effect"] for cause in case["named"]}


def test_where_nothing_is_hidden_nothing_is_named_and_nothing_changes(strict, tmp_path, slow):
    call = ("close-loop", "--hide", "friction_coefficient=0.125", "--seeds", "1")
    done = strict(*call, "--settings", slow, "--out", tmp_path / "out", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    case = json.loads(done.stdout)["cases"][0]
    assert (case["verdict"], case["named"]) == ("sufficient", [])
    for row in case["controllers"]:
        values = [rmse(row, model) for model in row["models"]]
        assert max(values) - min(values) < 0.005  # N, of a range of 36


@pytest.mark.parametrize(
    ("option", "value", "message"),
    [
        ("--cases", "backlsh", "did you mean backlash?"),
        ("--hide", "friction_coeficient=3", "did you mean friction_coefficient?"),
        ("--hide", "backlash.play_mm=0.1@3", "begins with the run"),
        ("--hide", "backlash.play_mm=-1", "expected 0 to 20 mm"),
        ("--hide", "backlash.play_mm", "expected NAME=VALUE"),
    ],
)
def test_a_wrong_call_writes_nothing(strict, tmp_path, option, value, message):
    done = strict("close-loop", option, value, "--out", tmp_path / "out")
    assert done.returncode == 2
    assert message in done.stderr
    assert option in done.stderr
    assert not (tmp_path / "out").exists()


def test_each_case_shows_what_its_stages_wrote(tmp_path, monkeypatch):
    for path in ("bend/dataset", "bend/calibrate", "bend/diagnose", "drive/dataset"):
        (tmp_path / path).mkdir(parents=True)
    (tmp_path / "drive" / "identify").mkdir()
    cases = SimpleNamespace(cases=[SimpleNamespace(case=name) for name in ("bend", "drive")])
    monkeypatch.setattr("tsas_cli.reporting.inputs.read_stage", lambda *_: cases)
    shown = {home.name: [path.name for path in paths] for home, paths in _of_each_case(tmp_path)}
    assert shown == {
        "bend": ["dataset", "calibrate", "diagnose"],
        "drive": ["dataset", "identify"],
    }
