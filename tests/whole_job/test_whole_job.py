"""The main job, twice in different surroundings: the same bytes, and no call to the network."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.reporting.stream.streams import read
from tests.whole_job.made import make
from tests.whole_job.stages import STAGES

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
OUTSIDE = re.compile(r"AF_INET|AF_NETLINK|AF_PACKET")  # in a line of strace: not a pipe of its own
ASCII = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
START = "start_time"  # of a recording's properties
SEALED = ["unshare", "--map-root-user", "--net"]
TRACED = ["strace", "-f", "-qq", "--seccomp-bpf", "-e", "trace=network", "-o"]


class Job:
    """One run of the job: where, and what was seen of the network."""

    def __init__(self, folder, made, environment, *, umask, wrapped):
        """Run all stages on a copy of what was made; `wrapped` goes before the call."""
        shutil.copytree(made, folder)
        self.folder = folder
        self.calls = folder.parent / f"{folder.name}-calls.txt"
        self.kept = folder.parent / f"{folder.name}-kept"  # what programs remember of a user
        watched = {"NETWORK_CALLS": str(self.calls), "RERUN": "on"}
        watched |= {f"XDG_{kind}_HOME": str(self.kept / kind) for kind in ("CONFIG", "DATA")}
        paths = [str(HERE), str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])]
        done = subprocess.run(
            [*wrapped, sys.executable, HERE / "stages.py"],
            cwd=folder,
            env=os.environ | environment | watched | {"PYTHONPATH": os.pathsep.join(paths)},
            umask=umask,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr

    def files(self):
        """Return the content of each file by its path in the folder."""
        return {
            path.relative_to(self.folder).as_posix(): path.read_bytes()
            for path in sorted(self.folder.rglob("*"))
            if path.is_file()
        }


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Return a folder with what the job reads."""
    folder = tmp_path_factory.mktemp("made") / "files"
    make(folder)
    return folder


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    """Return where the system calls of the first job are written, if this machine can do so."""
    return tmp_path_factory.mktemp("log") / "strace.txt"


@pytest.fixture(scope="module")
def first(made, log, tmp_path_factory):
    """Return the job in plain surroundings, with its system calls watched."""
    plain = ASCII | {"TZ": "UTC", "LANG": "C", "PYTHONHASHSEED": "1"}
    plain |= {"TSAS_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    wrapped = [*TRACED, str(log)] if works([*TRACED, str(log)]) else []
    return Job(tmp_path_factory.mktemp("first") / "a", made, plain, umask=0o022, wrapped=wrapped)


@pytest.fixture(scope="module")
def second(made, tmp_path_factory):
    """Return the job elsewhere in every respect, without a network where that works."""
    root = tmp_path_factory.mktemp("second")
    elsewhere = {"TZ": "Asia/Kolkata", "PYTHONUTF8": "1", "PYTHONHASHSEED": "2"}
    elsewhere |= {"TSAS_THREADS": "2", "OPENBLAS_NUM_THREADS": "2"} | german(root / "locale")
    elsewhere["OPENBLAS_THREAD_TIMEOUT"] = "4"  # its threads sleep while they wait
    wrapped = SEALED if works(SEALED) else []
    return Job(root / "tiefer" / "Läufe 2", made, elsewhere, umask=0o077, wrapped=wrapped)


def works(call):
    """Say whether a program is here and may do what it is for."""
    if shutil.which(call[0]) is None:
        return False
    return subprocess.run([*call, "true"], capture_output=True, check=False).returncode == 0


def german(folder):
    """Return the environment of a language with decimal commas, made here where that works."""
    folder.mkdir()
    name = "de_DE.UTF-8"
    if shutil.which("localedef"):
        call = ["localedef", "-i", "de_DE", "-f", "UTF-8", folder / name]
        subprocess.run(call, capture_output=True, check=False)  # it warns of what is not needed
    where = {"LOCPATH": str(folder)} if (folder / name).is_dir() else {}
    return where | {"LC_ALL": name, "LANG": name}


def test_files_are_the_same_bytes_in_another_folder_zone_language_and_number_of_threads(
    first, second
):
    ours, theirs = first.files(), second.files()
    assert list(ours) == list(theirs)
    for number, stage in enumerate(STAGES):
        out = stage.split("--out ")[1].split()[0]
        assert any(name.split("/")[0] == out for name in ours), stage
        assert ours[f"printed-{number}.txt"]
    streams = [name for name in ours if name.endswith(".rrd")]
    assert len(streams) > 4
    for files in (ours, theirs):  # whose checksums differ too
        for name in [name for name in files if name.endswith("/SHA256SUMS")]:
            files[name] = b"".join(x for x in files[name].splitlines(True) if b".rrd" not in x)
    assert {n for n in ours if ours[n] != theirs[n]} <= set(streams)
    suffixes = {Path(name).suffix for name in ours}
    assert {".json", ".toml", ".parquet", ".html", ".txt"} <= suffixes


@pytest.mark.parametrize("stage", ["calibrate", "track", "identify"])
def test_streams_hold_the_same_but_for_when_they_were_recorded(first, second, stage):
    # Rerun numbers rows, and writes entities, by the clock: no two streams are the same bytes.
    ours, theirs = (read(job.folder / stage / "stream.rrd") for job in (first, second))
    assert ours.keys() == theirs.keys()
    for entity, one in ours.items():
        other = theirs[entity]
        assert one.rows == other.rows, entity
        assert {n: values for n, values in one.static.items() if not n.endswith(START)} == {
            n: values for n, values in other.static.items() if not n.endswith(START)
        }
        assert set(one.times) == set(other.times)
        for timeline in set(one.times) - {"log_time", "log_tick"}:
            assert (one.at(timeline) == other.at(timeline)).all(), entity


def test_no_file_says_where_or_by_whom_it_was_made(first):
    for name, content in first.files().items():
        assert str(first.folder).encode() not in content, name


def test_nothing_is_asked_of_a_network_and_rerun_counts_nothing(first, second):
    for job in (first, second):
        assert not job.calls.exists(), job.calls.read_text()
        assert [path for path in job.kept.rglob("*") if "rerun" in path.name] == []


def test_not_even_by_compiled_code(first, log):
    if not log.exists():
        pytest.skip("strace is not installed or may not trace here")
    calls = log.read_text(encoding="utf-8").splitlines()
    assert [line for line in calls if OUTSIDE.search(line)] == []


def test_the_ban_itself_works(tmp_path):
    calls = tmp_path / "calls.txt"
    ask = "import socket\ntry: socket.create_connection(('127.0.0.1', 9))\nexcept OSError: pass"
    subprocess.run(
        [sys.executable, "-c", ask],
        env=os.environ | {"PYTHONPATH": str(HERE), "NETWORK_CALLS": str(calls)},
        check=True,
    )
    assert calls.read_text().startswith("socket.getaddrinfo")
    if works([*TRACED, str(tmp_path / "strace.txt")]):
        subprocess.run([*TRACED, tmp_path / "strace.txt", sys.executable, "-c", ask], check=True)
        assert OUTSIDE.search((tmp_path / "strace.txt").read_text())


def test_output_is_readable_where_the_language_knows_ascii_only():
    call = [sys.executable, "-m", "tsas_cli", "explain", "backlash"]
    done = subprocess.run(call, env=os.environ | ASCII, capture_output=True, check=False)
    assert (done.returncode, done.stderr) == (0, b"")
    assert "−" in done.stdout.decode("utf-8")
