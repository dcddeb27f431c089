"""`tsas compare` and `tsas predict`."""

import json
from functools import partial

import pytest

from tests.commands.documented import documented


@pytest.fixture(autouse=True)
def run(here, monkeypatch, calibrations):
    monkeypatch.chdir(calibrations)
    return here


def test_the_table_says_what_differs(run):
    code, out, err = run("compare", "calibrated-1", "calibrated-2")
    assert (code, err) == (0, "")
    (row,) = (line.split() for line in out.splitlines() if "yes" in line)
    assert row[:2] == ["friction_coefficient", "all"]
    assert float(row[2]) == pytest.approx(0.125, rel=1e-3)
    assert "friction_coefficient is larger in B" in out
    assert "- A and B were fitted to different recordings" in out


def test_the_tables_say_how_far_a_prediction_is_and_whether_inside(run):
    call = ("calibrated-1", "calibrated-1/model.toml", "again", "--runs", "slow")
    code, out, err = run("predict", *call)
    assert (code, err) == (0, "")
    lines = [line.split() for line in out.splitlines()]
    assert ["B", "model", "calibrated-1/model.toml", "2", "recordings", "slip"] in lines
    (f_in,) = (line for line in lines if line[:3] == ["slow", "f_in_N", "A"])
    assert f_in[4] == "N"
    assert float(f_in[6]) < 1.5
    assert "Every run lies in the model's range (A and B)." in out
    assert "- Each run's own preload and zeros are fitted to it, and nothing else." in out


MODELS = ("calibrated-1/model.toml", "calibrated-2/model.toml")
WRITTEN = {
    "compare": (*MODELS, "--on", "data-2", "--runs", "slow"),
    "predict": ("calibrated-1", "again", "--as-is"),
}


@pytest.mark.parametrize(
    ("command", "beside"), [("compare", {"report.html"}), ("predict", {"runs"})]
)
def test_out_holds_all_that_json_prints_and_the_keys_are_documented(run, tmp_path, command, beside):
    out, name = tmp_path / "o", f"{command}.json"
    code, message, _ = run(command, *WRITTEN[command], "--out", out, "--json")
    assert code == 0
    assert {path.name for path in out.iterdir()} == {"SHA256SUMS", name} | beside
    content = json.loads((out / name).read_text())
    assert json.loads(message) == content
    assert set(content) <= documented(name)
    if command == "predict":
        assert content["own_values_fitted"] is False
        return
    assert {row["run_a"] for row in content["errors"]} == {"slow"}
    assert content["on"]["chosen"] == ["slow"]
    page = (out / "report.html").read_text()
    assert page.startswith("<!DOCTYPE html>")
    assert "tsas compare calibrated-1/model.toml" in page


COMPARE = partial(pytest.param, "compare")
PREDICT = partial(pytest.param, "predict")


@pytest.mark.parametrize(
    ("command", "words", "message"),
    [
        COMPARE(("calibrated-1", "nowhere"), "nowhere: nothing that can be compared is here"),
        COMPARE(("calibrated-1", "calibrated-2", "--runs", "slow"), "add --on"),
        COMPARE(("calibrated-1", "calibrated-2", "--fit-own"), "No such option: --fit-own"),
        COMPARE(("calibrated-1", "calibrated-2", "--on", "data-1", "--runs", "sl"), "no run 'sl'"),
        PREDICT(("calibrated-1",), "calibrated-1: one argument alone; expected MODEL… DATASET"),
        PREDICT(("calibrated-1", "calibrated-1"), "calibrated-1: no dataset.toml here"),
        PREDICT(("calibrated-1", "again", "--runs", "sl"), "no run 'sl'"),
        PREDICT(("calibrated-1/calibration.json", "again"), "calibration.json: is not TOML"),
    ],
)
def test_a_wrong_call_is_one_line_and_writes_nothing(
    refused_here, tmp_path, command, words, message
):
    assert message in refused_here(command, *words, "--out", tmp_path / "o")
    assert list(tmp_path.iterdir()) == []
