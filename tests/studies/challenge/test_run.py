"""Each case in a process of its own: one that fails or dies takes no other along."""

import json
import os

import pytest

from tests.studies.challenge.made import case, diagnosis, tool, write_set
from tsas_cli.support.errors import InputError
from tsas_studies.challenge.entry import read_entry
from tsas_studies.challenge.run import case_folders, run_cases
from tsas_studies.challenge.stages import run_set

NAMES = ("dies", "refuses", "silent", "threads", "well")


def test_what_went_wrong_is_written_down_and_the_others_answer(tmp_path, monkeypatch):
    """Each has one thread, and modules of its own: a re.py of somebody's lies beside the set."""
    for name in ("OPENBLAS_NUM_THREADS", "PYTHONSAFEPATH"):
        monkeypatch.delenv(name, raising=False)
    for name in ("re", "signal", "json"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('taken for a module')")
    monkeypatch.chdir(tmp_path)
    sealed = write_set(tmp_path / "set", {name: case() for name in NAMES})
    (sealed / "answers.json").unlink()  # a run does not need them
    steps = []
    log = run_cases(
        sealed, tmp_path / "entry", workers=2, diagnose=tool, step=lambda: steps.append(1)
    )
    assert len(steps) == len(NAMES)
    assert log == json.loads((tmp_path / "entry" / "entry.json").read_text(encoding="utf-8"))
    assert (log["answered"], log["tool"]) == (1, "tool")
    assert log["no_answer"].keys() == {*NAMES} - {"well"}
    assert log["no_answer"]["dies"] == "the process died"
    assert log["no_answer"]["refuses"] == "a.parquet: no such run"
    assert log["no_answer"]["threads"] == "RuntimeError: 1 threads"
    assert not {"OPENBLAS_NUM_THREADS", "PYTHONSAFEPATH"} & os.environ.keys()  # of the caller
    assert "diagnosis.json: cannot be read" in log["no_answer"]["silent"]
    entry = read_entry(tmp_path / "entry", NAMES)
    assert entry.no_answer == log["no_answer"]
    assert set(entry.diagnoses) == {"well"}
    well = json.loads((tmp_path / "entry" / "well" / "diagnosis.json").read_text(encoding="utf-8"))
    assert 0.0 <= well.pop("seconds") < 60.0
    assert well == diagnosis("backlash")


def test_an_entry_is_not_overwritten_unasked(tmp_path):
    sealed = write_set(tmp_path / "set", {"silent": case()})
    (tmp_path / "entry").mkdir()
    (tmp_path / "entry" / "mine").touch()
    with pytest.raises(InputError, match="already exists"):
        run_cases(sealed, tmp_path / "entry", workers=1, diagnose=tool)
    assert [path.name for path in (tmp_path / "entry").iterdir()] == ["mine"]


@pytest.mark.parametrize("linked", ["cases", "cases/a", "cases/a/dataset"])
def test_a_case_that_is_a_link_is_not_followed(tmp_path, linked):
    sealed, elsewhere = write_set(tmp_path / "set", {"a": case()}), tmp_path / "elsewhere"
    (sealed / linked).rename(elsewhere)
    (sealed / linked).symlink_to(elsewhere, target_is_directory=True)
    with pytest.raises(InputError, match="is a link; expected the folder of a case"):
        case_folders(sealed)


def test_a_set_without_cases(tmp_path):
    with pytest.raises(InputError, match="no cases/ID/dataset here"):
        run_cases(tmp_path, tmp_path / "entry", workers=1, diagnose=tool)


def test_somebody_has_to_do_the_work(tmp_path):
    with pytest.raises(InputError, match="workers is 0; expected 1 or more"):
        run_set(tmp_path, out=tmp_path / "entry", workers=0)
