"""One task of a sweep: what is there whole counts as done, and half of it is done again."""

import json
import shutil

import pytest

from tests.reporting.made_folders import edited
from tsas_cli.stages.sweep import WORK, options_of
from tsas_cli.support.files import sha256_of
from tsas_cli.sweeping.folder import sweep_folder, what_is_done
from tsas_cli.sweeping.outcome import ONE_THREAD, run_task
from tsas_cli.sweeping.plan import read_plan
from tsas_cli.sweeping.tasks import tasks_of


@pytest.fixture
def begun(tmp_path, dataset, monkeypatch):
    """Return two tasks of a sweep, and the folder for them."""
    for name, value in ONE_THREAD.items():
        monkeypatch.setenv(name, value)  # as a task sets it
    shutil.copytree(dataset, tmp_path / "a")
    shutil.copytree(dataset, tmp_path / "b")
    plan, _ = read_plan({"stage": "check", "datasets": ["a", "b"]})
    with sweep_folder(tmp_path / "out", []) as folder:
        yield *tasks_of(plan, tmp_path, options_of("check")), folder


def answer(task, folder, *, force=False):
    return json.loads(run_task(WORK, task.text(folder, force=force)))


def written(folder):
    return {path.name: sha256_of(path) for path in folder.iterdir()}


def test_a_task_whose_worker_died_before_it_answered_is_done(begun):
    task, _, folder = begun
    first, place = answer(task, folder), (folder / task.key).stat().st_ino
    again = answer(task, folder)
    assert (again["state"], again["results"]) == ("done", first["results"])
    assert (folder / task.key).stat().st_ino == place
    assert answer(task, folder, force=True)["state"] == "done"
    assert (folder / task.key).stat().st_ino != place


def _other_task(place):
    (other,) = (path for path in place.parent.iterdir() if path != place)
    shutil.rmtree(place)
    shutil.copytree(other, place)


def _file(place):
    shutil.rmtree(place)
    place.write_text("x")


def _foreign(place):
    shutil.rmtree(place)
    place.mkdir()
    (place / "x").touch()


def _edited(place):
    with edited(place / "task.json") as content:
        content["results"]["errors"] = 77


def _says(name, content):
    """Return a damage: another content of one file, or none."""
    if content is None:
        return lambda place: (place / name).unlink()
    return lambda place: (place / name).write_bytes(content)


CONTENTS = {
    "task.json": (b'{"format": 1, ', b"", b"\xff\x00\x1f", b"{}", b"[]", None),
    "SHA256SUMS": (b"\xff", None),
    "check.json": (b"{}", None),
}
DAMAGES = {
    "edited numbers": _edited,
    **{f"{n}: {c!r}": _says(n, c) for n, contents in CONTENTS.items() for c in contents},
    "another task": _other_task,
    "a file": _file,
    "other files": _foreign,
}


@pytest.mark.parametrize("damage", DAMAGES.values(), ids=DAMAGES)
def test_a_damaged_task_is_done_again(begun, damage):
    task, other, folder = begun
    first = answer(task, folder)
    answer(other, folder)
    before = written(folder / task.key)
    assert what_is_done(folder, task.key)["results"] == first["results"]
    damage(folder / task.key)
    assert what_is_done(folder, task.key) is None
    assert answer(task, folder)["results"] == first["results"]
    assert written(folder / task.key) == before
    assert what_is_done(folder, task.key)["results"] == first["results"]


def test_what_somebody_adds_to_a_task_stays(begun):
    task, _, folder = begun
    answer(task, folder)
    page = folder / task.key / "report.html"
    page.touch()
    assert answer(task, folder)["state"] == "done"
    assert page.exists()
