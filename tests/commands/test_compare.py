import json
from functools import partial

import pytest

from tests.commands.documented import documented
from tests.comparing.made import NOMINAL, ROUGH, calibrated


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    root = tmp_path_factory.mktemp("compare")
    calibrated(root, NOMINAL, seed=1)
    calibrated(root, ROUGH, seed=2)
    return root


@pytest.fixture(autouse=True)
def run(here, monkeypatch, root):
    monkeypatch.chdir(root)
    return partial(here, "compare")


def test_the_table_says_what_differs(run):
    code, out, err = run("calibrated-1", "calibrated-2")
    assert (code, err) == (0, "")
    (row,) = (line.split() for line in out.splitlines() if "yes" in line)
    assert row[:2] == ["friction_coefficient", "all"]
    assert float(row[2]) == pytest.approx(0.125, rel=1e-3)
    assert "friction_coefficient is larger in B" in out
    assert "- A and B were fitted to different recordings" in out


def test_out_holds_the_page_and_all_that_json_prints(run, tmp_path):
    out = tmp_path / "compared"
    models = ("calibrated-1/model.toml", "calibrated-2/model.toml")
    code, message, _ = run(*models, "--on", "data-2", "--runs", "slow", "--out", out, "--json")
    assert code == 0
    assert {path.name for path in out.iterdir()} == {"SHA256SUMS", "compare.json", "report.html"}
    content = json.loads((out / "compare.json").read_text())
    assert json.loads(message) == content
    assert set(content) <= documented("compare.json")
    assert {row["run_a"] for row in content["errors"]} == {"slow"}
    assert content["on"]["chosen"] == ["slow"]
    page = (out / "report.html").read_text()
    assert page.startswith("<!DOCTYPE html>")
    assert "tsas compare calibrated-1/model.toml" in page


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("calibrated-1", "nowhere"), "nowhere: nothing that can be compared is here"),
        (("calibrated-1", "data-1"), "data-1: nothing that can be compared is here"),
        (("calibrated-1", "calibrated-2", "--runs", "slow"), "add --on"),
        (("calibrated-1", "calibrated-2", "--fit-own"), "No such option: --fit-own"),
        (("calibrated-1", "calibrated-2", "--on", "data-1", "--runs", "sl"), "no run 'sl'"),
    ],
)
def test_a_wrong_call_is_one_line_and_writes_nothing(refused_here, tmp_path, words, message):
    assert message in refused_here("compare", *words, "--out", tmp_path / "o")
    assert list(tmp_path.iterdir()) == []
