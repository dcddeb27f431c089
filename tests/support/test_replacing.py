"""What `--force` may replace: an earlier output of the same stage, and never what is read."""

import json
import os
import re
from pathlib import Path

import pytest

from tests.outputs import file_of, fill, folder_of, make_output, refused
from tsas_cli.support import temporaries
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import new_folder, stage_folder, write_sums
from tsas_cli.support.replacing import sealed


def files(folder: Path) -> list[str]:
    return sorted(p.relative_to(folder).as_posix() for p in folder.rglob("*") if not p.is_dir())


@pytest.mark.parametrize("exchanges", [True, False], ids=["exchanging names", "renaming"])
def test_an_earlier_output_is_replaced_and_nothing_of_it_is_kept(tmp_path, monkeypatch, exchanges):
    if not exchanges:
        monkeypatch.setattr(temporaries, "_exchanged", lambda *_: False)
    out = tmp_path / "out"
    make_output(out, result="old", left="old")
    (out / ".DS_Store").write_text("of a desktop")
    with folder_of(out, force=True) as folder:
        fill(folder, result="new")
        assert files(out) == [".DS_Store", "SHA256SUMS", "check.json", "left", "result"]
    assert files(tmp_path) == ["out/check.json", "out/result"]
    assert (out / "result").read_text() == "new"


def test_recordings_are_not_replaced(tmp_path):
    (tmp_path / "dataset" / "runs").mkdir(parents=True)
    (tmp_path / "dataset" / "dataset.toml").write_text("format = 1")
    refused(folder_of(tmp_path / "dataset", force=True), "not an earlier output of `tsas check`")
    assert files(tmp_path) == ["dataset/dataset.toml"]


@pytest.mark.parametrize(
    "summary",
    [
        {"check.json": {"stage": "calibrate"}},
        {"calibration.json": {"stage": "calibrate"}, "task.json": {"stage": "sweep"}},
        {"check.json": {"stage": "check"}, "task.json": {"stage": "sweep"}},
        {"check.json": ["check"]},
        {},
    ],
)
def test_an_output_of_another_stage_is_not_replaced(tmp_path, summary):
    for name, content in summary.items():
        (tmp_path / name).write_text(json.dumps(content))
    (tmp_path / "model.toml").write_text("mine")
    write_sums(tmp_path)
    refused(folder_of(tmp_path, force=True), "not an earlier output of `tsas check`")


def test_the_task_of_a_sweep_is_replaced_by_the_sweep_alone(tmp_path):
    for name, stage in (("check.json", "check"), ("task.json", "sweep")):
        (tmp_path / "task" / name).parent.mkdir(exist_ok=True)
        (tmp_path / "task" / name).write_text(json.dumps({"stage": stage}))
    write_sums(tmp_path / "task")
    refused(folder_of(tmp_path / "task", force=True), "not an earlier output")
    with stage_folder(tmp_path / "task", stage="sweep", inputs=(), force=True):
        pass
    assert files(tmp_path) == ["task/SHA256SUMS"]


@pytest.mark.parametrize("more", ["notes.txt", "raw/a.csv", "runs/mine.txt", ".git/config"])
def test_what_the_stage_has_not_written_stays(tmp_path, more):
    out = tmp_path / "out"
    make_output(out)
    (out / more).parent.mkdir(exist_ok=True)
    (out / more).write_text("mine")
    refused(folder_of(out, force=True), rf"has not written \({re.escape(more)}\)")
    assert (out / more).read_text() == "mine"


def test_what_is_put_there_while_the_stage_works_stays(tmp_path):
    make_output(tmp_path / "out")
    with (
        pytest.raises(InputError, match="has not written"),
        folder_of(tmp_path / "out", force=True),
    ):
        (tmp_path / "out" / "notes.txt").write_text("mine")
    assert (tmp_path / "out" / "notes.txt").read_text() == "mine"


def test_a_link_to_a_folder_is_a_thing_of_its_own(tmp_path):
    make_output(tmp_path / "out")
    (tmp_path / "data").mkdir()
    (tmp_path / "out" / "data").symlink_to(tmp_path / "data")
    refused(folder_of(tmp_path / "out", force=True), r"has not written \(data\)")


MANIFEST = """
format = 1
[[run]]
id = "a"
file = "runs/a.parquet"
{more}
[ingest]
sources = {{ a = {{}} }}
"""


def ingest_into(path: Path):
    return new_folder(path, stage="ingest", inputs=(), force=True)


def make_dataset(folder: Path, more: str = "") -> None:
    (folder / "runs").mkdir(parents=True)
    (folder / "dataset.toml").write_text(MANIFEST.format(more=more))
    (folder / "runs" / "a.parquet").write_text("a")


def test_a_dataset_that_was_ingested_is_replaced_by_ingest(tmp_path):
    make_dataset(tmp_path / "dataset")
    with ingest_into(tmp_path / "dataset") as folder:
        (folder / "dataset.toml").write_text("new")
    assert files(tmp_path) == ["dataset/dataset.toml"]


def test_what_was_edited_in_an_output_since_it_was_written_stays(tmp_path):
    out = tmp_path / "out"
    make_output(out, result="old")
    (out / "result").write_text("mine")
    refused(folder_of(out, force=True), "result: has changed since it was written")
    assert (out / "result").read_text() == "mine"


