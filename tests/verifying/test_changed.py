"""What was edited in a stage's folder is told on top of the page, by `compare` and by `track`."""

import re
from pathlib import Path

import tsas_cli as tsas
from tests.reporting.made_folders import edited
from tests.verifying.test_verify import chain, made  # noqa: F401 # fixtures
from tsas_cli.verifying.claims import change_notes

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
    (folder / "SHA256SUMS").unlink()
    assert change_notes([folder]) == []
