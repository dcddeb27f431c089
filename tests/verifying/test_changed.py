"""What was edited in a stage's folder is told on top of the page, by `compare` and by `track`."""

import os
import re
import shutil
from pathlib import Path

import pytest

import tsas_cli as tsas
from tests.reporting.made_folders import edited
from tests.verifying.test_verify import chain, made  # noqa: F401 # fixtures
from tsas_cli.records.base import StageFile
from tsas_cli.records.plan import RunPlan  # noqa: F401 # loads its record
from tsas_cli.reporting import inputs  # noqa: F401 # loads those of the other stages
from tsas_cli.verifying.claims import change_notes
from tsas_cli.verifying.outputs import BESIDE

TOLD = "Changed since it was written: model/simulation.json."


def test_an_edited_number_is_told_on_top_of_the_page_and_in_a_comparison():
    folder = Path("result/model")
    assert change_notes([folder, folder / "model.toml", None, {}, Path("sine")]) == []
    with edited(folder / "simulation.json") as content:
        content["runs"]["a"]["channels"]["f_in_N"]["rmse"] *= 2.0
    tsas.report(["dataset", folder], out="page.html")
    page = Path("page.html").read_text(encoding="utf-8")
    assert TOLD in page[: page.index("<section")]
    notes = tsas.compare(folder, "result/simulate").record.notes
    assert [note for note in notes if note.startswith(TOLD)]
    assert change_notes([folder / "model.toml"]) == []


def test_an_edited_model_is_told_by_what_follows_with_it():
    model = Path("result/model/model.toml")
    text = model.read_text(encoding="utf-8")
    model.write_text(re.sub("value = 0.1", "value = 0.11", text, count=1), encoding="utf-8")
    settings = {"reference": {"duration_s": 0.1}, "loop": {"nodes": 5, "substeps": 1}}
    notes = tsas.track(model=model, settings=settings).record.notes
    assert any(note.startswith("Changed since it was written: model/model.toml.") for note in notes)


def test_a_list_that_says_nothing_and_a_file_that_is_gone_are_told():
    folder = Path("result/model")
    (folder / "runs/a.parquet").unlink()
    (note,) = change_notes([folder])
    assert note.startswith("Changed since it was written: model/runs/a.parquet.")
    (folder / "SHA256SUMS").write_text("")
    (note,) = change_notes([folder])
    assert note.startswith("Changed since it was written: model/SHA256SUMS.")


@pytest.mark.parametrize("replace", [lambda path: None, Path.mkdir, os.mkfifo])
def test_a_stage_without_its_list_is_told(replace):
    folder = Path("result/model")
    (folder / "SHA256SUMS").unlink()
    replace(folder / "SHA256SUMS")
    for given in (folder, folder / "model.toml"):
        (note,) = change_notes([given])
        assert note.startswith("Without a checksum: model/SHA256SUMS is missing.")
    (folder / "simulation.json").unlink()
    assert change_notes([folder, folder / "model.toml"]) == []  # a model that someone has written


@pytest.mark.parametrize("file", ["simulation.json", "model.toml", "runs/a.parquet"])
def test_a_file_that_the_list_no_longer_names_is_told(file):
    folder = Path("result/model")
    sums = folder / "SHA256SUMS"
    kept = [line for line in sums.read_text().splitlines(True) if not line.endswith(f" {file}\n")]
    sums.write_text("".join(kept))
    given = [folder, folder / file] if file == "model.toml" else [folder]
    for note in change_notes(given):
        assert note.startswith(f"Without a checksum: model/SHA256SUMS does not list {file}.")
    assert len(change_notes(given)) == len(given)
    tsas.report(["dataset", folder], out="page.html")
    assert "does not list" in Path("page.html").read_text(encoding="utf-8")
    for path in ("result", "page.html"):
        (one,) = tsas.verify(path).wrong
        assert (one.file, one.why) == (f"result/model/{file}", "SHA256SUMS does not list it")
    (folder / file).unlink()
    assert ("missing", f"result/model/{file}") in {
        (one.state, one.file) for one in tsas.verify("result").wrong
    } or file == "simulation.json"


def test_series_behind_a_circle_of_links_are_told():
    folder = Path("result/model")
    shutil.rmtree(folder / "runs")
    (folder / "runs").symlink_to("runs")
    tsas.report(["dataset", folder], out="page.html")
    assert "model/runs/a.parquet" in Path("page.html").read_text(encoding="utf-8")
    assert [one.state for one in tsas.verify(folder).wrong] == ["missing"]


def test_the_files_of_every_stage_are_known():
    kinds, known = [StageFile], set()
    while kinds:
        kind = kinds.pop()
        kinds += kind.__subclasses__()
        known |= {kind.FILE} if "FILE" in vars(kind) else set()
    assert known == set(BESIDE)
