import re
import shutil

import pytest

import tsas_cli as tsas
from tests.reporting.made_folders import edited, make_dataset, make_prediction, page_from
from tests.reporting.test_page import Outline, without_script
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model
from tsas_cli.identification.model_file import write_model
from tsas_cli.reporting.inputs import read_inputs
from tsas_cli.reporting.prediction import section

HOSTILE = "<script>$x$"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """What two models predict of two runs."""
    root = tmp_path_factory.mktemp("prediction")
    dataset = make_dataset(root / "new", ("a", HOSTILE), name="bench & <b>", samples=1000)
    models = {root / "smooth.toml": 0.125, root / "rough.toml": 0.2}
    for path, friction in models.items():
        one = Model((Estimate("friction_coefficient", friction, "1", "given"),))
        write_model(path, one, version="0", dataset={})
    return tsas.predict([*models], dataset, out=root / "predicted", fit_own=False).out


@pytest.fixture(scope="module")
def text(folder):
    return page_from(folder)


def test_the_loops_are_drawn_under_the_tables(folder, text):
    said = [label for label in Outline(text).labels if "measured and predicted" in label]
    assert len(said) == 4  # f_in and f_out of two runs
    assert any(re.search(r"RMSE: A [\d.]+ N, B [\d.]+ N", label) for label in said)
    captions = [table.caption for table in section(read_inputs([folder])).tables]
    assert captions == ["Models", "Predictions", "Ranges that the models were fitted to"]


@pytest.mark.usefixtures("undrawn")
def test_the_run_whose_predictions_differ_most_comes_first(folder, tmp_path):
    """Whichever model it is that misses more."""
    for first, ratios in ((HOSTILE, (0.5, 0.4)), (HOSTILE, (2.0, 3.0)), ("a", (0.4, 2.0))):
        changed = tmp_path / f"{ratios}"
        shutil.copytree(folder, changed / "predicted")
        shutil.copytree(folder.parent / "new", changed / "new")
        with edited(changed / "predicted" / "predict.json") as content:
            for row in content["channels"]:
                if row["model"] == "B":
                    row["ratio"] = ratios[row["run"] == HOSTILE]
        made = section(read_inputs([changed / "predicted"]))
        assert made.groups[0].name == f"Run {first}"


def test_names_from_files_show_as_text_and_the_call_is_repeated(text):
    assert not re.search(r"https?://(?!www\.w3)|@import|<script", without_script(text))
    assert "&lt;script&gt;$x$" in text
    assert re.search(r"tsas predict \S+smooth.toml \S+rough.toml \S+new .*--out", text)
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
    assert "Predicted, not fitted" in page_from(folder)
    assert section(read_inputs([dataset])) is None  # without predictions
