import json

import pytest

from tests.reporting.made_folders import make_calibration, make_dataset, source
from tsas_cli.comparing.sides import read_side
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model
from tsas_cli.identification.model_file import write_model
from tsas_cli.identification.quantities import BRISTLES
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.support.errors import InputError

FRICTION = Estimate("friction_coefficient", 0.125, "1", "fitted")
LENGTH = Estimate("free_tendon.distal_length_mm", 60.0, "mm", "fitted")
PLAY = Estimate("backlash.play_mm", 0.1, "mm", "fitted")
BRISTLE = Estimate(BRISTLES[0].name, 100.0, BRISTLES[0].unit, "fitted")


@pytest.fixture
def calibration(tmp_path):
    """The folder of a calibration with two runs, its dataset beside it."""
    dataset = make_dataset(tmp_path / "data", ("a", "b"), samples=50)
    folder = make_calibration(dataset, tmp_path / "calibrated")
    read = source(dataset, folder)
    write_model(folder / "model.toml", Model((FRICTION,)), version="0", dataset=read)
    return folder


def tell(folder, **content):
    path = folder / "calibration.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | content))


def written(path, *estimates, **dataset):
    write_model(path, Model(estimates), version="0", dataset=dataset)
    return path


def test_a_folder_is_recognised_by_its_file_and_brings_its_model(calibration):
    side = read_side(calibration)
    assert (side.kind, side.dynamics, side.not_converged) == ("calibration", "slip", "")
    assert set(side.files) == {"calibration.json", "model.toml"}
    runs = read_dataset(calibration.parent / "data").runs
    assert side.recordings == {run.id: run.sha256 for run in runs}
    assert side.dataset is not None


def test_only_the_runs_that_were_chosen_count(calibration):
    tell(calibration, chosen=["b"])
    side = read_side(calibration)
    assert set(side.recordings) == {"b"}
    assert [run.id for run in side.dataset.runs] == ["b"]


def test_conditions_that_were_told_are_those_of_the_runs(calibration):
    tell(calibration, conditions={"total_bend_rad": 1.5})
    assert {run.total_bend_rad for run in read_side(calibration).dataset.runs} == {1.5}
    model = read_side(calibration / "model.toml")
    assert 1.5 not in {run.total_bend_rad for run in model.dataset.runs}


def test_a_fit_that_did_not_converge_says_so(calibration):
    tell(calibration, fit={"converged": False, "message": "it wandered."})
    assert read_side(calibration).not_converged == "it wandered."


def test_the_model_in_a_stage_s_folder_is_a_model_file_too(calibration):
    side = read_side(calibration / "model.toml")
    assert side.kind == "model"
    assert set(side.recordings) == {"a", "b"}
    (calibration / "calibration.json").unlink()
    assert read_side(calibration) == side


def test_without_the_dataset_runs_are_named_after_their_files(tmp_path):
    hashes = {"dataset.toml": "0", "runs/a.parquet": "AB", "runs/b.parquet": "cd"}
    path = written(tmp_path / "m.toml", FRICTION, name="x", folder="gone", hashes=hashes)
    side = read_side(path)
    assert side.recordings == {"a": "ab", "b": "cd"}
    assert (side.dataset, "no longer at" in side.gone) == (None, True)
    chosen = {"name": "x", "folder": "gone", "hashes": hashes, "chosen": ["b"]}
    assert read_side(written(path, FRICTION, **chosen)).recordings == {"b": "cd"}


def test_effects_stand_in_the_order_of_the_file_and_bristles_ask_for_the_dynamic_model(tmp_path):
    side = read_side(written(tmp_path / "m.toml", FRICTION, LENGTH, PLAY, BRISTLE))
    assert side.effects == ("free_tendon", "backlash")
    assert (side.dynamics, side.recordings) == ("lugre", None)


def test_a_folder_without_its_model_is_refused(calibration):
    (calibration / "model.toml").unlink()
    with pytest.raises(InputError, match=r"model\.toml"):
        read_side(calibration)
