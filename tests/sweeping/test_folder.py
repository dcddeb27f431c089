"""The folder of a sweep: what makes it one, what a kill leaves in it, and where it cannot grow."""

import os

import pytest

from tests.outputs import refused
from tests.sweeping.test_tasks import rigs, tasks  # noqa: F401 # a fixture
from tsas_cli.support.errors import InputError
from tsas_cli.sweeping.folder import note, sweep_folder
from tsas_cli.sweeping.outcome import success


def test_what_a_kill_leaves_goes_with_the_next_call(tmp_path):
    with sweep_folder(tmp_path / "out", []) as folder:
        (folder / ".a-0123456789.abcdefgh.tsas-lock").write_text("tsas\nelsewhere\n\n")
        (folder / ".a-0123456789.abcdefgh.tsas-new" / "runs").mkdir(parents=True)
        (folder / "a-0123456789").mkdir()
    assert [path.name for path in folder.iterdir()] == ["a-0123456789"]


@pytest.mark.parametrize("left", [[], ["tasks/"], ["tasks/a/", "sweep.json"], ["journal.jsonl"]])
def test_a_sweep_goes_on_in_what_is_left_of_one(tmp_path, left):
    for name in left:
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.mkdir(parents=True) if name.endswith("/") else path.touch()
    with sweep_folder(tmp_path, []) as folder:
        assert (tmp_path / "journal.jsonl").is_file()
        assert folder.is_dir()


@pytest.mark.parametrize("place", [".", "tasks/a", "link"])
def test_a_sweep_is_not_written_around_what_it_reads(tmp_path, place):
    with sweep_folder(tmp_path / "out", []) as folder:
        (folder / "a").mkdir()
        (folder / "a" / "model.toml").write_text("mine")
        (tmp_path / "out" / "link").symlink_to(folder / "a")
    read = tmp_path / "out" / place / ("model.toml" if place != "." else "tasks/a/model.toml")
    refused(sweep_folder(tmp_path / "out", [read]), "is an input, and would be replaced")


@pytest.mark.parametrize(
    "others",
    [
        ["tasks/.mine"],
        ["tasks/a"],
        ["notes.txt"],
        ["sweep.json"],
        ["journal.jsonl", "parameters.csv"],
    ],
)
def test_a_folder_of_something_else_stays_as_it_is(tmp_path, others):
    sweep = "journal.jsonl" in others
    why = r"has not written \(parameters.csv\)" if sweep else "is no folder of an earlier sweep"
    for other in others:
        (tmp_path / other).parent.mkdir(exist_ok=True)
        (tmp_path / other).write_text("{}")
    refused(sweep_folder(tmp_path, []), why)
    there = [p.relative_to(tmp_path).as_posix() for p in tmp_path.rglob("*") if p.is_file()]
    assert sorted(there) == others


def test_a_file_is_no_folder_of_a_sweep(tmp_path):
    (tmp_path / "file").touch()
    refused(sweep_folder(tmp_path / "file", []), "file: is a file")


def test_a_kill_at_the_start_leaves_the_mark_first(tmp_path, monkeypatch):
    def kill(journal, out):
        journal.close()
        raise KeyboardInterrupt

    monkeypatch.setattr("tsas_cli.sweeping.folder._lock", kill)
    with pytest.raises(KeyboardInterrupt), sweep_folder(tmp_path / "out", []):
        pass
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["journal.jsonl"]


def test_a_full_disk_is_one_line(rigs):  # noqa: F811
    (rigs / "journal.jsonl").symlink_to("/dev/full")
    with pytest.raises(InputError, match=r"l: cannot be written \(No space .*make room"):
        note(rigs, tasks(rigs)[0], success({}, []))


def test_a_folder_whose_name_is_no_text_is_refused(tmp_path):
    refused(sweep_folder(tmp_path / os.fsdecode(b"pp\xff"), []), "its name is not UTF-8")
    assert list(tmp_path.iterdir()) == []
