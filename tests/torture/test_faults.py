"""A full disk, folders that may not be written, signals, a clock that was set back."""

import hashlib
import os
import resource
import shutil
import signal
import subprocess
import sys
import time

import pytest

from tests.torture.bench import tree

EARLIER = '{"stage": "check"}'
ROOT_ONLY = pytest.mark.skipif(os.geteuid() != 0, reason="only root may mount")


@pytest.fixture
def mounted(tmp_path):
    """Mount a file system of some size in memory, and return how."""
    place = tmp_path / "small"
    place.mkdir()

    def mount(options):
        again = "remount," if os.path.ismount(place) else ""
        call = ["mount", "-t", "tmpfs", "-o", again + options, "tmpfs", str(place)]
        done = subprocess.run(call, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            pytest.skip(f"nothing can be mounted here: {done.stderr.strip()}")
        return place

    yield mount
    if os.path.ismount(place):
        subprocess.run(["umount", str(place)], check=True)  # noqa: S607


def is_one_line(done, told):
    return done.returncode == 2 and done.stderr.count("\n") == 1 and told in done.stderr


@ROOT_ONLY
@pytest.mark.parametrize("size", ["8k", "24k"])
def test_a_full_disk_is_one_line_and_leaves_the_earlier_output(dataset, tsas, mounted, size):
    inputs, place = tree(dataset), mounted(f"size={size}")
    (place / "out").mkdir()
    (place / "out" / "check.json").write_text(EARLIER)
    digest = hashlib.sha256(EARLIER.encode()).hexdigest()
    (place / "out" / "SHA256SUMS").write_text(f"{digest}  check.json\n")
    done = tsas("check", dataset, "--rrd", "--out", place / "out", "--force")
    assert is_one_line(done, ""), done.stderr
    assert "disk full" in done.stderr or "No space left on device" in done.stderr
    assert str(place / "out") in done.stderr
    assert [p.name for p in place.iterdir()] == ["out"]
    assert (place / "out" / "check.json").read_text() == EARLIER
    assert tree(dataset) == inputs
    mounted("size=4m")
    assert tsas("check", dataset, "--rrd", "--out", place / "out", "--force").returncode == 0


def test_a_file_that_may_not_grow_is_one_line(dataset, tsas, tmp_path):
    def limited():
        resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000))

    out = tmp_path / "out"
    done = tsas("simulate", dataset, "--out", out, preexec_fn=limited)
    assert is_one_line(done, "cannot be written (")
    assert "File too large" in done.stderr
    assert sorted(p.name for p in tmp_path.iterdir()) == ["dataset"]


@pytest.mark.parametrize("megabytes", [300, 700, 850])
def test_a_limit_of_memory_below_what_the_libraries_take_is_one_line(
    dataset, tsas, tmp_path, megabytes
):
    """Libraries abort there, or never end: OpenBLAS asks for its buffers for ever."""

    def limited():
        resource.setrlimit(resource.RLIMIT_AS, (megabytes * 10**6, megabytes * 10**6))

    out = tmp_path / "out"
    done = tsas("simulate", dataset, "--out", out, preexec_fn=limited, timeout=60)
    assert is_one_line(done, f"{megabytes} MB of memory; expected at least 1.2 GB")
    assert not out.exists()


@ROOT_ONLY
def test_a_read_only_file_system_is_one_line(dataset, tsas, mounted):
    place = mounted("size=4m")
    shutil.copytree(dataset, place / "dataset")
    mounted("ro")
    done = tsas("check", place / "dataset", "--out", place / "out")
    assert is_one_line(done, "cannot be written (Read-only file system)")
    assert tsas("check", place / "dataset").returncode == 0  # what is read only can be read


def test_a_folder_that_may_not_be_written_is_one_line(dataset, tmp_path):
    """As another person where this one is root, whom permissions do not bind."""
    closed = tmp_path / "closed"
    closed.mkdir(mode=0o555)
    program = (
        "import os, sys\n"
        "from pathlib import Path\n"
        "from tsas_cli.support.errors import InputError\n"
        "from tsas_cli.support.files import new_folder\n"
        "os.chdir('/')\n"
        "if os.geteuid() == 0: os.setgroups([]); os.setgid(65534); os.setuid(65534)\n"
        "os.chdir(sys.argv[1]) if os.access(sys.argv[1], os.X_OK) else sys.exit(77)\n"
        "try:\n"
        "    with new_folder(Path('out'), stage='check', inputs=()): pass\n"
        "except InputError as error: sys.exit(str(error))\n"
    )
    for folder in (tmp_path, *tmp_path.parents[:2]):
        folder.chmod(folder.stat().st_mode | 0o055) if folder != closed else None
    call = [sys.executable, "-c", program, str(closed)]
    done = subprocess.run(call, capture_output=True, text=True, check=False)
    if done.returncode == 77:
        pytest.skip("another person cannot reach the tests' folder")
    assert done.stderr.startswith("out: cannot be written (Permission denied)"), done.stderr
    assert list(closed.iterdir()) == []


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_stage_that_is_asked_to_end_cleans_up(dataset, tmp_path, number):
    out = tmp_path / "out"
    program = (
        "import os, sys, time\n"
        "import tsas_cli.recordings.quality as quality, tsas_cli.stages.check as check\n"
        "def slow(*_):\n"
        "    print('inside', flush=True)\n"
        "    time.sleep(60)\n"
        "check.check_dataset = slow\n"
        "from tsas_cli.__main__ import main\n"
        "main()\n"
    )
    call = [sys.executable, "-c", program, "check", str(dataset), "--out", str(out)]
    with subprocess.Popen(
        call, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout.readline() == "inside\n"
        assert len(list(tmp_path.iterdir())) == 3  # the dataset, a lock, what is on its way
        process.send_signal(number)
        _, said = process.communicate(timeout=120)
    assert (process.returncode, said) == (130, "")
    assert [p.name for p in tmp_path.iterdir()] == ["dataset"]


def test_a_clock_that_was_set_back_costs_nothing_that_verify_would_not_find(
    dataset, tsas, tmp_path
):
    later = time.time() + 3 * 86400
    for path in (dataset, *dataset.rglob("*")):
        os.utime(path, (later, later))
    out = tmp_path / "out"
    assert tsas("check", dataset, "--out", out).returncode == 0
    os.utime(out / "check.json", (later, later))
    assert tsas("check", dataset, "--out", out, "--force").returncode == 0
    assert (out / "check.json").stat().st_mtime < later
    assert tsas("verify", out).returncode == 0
    os.utime(out / "check.json", (later, later))
    with (dataset / "dataset.toml").open("a") as file:  # older than what was made of it
        file.write("\n# changed\n")
    done = tsas("verify", out)
    assert is_one_line(done, "changed or missing")
    assert "dataset.toml" in done.stderr
