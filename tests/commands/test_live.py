"""`--live`: real stages beside a real viewer; Rerun's own program tells what arrives there."""

import filecmp
import signal
import subprocess
import sys
import time
import warnings
from contextlib import contextmanager
from urllib.parse import parse_qs, urlsplit

import pytest
from rerun.chunk import RrdReader

from tests.commands.viewing import address_in, ended, started
from tests.processes import SOON_S, alive, family, listening
from tests.reporting.made_folders import make_dataset
from tsas_cli.reporting.viewer.child import LOOPBACK, free_ports, program

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
DONE = "all runs are shown and written"


@pytest.fixture
def dataset(tmp_path):
    return make_dataset(tmp_path / "dataset", ("a", "b"), samples=400)


@contextmanager
def saved(address, path):
    """Save what the viewer's server holds and gets."""
    (proxy,) = parse_qs(urlsplit(address).query)["url"]
    (port,) = free_ports(1)
    call = [program(), "--bind", LOOPBACK, "--port", str(port), "--save", path, proxy]
    with subprocess.Popen(call, stderr=subprocess.DEVNULL) as process:
        try:
            yield
        finally:
            process.kill()


def arrived(path):
    """Return what a file that is still written holds of each run."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # it has no end yet
        try:
            reader = RrdReader(path)
            return {c.entity_path for c in reader.stream() if c.entity_path.startswith("/run/")}
        except (RuntimeError, ValueError):
            return set()


def wait_for(entities, path):
    until = time.monotonic() + SOON_S
    while not entities <= arrived(path):
        assert time.monotonic() < until, entities - arrived(path)
        time.sleep(0.2)


def test_simulated_runs_arrive_and_the_files_are_the_same(dataset, tmp_path, here):
    live, plain, copy = tmp_path / "live", tmp_path / "plain", tmp_path / "copy.rrd"
    with started("simulate", dataset, "--out", live, "--live", state=tmp_path) as process:
        address = address_in(process.stderr)[0]
        with saved(address, copy):
            assert any(DONE in line for line in process.stderr)
            wait_for({f"/run/{run}/f_in_N/simulated" for run in "ab"}, copy)
        processes = family(process.pid)
        assert {where for where, _ in listening(processes)} == {"0100007F"}
        code, out, _ = ended(process)
        assert code == 0
        assert alive(processes) == set()
    assert here("simulate", dataset, "--out", plain)[1].replace(str(plain), str(live)) == out
    names = ["simulation.json", "runs/a.parquet", "runs/b.parquet"]
    assert filecmp.cmpfiles(live, plain, names, shallow=False)[0] == names


def test_tracked_runs_arrive(tmp_path):
    settings = tmp_path / "short.toml"
    settings.write_text("[reference]\nduration_s = 2.0\n")
    call = ("track", "--controller", "pid", "--settings", settings, "--out", tmp_path / "out")
    with started(*call, "--live", "--json", state=tmp_path) as process:
        copy = tmp_path / "copy.rrd"
        with saved(address_in(process.stderr)[0], copy):
            assert any(DONE in line for line in process.stderr)
            wait_for({r"/run/pid-undisturbed/tracking_error_N"}, copy)
        code, out, _ = ended(process)
    assert code == 0
    assert out.startswith("{")
    assert (tmp_path / "out" / "tracking.json").is_file()


def test_a_stage_that_is_stopped_writes_nothing_and_leaves_no_viewer(dataset, tmp_path):
    many = make_dataset(tmp_path / "many", [f"r{n}" for n in range(30)], samples=4000)
    with started("simulate", many, "--out", tmp_path / "out", "--live", state=tmp_path) as process:
        address_in(process.stderr)
        processes = family(process.pid)
        code, out, _ = ended(process, signal.SIGTERM)
        assert (code, out) == (130, "")
        assert alive(processes) == set()
    assert not (tmp_path / "out").exists()
    assert [p.name for p in tmp_path.iterdir() if p.name.startswith(".out")] == []


def test_a_wrong_call_is_one_line_as_without_it(dataset, tmp_path, refused):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "mine").touch()
    call = ("simulate", dataset, "--out", tmp_path / "out", "--live", "--quiet")
    assert "already exists" in refused(*call)


def test_a_viewer_that_goes_away_costs_no_result(dataset, tmp_path):
    out = tmp_path / "out"
    with started("simulate", dataset, "--out", out, "--live", state=tmp_path) as process:
        address_in(process.stderr)
        (viewer,) = family(process.pid) - {process.pid}
        subprocess.run(["kill", "-KILL", str(viewer)], check=True)  # noqa: S607 # whichever is there
        printed, stderr = process.communicate(timeout=SOON_S)
    assert (out / "simulation.json").is_file(), stderr
    assert "RMSE" in printed
    assert process.returncode == 0
    assert "- some runs were not shown" in stderr
