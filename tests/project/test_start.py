import json
import os
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import typer

from tests.pipelines.bench import MAKE
from tests.project.recorded import NAMES, recorded
from tsas_cli.app import app
from tsas_cli.project.start import start
from tsas_cli.recordings.ingest_map import read_map
from tsas_cli.support.errors import InputError


def test_a_project_without_recordings_asks_for_everything(tmp_path, done):
    written = sorted(json.loads(done("init", tmp_path / "new", "--json"))["files"])
    assert written == [".gitignore", "Makefile", "README.md", "bench.toml", "raw/README.md"]
    readme = (tmp_path / "new" / "README.md").read_text()
    assert readme.startswith("# new\n")
    with pytest.raises(InputError, match=r"10 questions are open: columns.time_s.source"):
        read_map(tmp_path / "new" / "bench.toml")


def test_the_files_of_a_list_are_copied_with_it(tmp_path):
    recorded(tmp_path / "bench" / "a.csv")
    path = tmp_path / "bench" / "run.join"
    path.write_text(f'[all]\nfile = "a.csv"\ntime = "{NAMES[0]}"\n')
    for number, source in enumerate((path, path.parent)):
        files, proposal = start(tmp_path / f"rig{number}", [source])
        assert proposal.looked_at.path == path
        assert {Path(file).name for file in files} >= {"a.csv", "run.join"}


def test_lists_may_share_a_file_and_others_may_not_have_its_name(tmp_path):
    recorded(tmp_path / "bench" / "a.csv")
    for run in ("one", "two"):
        text = f'[{run}]\nfile = "a.csv"\ntime = "{NAMES[0]}"\n'
        (tmp_path / "bench" / f"{run}.join").write_text(text)
    files, _ = start(tmp_path / "rig", [tmp_path / "bench"])
    assert sum(file.endswith("a.csv") for file in files) == 1
    (tmp_path / "other").mkdir()
    other = recorded(tmp_path / "other" / "bench" / "a.csv")
    with pytest.raises(InputError, match="two sources have the name"):
        start(tmp_path / "new", [tmp_path / "bench", other.parent])


def test_a_recording_that_does_not_match_the_map_is_said(tmp_path, done):
    recorded(tmp_path / "bench" / "a.csv")
    (tmp_path / "bench" / "b.csv").write_text("t,u\n0,1\n1,2\n")
    printed = done("init", tmp_path / "rig", "--from", tmp_path / "bench")
    assert "files that do not match" in printed
    assert "b.csv" in printed.partition("files that do not match")[2]


def test_recordings_are_copied_and_guessed(tmp_path):
    source = recorded(tmp_path / "bench 1" / "a.csv")
    files, proposal = start(tmp_path / "new", [source.parent])
    assert "raw/bench 1/a.csv" in files
    assert proposal.questions == {}
    assert (tmp_path / "new" / "raw" / "bench 1" / "a.csv").read_bytes() == source.read_bytes()
    assert read_map(tmp_path / "new" / "bench.toml").columns["f_in_N"].source == "Force in [N]"


def test_a_folder_that_is_there_gets_the_files_beside_its_own(tmp_path, monkeypatch):
    recorded(tmp_path / "raw" / "a.csv")
    monkeypatch.chdir(tmp_path)
    files, _ = start(Path(), [Path("raw")])
    assert "raw/a.csv" not in files
    assert (tmp_path / "Makefile").is_file()
    assert (tmp_path / "README.md").read_text().startswith(f"# {tmp_path.name}\n")


def test_the_parent_folder_is_a_source_like_any(tmp_path, monkeypatch):
    recorded(tmp_path / "a.csv")
    (tmp_path / "in").mkdir()
    monkeypatch.chdir(tmp_path / "in")
    files, _ = start(Path("new"), [Path("..")])
    assert "raw/a.csv" in files
    assert (tmp_path / "in" / "new" / "raw" / "a.csv").is_file()


