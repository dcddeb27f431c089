"""A real scheduler with workers, all of them processes of their own, over TCP."""

import filecmp
import logging
import os
import shutil
import signal
import sys
import time
from contextlib import closing
from importlib.util import find_spec
from threading import Thread

import pytest

import tsas_cli as tsas
from tests.sweeping.clusters import HERE, ROOT, cluster, wait_for
from tests.sweeping.works import texts
from tsas_cli.sweeping.cluster import _refuse, on_cluster
from tsas_cli.sweeping.outcome import versions

pytestmark = [
    pytest.mark.skipif(
        find_spec("distributed") is None, reason="no Dask here: pip install 'tsas[dask]'"
    ),
    # Its connections are closed by a thread of its own, after the test has ended.
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
]
WORKS = "tests.sweeping.works"


@pytest.fixture(scope="module")
def running(tmp_path_factory):
    with cluster(tmp_path_factory.mktemp("cluster")) as made:
        yield made


@pytest.fixture
def two(running):
    """Two workers; where a test has killed one there is a new one."""
    while running.workers() < 2:
        running.add()
    return running


@pytest.fixture
def marks(tmp_path):
    """Return a folder in which slow tasks say that they are begun."""
    (tmp_path / "marks").mkdir()
    return tmp_path / "marks"


@pytest.fixture
def shared(tmp_path):
    """Return a file that every worker sees."""
    path = tmp_path / "shared"
    path.touch()
    return path


@pytest.fixture
def recordings(tmp_path, dataset):
    """Three datasets, one of them broken."""
    for name in ("rigs/a", "rigs/b", "rigs/broken"):
        shutil.copytree(dataset, tmp_path / name)
    (tmp_path / "rigs/broken/runs/a.parquet").write_bytes(b"no Parquet")
    manifest = tmp_path / "rigs/b/dataset.toml"
    manifest.write_text(manifest.read_text().replace("bench-42", "bench-43"))
    return tmp_path / "rigs"


def outcomes_of(made, work, content, shared):
    return dict(on_cluster(f"{WORKS}:{work}", content, made.address, shared))


def files(folder):
    return sorted(p.relative_to(folder) for p in folder.rglob("*") if p.is_file())


def test_every_task_is_answered_and_both_workers_share(two, shared, marks):
    outcomes = outcomes_of(two, "slow", texts(range(6), folder=str(marks), seconds=0.1), shared)
    assert [outcomes[n]["results"]["square"] for n in range(6)] == [0, 1, 4, 9, 16, 25]
    assert len({outcome["where"] for outcome in outcomes.values()}) == 2


def test_files_are_the_same_as_by_local_processes_and_a_task_may_fail(two, recordings, tmp_path):
    plan = {"stage": "check", "datasets": f"{recordings}/*"}
    there = tsas.sweep(plan, out=tmp_path / "there", cluster=two.address)
    here = tsas.sweep(plan, out=tmp_path / "here", workers=1)
    assert there.summary == here.summary
    assert list(there.failed) == [key for key in there.failed if "broken" in key]
    assert there.summary["counts"] == {"done": 2, "failed": 1}
    found = files(tmp_path / "there")
    assert found == files(tmp_path / "here")
    assert len(found) == 2 * 3 + 4
    same, other, _ = filecmp.cmpfiles(tmp_path / "there", tmp_path / "here", found, shallow=False)
    assert [str(path) for path in other] == ["journal.jsonl"]
    assert len(same) == len(found) - 1
    again = tsas.sweep(plan, out=tmp_path / "there", workers=1)  # by local processes, the failed
    assert again.before == 2
    assert len((tmp_path / "there" / "journal.jsonl").read_text().splitlines()) == 3 + 1


def test_a_worker_killed_in_the_middle_loses_nothing(two, shared, marks):
    killed = []

    def kill_one():
        wait_for(lambda: len(list(marks.iterdir())) >= 3)
        killed.append(max(marks.iterdir(), key=lambda p: p.stat().st_mtime_ns).name)
        os.kill(int(killed[0].split("-")[1]), signal.SIGKILL)

    killer = Thread(target=kill_one)
    killer.start()
    outcomes = outcomes_of(two, "slow", texts(range(8), folder=str(marks), seconds=0.4), shared)
    killer.join()
    assert [outcomes[n]["results"]["square"] for n in range(8)] == [n**2 for n in range(8)]
    number = killed[0].split("-")[0]
    assert len(list(marks.glob(f"{number}-*"))) == 2  # it was begun, and begun again elsewhere


def test_a_task_that_raises_is_reported_and_the_rest_completes(two, shared):
    outcomes = outcomes_of(two, "one_raises", texts(range(4)), shared)
    assert outcomes.pop(2)["error"] == "ValueError: two"
    assert [outcomes[n]["state"] for n in sorted(outcomes)] == ["done"] * 3


