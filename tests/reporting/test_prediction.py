import re

import pytest

import tsas_cli as tsas
from tests.comparing.made import NOMINAL, ROUGH, SENSORS, calibrated, clean
from tests.reporting.made_folders import edited, make_dataset, make_prediction
from tests.reporting.test_page import Outline, without_script
from tsas_cli.reporting.inputs import read_inputs
from tsas_cli.reporting.page import page
from tsas_cli.reporting.prediction import section
from tsas_studies.challenge.rig.recordings import Run, conditions, write_dataset
from tsas_studies.challenge.rig.sensors import measure

HOSTILE = "<script>$x$"


@pytest.fixture(scope="module")
def predicted(tmp_path_factory):
    """Two models, each of one of two rigs, that predict a run of both."""
    root = tmp_path_factory.mktemp("prediction")
    models = [calibrated(root, rig, seed=seed) for seed, rig in ((1, NOMINAL), (2, ROUGH))]
    runs = [
        Run(name, measure(clean(rig, 1.0), SENSORS, seed=20 + k), conditions(rig))
        for k, (name, rig) in enumerate((("a", NOMINAL), (HOSTILE, ROUGH)))
    ]
    write_dataset(root / "new", runs, name="bench & <b>")
    return tsas.predict(models, root / "new", out=root / "predicted")


@pytest.fixture(scope="module")
def folder(predicted):
    return predicted.out


@pytest.fixture(scope="module")
def text(folder):
    return page(read_inputs([folder]))


def test_the_loops_are_drawn_under_the_tables(folder, text):
    said = [label for label in Outline(text).labels if "measured and predicted" in label]
    assert len(said) == 4  # f_in and f_out of two runs
    assert any(re.search(r"RMSE: A [\d.]+ N, B [\d.]+ N", label) for label in said)
    made = section(read_inputs([folder]))
    captions = [table.caption for table in made.tables]
    assert captions == ["Models", "Predictions", "Ranges that the models were fitted to"]


def test_the_run_whose_predictions_differ_most_comes_first(predicted, folder):
    """Each model is right in one run; the other one then misses more."""
    ratios = {
        row.run: max(row.ratio, 1.0 / row.ratio)
        for row in predicted.record.channels
        if (row.channel, row.model) == ("f_in_N", "B")
    }
    first = max(ratios, key=ratios.get)
    assert section(read_inputs([folder])).groups[0].name == f"Run {first}"


def test_names_from_files_show_as_text_and_the_call_is_repeated(text):
    assert not re.search(r"https?://(?!www\.w3)|@import|<script", without_script(text))
    assert "&lt;script&gt;$x$" in text
    assert re.search(r"tsas predict \S+calibrated-1 \S+calibrated-2 \S+new --out", text)
    assert "B predicts best" in text or "A predicts best" in text


def test_a_file_that_says_less_makes_a_page_all_the_same(tmp_path):
    dataset = make_dataset(tmp_path / "data", ("a",), samples=400)
    folder = make_prediction(dataset, tmp_path / "predict")
    with edited(folder / "predict.json") as content:
        for row in content["channels"]:
            row["run"] = "b"
    assert section(read_inputs([folder])).groups == ()
    with edited(folder / "predict.json") as content:
        content |= {key: [] for key in ("channels", "ranges", "findings", "notes", "models")}
    assert section(read_inputs([folder])).groups == ()
    assert "Predicted, not fitted" in page(read_inputs([folder]))


def test_without_predictions_there_is_no_section(folder):
    assert section(read_inputs([folder.parent / "new"])) is None
