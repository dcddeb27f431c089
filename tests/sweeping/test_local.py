"""The local pool: every task is answered, whatever happens to the workers."""

import errno
import os
import time
from contextlib import closing
from pathlib import Path

import pytest

from tests.sweeping.works import texts
from tsas_cli.support.errors import InputError
from tsas_cli.sweeping.local import in_processes

ROOT = Path(__file__).parents[2]
WORKS = "tests.sweeping.works"


@pytest.fixture(autouse=True)
def _workers_find_the_works(monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(ROOT))


def test_every_task_is_answered_by_its_number_on_as_many_processes_as_asked_for(tmp_path):
    tasks = texts(range(6), folder=str(tmp_path), seconds=0.1)
    outcomes = dict(in_processes(f"{WORKS}:slow", tasks, workers=2))
    assert {n: outcomes[n]["results"]["square"] for n in outcomes} == {n: n**2 for n in range(6)}
    assert len({outcome["where"] for outcome in outcomes.values()}) == 2


def test_what_a_worker_prints_is_no_answer():
    """Where there are fewer tasks than workers might be, no more of them begin."""
    outcomes = dict(in_processes(f"{WORKS}:outcome_of", texts([3, 4]), workers=50))
    assert [outcomes[n]["results"]["square"] for n in (0, 1)] == [9, 16]
    assert len(outcomes) == 2


def test_a_worker_that_is_killed_loses_nothing(tmp_path):
    tasks = texts(range(5), folder=str(tmp_path))
    outcomes = dict(in_processes(f"{WORKS}:one_kills_once", tasks, workers=2))
    assert (tmp_path / "killed").exists()
    assert [outcomes[n]["results"]["square"] for n in range(5)] == [0, 1, 4, 9, 16]


@pytest.mark.parametrize(
    ("work", "why"),
    [("one_always_kills", "by SIGKILL"), ("one_raises", "with 1: ValueError: two")],
)
def test_a_task_that_ends_its_workers_is_reported_and_the_rest_completes(work, why):
    outcomes = dict(in_processes(f"{WORKS}:{work}", texts(range(5)), workers=2))
    bad = outcomes.pop(2)
    assert (bad["state"], bad["defect"]) == ("failed", True)
    assert bad["error"] == f"the process died, 2 times: ended {why}"
    assert [outcomes[n]["state"] for n in sorted(outcomes)] == ["done"] * 4


def test_a_machine_that_starts_no_more_processes_is_one_line(monkeypatch):
    def refused(*_, **__):
        raise OSError(errno.EMFILE, "Too many open files")

    monkeypatch.setattr("subprocess.Popen", refused)
    with pytest.raises(InputError, match=r"no process can be started \(Too many open files\); use"):
        dict(in_processes(f"{WORKS}:squared", texts([1, 2]), workers=2))


def test_who_stops_reading_answers_ends_the_workers_at_once(tmp_path):
    tasks = texts(range(2), folder=str(tmp_path), seconds=0.0)
    tasks += texts(range(2, 4), folder=str(tmp_path), seconds=600.0)
    start = time.monotonic()
    with closing(in_processes(f"{WORKS}:slow", tasks, workers=2)) as outcomes:
        for _ in range(2):
            next(outcomes)
        while len(list(tmp_path.iterdir())) < 4:
            time.sleep(0.01)
    assert time.monotonic() - start < 300.0
    for mark in tmp_path.iterdir():
        with pytest.raises(ProcessLookupError):
            os.kill(int(mark.name.split("-")[1]), 0)