def test_who_stops_reading_takes_back_what_nobody_has_begun(two, shared, marks):
    content = texts(range(40), folder=str(marks), seconds=0.5)
    with closing(on_cluster(f"{WORKS}:slow", content, two.address, shared)) as outcomes:
        next(outcomes)
    begun = -1
    while begun < (now := len(list(marks.iterdir()))):
        begun = now
        time.sleep(1.5)  # in which a worker that goes on begins three
    assert begun < 40


def test_a_worker_that_does_not_see_the_folder_is_named(two, tmp_path):
    where = tmp_path / "nowhere" / "journal.jsonl"
    refused(two.address, where, r"worker tcp://\S+ does not see .*/nowhere;")


def refused(address, shared, why):
    """Ask a scheduler that is refused before it is told of a task."""
    with pytest.raises(tsas.InputError, match=why):
        dict(on_cluster(f"{WORKS}:squared", texts([1]), address, shared))


NO_HOST = ("", "tcp://", "http://x:1", "tcp://ä:1", "tcp://a:1;touch ran")
NO_PORT = ("tcp://x", "tcp://x:y", "tcp://x:1/", "tcp://x:65536")
WRONG = dict.fromkeys((*NO_HOST, *NO_PORT), "is no scheduler address; expected tcp://HOST:PO") | {
    "tls://x:1": "Dask has no TLS certificates; name them",
    f"tcp://{HERE}:9": "no scheduler responds; expected a running",
}


@pytest.mark.parametrize("address", WRONG)
def test_a_wrong_address_is_one_line(monkeypatch, address, shared):
    monkeypatch.setattr("tsas_cli.sweeping.cluster.CONNECT_TIMEOUT_S", 0.5)
    refused(address, shared, WRONG[address])


def test_without_dask_the_line_says_what_to_install(monkeypatch, shared):
    monkeypatch.setitem(sys.modules, "distributed", None)
    refused("tcp://x:1", shared, r"pip install 'tsas\[dask\]'")


def test_a_cluster_that_would_do_it_otherwise_is_refused(two, tmp_path, shared):
    path = f"{other_version(tmp_path / 'other')}{os.pathsep}{ROOT}"
    otherwise = {
        "runs 2 tasks at once in one process": {"threads": 2},
        r"worker tcp://\S+: tsas is 9.9.9; expected 0": {"PYTHONPATH": path},
    }
    for why, how in otherwise.items():
        worker = two.add(**how)
        refused(two.address, shared, why)
        worker.terminate()
        worker.wait()
        wait_for(lambda: two.workers() == 2)


def test_a_worker_whose_algebra_takes_more_threads_is_named(shared):
    found = {"versions": versions(), "sees": True, "threads": "4"}
    with pytest.raises(tsas.InputError, match="worker w: OPENBLAS_NUM_THREADS is 4; expected 1"):
        _refuse(found, "worker w", shared, "dask worker")
    _refuse(found | {"threads": "1"}, "worker w", shared, "dask worker")


def test_what_ends_workers_or_the_scheduler_is_told(tmp_path, marks, shared):
    with cluster(tmp_path / "cluster", DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES="0") as made:
        refused(made.address, shared, "has no workers; start some with `OPENBLAS_NUM")
        made.add()
        made.add()
        outcomes = outcomes_of(made, "one_always_kills", texts(range(4)), shared)
        assert outcomes.pop(2)["error"] == "the process died"
        # With no failure allowed, what waited on that worker may be given up with it.
        others = [outcome["error"] for outcome in outcomes.values() if outcome["state"] != "done"]
        assert len(others) < 3
        assert set(others) <= {"the process died"}
        content = texts(range(3), folder=str(marks), seconds=0.5)

        def kill():
            wait_for(lambda: any(marks.iterdir()))
            made.scheduler.kill()

        killer = Thread(target=kill)
        killer.start()
        ended = "the scheduler has ended; completed tasks are kept"
        with pytest.raises(tsas.InputError, match=ended):
            outcomes_of(made, "slow", content, shared)
        killer.join()
    for name in ("core", "client", "comm.tcp"):  # one line says it, and the library nothing
        assert not logging.getLogger(f"distributed.{name}").isEnabledFor(logging.ERROR)


def other_version(folder):
    """Return a folder with a tsas of another version."""
    shutil.copytree(ROOT / "tsas_cli", folder / "tsas_cli", ignore=shutil.ignore_patterns("*.pyc"))
    init = folder / "tsas_cli" / "support" / "__init__.py"
    content = init.read_text().replace(f'"{tsas.__version__}"', '"9.9.9"')
    init.write_text(content)
    return folder