@pytest.mark.parametrize("edit", [("?", "2"), ("b = 1\n", "")])
def test_a_file_or_a_manifest_that_was_edited_stays(tmp_path, edit):
    head = MANIFEST.format(more="") + "# mine\na = '?'\nb = 1\n"
    for text in (sealed(head).replace(*edit), sealed(head) + "# more\n"):
        (tmp_path / "map.toml").write_text(text)
        (tmp_path / "dataset.toml").write_text(text)
        refused(file_of(tmp_path / "map.toml", force=True), "has changed since it was written")
        (tmp_path / "map.toml").unlink()
        refused(ingest_into(tmp_path), "dataset.toml: has changed since it was written")
    (tmp_path / "map.toml").write_text(sealed(head))
    with file_of(tmp_path / "map.toml", force=True) as page:
        page.write_text("new")


def test_a_recording_of_a_dataset_that_was_edited_stays(tmp_path):
    make_dataset(tmp_path / "dataset", f'sha256 = "{"0" * 64}"')
    refused(ingest_into(tmp_path / "dataset"), r"a\.parquet: has changed since it was written")


def test_a_run_that_somebody_has_added_to_a_dataset_stays(tmp_path):
    make_dataset(tmp_path / "dataset", '[[run]]\nid = "b"\nfile = "runs/b.parquet"')
    (tmp_path / "dataset" / "runs" / "b.parquet").write_text("mine")
    refused(ingest_into(tmp_path / "dataset"), r"has not written \(runs/b\.parquet\)")


@pytest.mark.parametrize("text", ["format = 1", "=", "[ingest]\nsources = 1", "[[run]]\n[ingest]"])
def test_a_dataset_that_was_made_otherwise_is_not_replaced_by_ingest(tmp_path, text):
    make_dataset(tmp_path / "dataset")
    (tmp_path / "dataset" / "dataset.toml").write_text(text)
    refused(ingest_into(tmp_path / "dataset"), "not an earlier output of `tsas ingest`")


def test_a_file_is_replaced_where_it_has_the_mark_of_an_earlier_one(tmp_path):
    (tmp_path / "page.html").write_text("<!-- mine -->" + "x" * 10_000)
    with file_of(tmp_path / "page.html", force=True) as page:
        page.write_text("new")
    assert (tmp_path / "page.html").read_text() == "new"
    refused(file_of(tmp_path / "page.html", force=True), "not an earlier output of this command")
    assert (tmp_path / "page.html").read_text() == "new"


def test_a_device_or_a_pipe_is_never_replaced(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to(os.devnull)
    for name in ("pipe", "link"):
        for new in (folder_of, file_of):
            refused(new(tmp_path / name, force=True), "is a device or a pipe")
    assert (tmp_path / "pipe").is_fifo()
    assert (tmp_path / "link").is_symlink()


@pytest.fixture
def read(tmp_path):
    """Return a folder that is read, an earlier output of the same stage, with links to it."""
    read = tmp_path / "home" / "read"
    make_output(read, result="mine")
    make_output(read / "inner", result="mine")
    (read / "page").write_text("mine")
    (tmp_path / "link").symlink_to(read)
    (tmp_path / "file").symlink_to(read / "page")
    return read


SAME = ["home/read", "home/../home/read", "link", "home/read/inner/.."]
WITHIN = ["home/read/inner", "link/inner"]


@pytest.mark.parametrize("given", ["home/read", "link"])
@pytest.mark.parametrize("out", [*SAME, "home", "home/read/.."])
def test_an_input_and_what_holds_it_is_not_replaced(tmp_path, read, given, out):
    fill(tmp_path / "home")
    write_sums(tmp_path / "home")
    block = folder_of(tmp_path / out, inputs=[tmp_path / given], force=True)
    refused(block, "is an input, and would be replaced")


@pytest.mark.parametrize("given", ["home/read", "link"])
@pytest.mark.parametrize("out", WITHIN)
def test_what_lies_inside_an_input_is_not_replaced(tmp_path, read, given, out):
    block = folder_of(tmp_path / out, inputs=[tmp_path / given], force=True)
    refused(block, "lies inside .*, which is an input")


@pytest.mark.parametrize("out", ["home/read/page", "link/page", "file"])
@pytest.mark.parametrize("given", ["home/read/page", "link/page", "file", "home/read"])
def test_a_file_that_is_read_is_not_replaced(tmp_path, read, given, out):
    block = file_of(tmp_path / out, inputs=[tmp_path / given], force=True)
    refused(block, "is an input, and would be replaced|which is an input")


def test_another_name_of_the_same_file_is_not_replaced(tmp_path, read):
    (tmp_path / "twin").hardlink_to(read / "page")
    block = file_of(tmp_path / "twin", inputs=[read / "page"], force=True)
    refused(block, "is an input, and would be replaced")


def test_a_new_name_inside_or_beside_an_input_is_free(tmp_path, read):
    for out in ("home/read/new", "home/other"):
        with folder_of(tmp_path / out, inputs=[read, "no path", None]) as folder:
            fill(folder)
    make_output(tmp_path / "home" / "beside")
    with folder_of(tmp_path / "home" / "beside", inputs=[read], force=True) as folder:
        fill(folder)
