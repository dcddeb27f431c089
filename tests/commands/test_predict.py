import json
from functools import partial

import pytest

from tests.commands.documented import documented
from tests.comparing.made import NOMINAL, calibrated, recorded


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    root = tmp_path_factory.mktemp("predict")
    calibrated(root, NOMINAL, seed=1)
    recorded(root / "new", NOMINAL, seed=2)
    return root


@pytest.fixture(autouse=True)
def run(here, monkeypatch, root):
    monkeypatch.chdir(root)
    return partial(here, "predict")


def test_the_tables_say_how_far_and_whether_inside(run):
    code, out, err = run("calibrated-1", "calibrated-1/model.toml", "new", "--runs", "slow")
    assert (code, err) == (0, "")
    lines = [line.split() for line in out.splitlines()]
    assert ["B", "model", "calibrated-1/model.toml", "2", "recordings", "slip"] in lines
    (f_in,) = (line for line in lines if line[:3] == ["slow", "f_in_N", "A"])
    assert f_in[4] == "N"
    assert float(f_in[6]) < 1.5
    assert "Every run lies in the model's range (A and B)." in out
    assert "- Each run's own preload and zeros are fitted to it, and nothing else." in out


def test_out_holds_all_that_json_prints_and_the_keys_are_documented(run, tmp_path):
    out = tmp_path / "o"
    code, message, _ = run("calibrated-1", "new", "--as-is", "--out", out, "--json")
    assert code == 0
    assert sorted(p.name for p in out.iterdir()) == ["SHA256SUMS", "predict.json", "runs"]
    content = json.loads((out / "predict.json").read_text())
    assert json.loads(message) == content
    assert content["own_values_fitted"] is False
    assert set(content) <= documented("predict.json")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("calibrated-1",), "calibrated-1: one argument alone; expected MODEL… DATASET"),
        (("new", "calibrated-1"), "new: nothing that can be compared is here"),
        (("calibrated-1", "calibrated-1"), "calibrated-1: no dataset.toml here"),
        (("calibrated-1", "nowhere"), "nowhere: no dataset.toml here"),
        (("calibrated-1", "new", "--runs", "sl"), "no run 'sl'"),
        (("calibrated-1/calibration.json", "new"), "calibration.json: is not TOML"),
    ],
)
def test_a_wrong_call_is_one_line_and_writes_nothing(refused_here, tmp_path, words, message):
    assert message in refused_here("predict", *words, "--out", tmp_path / "o")
    assert list(tmp_path.iterdir()) == []
