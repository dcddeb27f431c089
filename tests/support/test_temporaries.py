"""What killed processes leave, and what is nobody's business."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.outputs import file_of, folder_of, make_output, names, write
from tsas_cli.support import temporaries
from tsas_cli.support.errors import InputError

KILLED = """
import os, signal, sys
from pathlib import Path
from tsas_cli.support import temporaries
from tests.outputs import folder_of
if sys.argv[2] == "between":
    temporaries._exchanged = lambda a, b: False
    rename = Path.rename
    def killing(self, target):
        rename(self, target)
        if self == Path(sys.argv[1]):
            os.kill(os.getpid(), signal.SIGKILL)
    Path.rename = killing
with folder_of(Path(sys.argv[1]), force=True) as folder:
    (folder / "result").write_text("new")
    if sys.argv[2] == "inside":
        os.kill(os.getpid(), signal.SIGKILL)
"""
WRITER = """
import sys
from pathlib import Path
from tsas_cli.app import _stop
from tsas_cli.support.errors import InputError
from tests.outputs import file_of, written
path, force = Path(sys.argv[1]), sys.argv[2] == "force"
try:
    if sys.argv[3] == "folder":
        with written(path, force=force, **dict.fromkeys(("a", "b", "result"), sys.argv[4])):
            print("there", flush=True)
            sys.stdin.readline()
    else:
        with file_of(path, force=force) as new:
            new.write_text(sys.argv[4])
            print("there", flush=True)
            sys.stdin.readline()
except InputError as error:
    sys.exit(_stop(error.line(), 2))
"""


def kill(path, when):
    call = [sys.executable, "-c", KILLED, str(path), when]
    assert subprocess.run(call, check=False).returncode == -9


def test_the_next_output_in_the_folder_sweeps_what_a_killed_one_has_left(tmp_path):
    make_output(tmp_path / "out", result="old")
    kill(tmp_path / "out", "inside")
    assert (tmp_path / "out" / "result").read_text() == "old"
    assert [Path(name).suffix for name in names(tmp_path)] == [".tsas-lock", ".tsas-new", ""]
    write(tmp_path / "another")
    assert names(tmp_path) == ["another", "out"]


def test_a_kill_between_two_renames_is_mended_by_the_next_output(tmp_path):
    make_output(tmp_path / "out", result="old")
    kill(tmp_path / "out", "between")
    assert not (tmp_path / "out").exists()
    write(tmp_path / "another")
    assert (tmp_path / "out" / "result").read_text() == "old"
    assert names(tmp_path) == ["another", "out"]


def test_names_are_exchanged_where_the_system_can(tmp_path):
    (tmp_path / "a").write_text("a")
    make_output(tmp_path / "b", result="old")
    if not temporaries._exchanged(tmp_path / "a", tmp_path / "b"):
        pytest.skip("this file system cannot exchange two names")
    assert (tmp_path / "b").read_text() == "a"
    assert (tmp_path / "a" / "result").read_text() == "old"


def test_what_a_living_process_makes_stays(tmp_path):
    with folder_of(tmp_path / "out") as folder:
        (folder / "result").write_text("mine")
        write(tmp_path / "another")
        with file_of(tmp_path / "page.html") as page:
            page.write_text("page")
            write(tmp_path / "third")
    assert (tmp_path / "out" / "result").read_text() == "mine"
    assert names(tmp_path) == ["another", "out", "page.html", "third"]


@pytest.mark.parametrize(
    ("owner", "stays"),
    [
        (f"tsas\n{temporaries.platform.node()}\nearlier\n", False),
        ("tsas\nanother machine\nanother start\n", True),
        ("mine", True),
        ("", False),
    ],
)
def test_only_locks_of_this_machine_are_swept(tmp_path, owner, stays):
    (tmp_path / ".out.abcdefgh.tsas-lock").write_text(owner)
    (tmp_path / ".out.abcdefgh.tsas-new").mkdir()
    write(tmp_path / "another")
    assert (len(names(tmp_path)) == 3) == stays


def test_files_of_a_person_stay(tmp_path):
    mine = [".out.abcdefgh.tsas-new", ".out.abcdefgh", ".out.tsas-lock", "out.abcdefgh.tsas-lock"]
    for name in mine:
        (tmp_path / name).write_text("mine")
    write(tmp_path / "out")
    assert names(tmp_path) == sorted([*mine, "out"])


def test_a_link_is_replaced_and_what_it_leads_to_stays(tmp_path):
    make_output(tmp_path / "there", result="old")
    (tmp_path / "out").symlink_to("there")
    write(tmp_path / "out", force=True)
    assert (tmp_path / "there" / "result").read_text() == "old"
    assert not (tmp_path / "out").is_symlink()
    assert names(tmp_path) == ["out", "there"]


def two_at_once(path: Path, force: str, kind) -> list[tuple[int, str]]:
    """Let two processes write the same output, and end the second before the first."""
    processes = [
        subprocess.Popen(
            [sys.executable, "-c", WRITER, str(path), force, kind, text],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        for text in ("mine, first", "mine, second")
    ]
    for process in processes:
        assert process.stdout
        assert process.stdout.readline() == "there\n"
    ended = []
    for process in reversed(processes):
        _, stderr = process.communicate("\n", timeout=300)
        ended.append((process.returncode, stderr))
    return ended


@pytest.mark.parametrize("kind", ["folder", "file"])
def test_of_two_at_once_one_wins_and_the_other_says_so(tmp_path, kind):
    (won, _), (lost, stderr) = two_at_once(tmp_path / "out", "", kind)
    assert (won, lost) == (0, 2)
    assert "already exists" in stderr
    assert stderr.count("\n") == 1
    result = tmp_path / "out" / "result" if kind == "folder" else tmp_path / "out"
    assert result.read_text() == "mine, second"
    assert names(tmp_path) == ["out"]


@pytest.mark.parametrize("kind", ["folder", "file"])
def test_of_two_at_once_with_force_the_last_is_whole(tmp_path, kind):
    assert two_at_once(tmp_path / "out", "force", kind) == [(0, ""), (0, "")]
    home = tmp_path / "out"
    results = [home / name for name in ("a", "b", "result")] if kind == "folder" else [home]
    assert {path.read_text() for path in results} == {"mine, first"}
    assert names(tmp_path) == ["out"]


def test_a_file_never_replaces_one_that_came_meanwhile_where_links_are_unknown(
    tmp_path, monkeypatch
):
    def no_link(*_):
        raise PermissionError

    monkeypatch.setattr(os, "link", no_link)
    with (
        pytest.raises(InputError, match="already exists"),
        file_of(tmp_path / "page"),
    ):
        (tmp_path / "page").write_text("of somebody else")
    assert (tmp_path / "page").read_text() == "of somebody else"
    with file_of(tmp_path / "other") as page:
        page.write_text("mine")
    assert (tmp_path / "other").read_text() == "mine"
    assert names(tmp_path) == ["other", "page"]