@pytest.mark.parametrize("there", ["Makefile", "bench.toml", "raw/README.md", "raw/a.csv"])
def test_nothing_is_overwritten(tmp_path, there):
    source = recorded(tmp_path / "a.csv")
    (tmp_path / "new" / "raw").mkdir(parents=True)
    (tmp_path / "new" / there).write_text("mine")
    with pytest.raises(InputError, match=there):
        start(tmp_path / "new", [source])
    assert (tmp_path / "new" / there).read_text() == "mine"
    left = [p for p in (tmp_path / "new").rglob("*") if p.is_file()]
    assert left == [tmp_path / "new" / there]


def test_what_cannot_be_read_leaves_no_project(tmp_path, refused):
    (tmp_path / "a.csv").write_text("bent by hand\n")
    refused("init", tmp_path / "new", "--from", tmp_path / "a.csv")
    assert not (tmp_path / "new").exists()
    (tmp_path / "b").mkdir()
    recorded(tmp_path / "a.csv")
    recorded(tmp_path / "b" / "a.csv")
    with pytest.raises(InputError, match="two sources have the name"):
        start(tmp_path / "new", [tmp_path / "a.csv", tmp_path / "b" / "a.csv"])


def test_an_unset_variable_of_the_shell_is_no_project(tmp_path, refused):
    said = refused("init", "", cwd=tmp_path)
    assert said.startswith("tsas: no folder is named; ")
    assert list(tmp_path.iterdir()) == []


STEPS = ["ingest", "check", "calibrate", "simulate", "diagnose", "report"]
PAGE, CHECK = "result/report.html", "result/check/check.json"


@pytest.mark.skipif(MAKE is None, reason="no make here: apt install make")
@pytest.mark.parametrize("output", [CHECK, pytest.param(PAGE, marks=pytest.mark.large)])
def test_from_a_recording_to_an_output_and_back_to_one_that_is_broken(tmp_path, output):
    source = recorded(tmp_path / "a [1].csv", step=50)
    start(tmp_path / "new", [source])
    bench = tmp_path / "new" / "bench.toml"
    conditions = "sheath_length_mm = 785.4\ntotal_bend_rad = 3.1416\npreload_N = 25.0\n"
    bench.write_text(bench.read_text().split("# sheath_length_mm")[0] + conditions)

    def make(*words):
        path = {"PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}
        where = {"cwd": tmp_path / "new", "env": os.environ | path}
        return subprocess.run([MAKE, *words], capture_output=True, text=True, check=False, **where)

    made = tmp_path / "new" / output
    done = make(output)
    assert done.returncode == 0, done.stderr
    assert "Force" not in done.stderr
    first = made.read_bytes()
    assert make("-q", output).returncode == 0

    raw = tmp_path / "new" / "raw" / "a [1].csv"
    whole = raw.read_text()
    raw.write_text(whole.replace("Force in", "Farce in"))
    for _ in range(2):  # what a failed step leaves is not taken for done
        done = make(output)
        assert done.returncode == 2
        assert "column Force in [N] is missing; did you mean Farce in [N]?" in done.stderr
        assert made.read_bytes() == first
    raw.write_text(whole)
    (tmp_path / "new" / CHECK).touch()
    lines = make("-n").stdout.splitlines()
    calls = [shlex.split(line)[1:] for line in lines if line.startswith("tsas ")]
    assert [step for step, *_ in calls] == STEPS
    for step, *words in calls:
        typer.main.get_command(app).commands[step].make_context(step, words)


def test_a_project_that_was_killed_half_way_is_finished_by_the_same_call(tmp_path):
    source = recorded(tmp_path / "a.csv")
    start(tmp_path / "new", [source])
    (tmp_path / "new" / "Makefile").unlink()
    for home in (tmp_path, tmp_path / "new", tmp_path / "new" / "raw"):
        (home / ".new.abcdefgh.tsas-lock").touch()
        (home / ".new.abcdefgh.tsas-new").touch()
    files, _ = start(tmp_path / "new", [source])
    assert "Makefile" in files
    there = {str(p.relative_to(tmp_path / "new")) for p in (tmp_path / "new").rglob("*.*")}
    assert there | {"raw", "Makefile"} == {*files, "raw"}
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.csv", "new"]
