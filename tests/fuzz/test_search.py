"""The search finds what breaks a rule: a defect, a death of the process, a folder elsewhere."""

import shutil

import pytest

from tests.fuzz import faulty
from tests.fuzz.__main__ import CORPUS, NAMES, main, target_of
from tests.fuzz.rules import Broken, Scratch, Watch, answer
from tests.fuzz.search import LOG, Budget, search
from tsas_cli.support.errors import InputError

EXECUTIONS = 300  # of a target with a share of one
EACH_TIME = "units"


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=() if n == EACH_TIME else pytest.mark.large) for n in NAMES]
)
def test_a_short_search_finds_nothing(name, tmp_path):
    """It is the same in every run: `make fuzz` looks for longer, and elsewhere."""
    pytest.importorskip("atheris")
    target = target_of(name)
    runs = round(EXECUTIONS * target.SHARE)
    found = search(target, Budget(runs, 0, 1), CORPUS, tmp_path)
    assert found.faults == (), (tmp_path / "found" / name / LOG).read_text()
    assert found.executions >= runs


def test_a_defect_and_a_write_are_found(tmp_path):
    pytest.importorskip("atheris")
    found = search(faulty, Budget(5000, 0, 1), tmp_path / "corpus", tmp_path / "out")
    assert {path.read_bytes()[:1] for path in found.faults} == {b"R", b"W"}
    assert found.executions >= 5000
    told = "".join(p.read_text() for p in (tmp_path / "out" / "found" / "faulty").glob("*.txt"))
    assert "a defect" in told
    assert "reading does more than read: os.mkdir" in told


def test_a_death_of_the_process_is_found(tmp_path, monkeypatch):
    pytest.importorskip("atheris")
    monkeypatch.setattr("tests.fuzz.search.MOST_DEATHS", 1)
    monkeypatch.setattr(faulty, "WORDS", (b"DEAD",))
    found = search(faulty, Budget(5000, 0, 1), tmp_path / "corpus", tmp_path / "out")
    assert b"DEAD" in {path.read_bytes()[:4] for path in found.faults}


@pytest.mark.large  # three searches, each in a process that dies
def test_what_a_library_does_to_the_search_alone_is_no_fault(tmp_path, monkeypatch, capfd):
    pytest.importorskip("atheris")
    monkeypatch.setattr("tests.fuzz.search.MOST_DEATHS", 1)
    monkeypatch.setattr(faulty, "WORDS", (b"DIES", b"ODD!"))
    found = search(faulty, Budget(1000, 0, 1), tmp_path / "corpus", tmp_path / "out")
    told = capfd.readouterr().err
    assert "the process died" in told
    assert "FAULT KeyError faulty.py" in told
    assert found.executions >= 1000
    assert {path.read_bytes()[:4] for path in found.faults} <= {b"R", b"W"}


def test_a_refusal_is_an_answer_and_a_defect_is_none():
    def refuse():
        raise InputError("no \x1b[31m")

    assert answer(refuse) is None
    assert answer(lambda: 3) == 3
    with pytest.raises(ZeroDivisionError):
        answer(lambda: 1 / 0)


def test_writes_are_seen_but_in_temporary_folders(tmp_path, monkeypatch):
    monkeypatch.setattr("tests.fuzz.rules.gettempdir", lambda: str(tmp_path / "mine"))
    (tmp_path / "mine").mkdir()
    watch = Watch()
    with watch.during():
        (tmp_path / "mine" / "a").write_text("")
        (tmp_path / "mine" / "a").read_text()
    with pytest.raises(Broken, match="open"), watch.during():
        (tmp_path / "other").write_text("")
    with pytest.raises(Broken, match=r"os\.rename"), watch.during():
        (tmp_path / "other").rename(tmp_path / "mine" / "other")


def test_a_folder_is_removed_by_names_relative_to_it(tmp_path, monkeypatch):
    monkeypatch.setattr("tests.fuzz.rules.gettempdir", lambda: str(tmp_path / "mine"))
    for folder in ("mine/a/b", "other/a/b", "elsewhere"):
        (tmp_path / folder).mkdir(parents=True)
        (tmp_path / folder / "file").write_text("")
    watch = Watch()
    monkeypatch.chdir(tmp_path / "elsewhere")
    with watch.during():
        shutil.rmtree(tmp_path / "mine" / "a")
    monkeypatch.chdir(tmp_path / "mine")
    with pytest.raises(Broken, match=r"os\.remove 'file'; os\.rmdir 'b'"), watch.during():
        shutil.rmtree(tmp_path / "other")


def test_a_call_has_to_say_what_and_how_long(capsys):
    for call in (["units"], ["nothing", "--runs", "1"]):
        with pytest.raises(SystemExit):
            main(call)
    assert "--seconds" in capsys.readouterr().err
    assert Scratch().file("a", b"b").read_bytes() == b"b"
