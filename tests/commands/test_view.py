import json
import os
import shutil
import signal
import subprocess
import sys
from urllib.parse import parse_qs, urlsplit
from urllib.request import urlopen

import pytest

from tests.commands.viewing import ADDRESS, address_in, ended, started
from tests.processes import SOON_S, alive, family, listening
from tests.reporting.made_folders import make_dataset, make_simulation
from tests.reporting.stream.streams import make_stream
from tsas_cli.reporting.viewer.child import free_ports
from tsas_cli.reporting.viewer.open import SCREENS

LOOPBACK = "0100007F"  # 127.0.0.1, as /proc/net writes it
on_linux = pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")


@pytest.fixture(scope="module")
def stream(tmp_path_factory):
    return make_stream(tmp_path_factory.mktemp("view") / "waves.rrd")


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    root = tmp_path_factory.mktemp("folders")
    dataset = make_dataset(root / "dataset", ("a",), samples=400)
    make_simulation(dataset, root / "simulated")
    return root


@pytest.fixture
def refused(refused_here, monkeypatch, tmp_path):
    """Call the command here, which ends by itself."""
    monkeypatch.setenv("CI", "true")
    monkeypatch.setenv("TSAS_STATE_DIR", str(tmp_path))
    return lambda *words: refused_here("view", *words)


def read(address):
    with urlopen(address, timeout=SOON_S) as response:  # noqa: S310 # an address of this machine
        return response.read()


def shown_by(address):
    """Return the file that the viewer's page is told to show."""
    (url,) = parse_qs(urlsplit(address).query)["url"]
    return read(url)


@on_linux
@pytest.mark.parametrize(
    "number", [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.large)]
)
def test_the_page_is_served_here_alone_and_ends_without_a_trace(stream, tmp_path, number):
    with started("view", stream, state=tmp_path) as process:
        address = address_in(process.stdout)
        assert b"re_viewer.js" in read(address[0])
        assert len(read(f"http://127.0.0.1:{address[1]}/re_viewer_bg.wasm")) > 1e7
        assert shown_by(address[0]) == stream.read_bytes()
        processes = family(process.pid)
        assert len(processes) == 2  # this one and the viewer's own program
        places = listening(processes)
        assert {where for where, _ in places} == {LOOPBACK}
        assert int(address[1]) in {port for _, port in places}
        code, out, err = ended(process, number)
        assert (code, out) == (0, "")
        assert err.endswith("- Ctrl-C ends it\n")
        assert alive(processes) == set()


def test_analytics_are_reported_and_the_port_can_be_chosen(stream, tmp_path):
    (port,) = free_ports(1)
    with started("view", stream, "--web", "--port", port, state=tmp_path) as process:
        assert int(address_in(process.stdout)[1]) == port
        assert ended(process)[2].count("rerun analytics disable") == 1


def test_folders_make_a_stream_that_is_gone_afterwards(folders, tmp_path):
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    paths = [folders / "dataset", folders / "simulated"]
    with started("view", *paths, state=tmp_path, TMPDIR=str(temporary)) as process:
        content = shown_by(address_in(process.stdout)[0])
        assert content.startswith(b"RRF2")
        assert b"simulation" in content
        assert list(temporary.glob("tsas-view-*/stream.rrd"))
        assert ended(process)[0] == 0
    assert list(temporary.iterdir()) == []


def test_a_stream_in_the_folder_is_what_is_shown_and_told_as_json(folders, stream, tmp_path):
    folder = shutil.copytree(folders / "dataset", tmp_path / "dataset")
    shutil.copy(stream, folder / "stream.rrd")
    with started("view", folder, "--json", state=tmp_path) as process:
        content = ""
        while not content.endswith("}\n"):
            content += process.stdout.readline()
        summary = json.loads(content)
        assert summary["stream"] == str(folder / "stream.rrd")
        assert ADDRESS.fullmatch(summary["address"])
        assert shown_by(summary["address"]) == stream.read_bytes()
        assert ended(process)[:2] == (0, "")


def test_what_cannot_be_shown_is_one_line(folders, stream, tmp_path, refused):
    for path, message in (
        (tmp_path / "missing", "is not there"),
        (tmp_path, "neither a dataset nor what a stage wrote"),
    ):
        line = refused(path)
        assert line.startswith(f"tsas: {path}: ")
        assert message in line
    assert f"{stream}: is a file among others" in refused(folders / "dataset", stream)


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere there is always a screen")
def test_a_screen_that_cannot_be_reached_is_one_line(stream, refused, monkeypatch):
    for name in SCREENS:
        monkeypatch.setenv(name, ":4711" if name == "DISPLAY" else "")
    line = refused(stream)
    assert line.startswith("tsas: the viewer has failed (")
    assert "tsas view --web" in line


@on_linux
@pytest.mark.skipif(shutil.which("Xvfb") is None, reason="no Xvfb here to open a window on")
def test_a_window_opens_where_there_is_a_screen(stream, tmp_path):
    reader, writer = os.pipe()
    call = ["Xvfb", "-displayfd", str(writer), "-screen", "0", "800x600x24"]
    with subprocess.Popen(call, pass_fds=[writer], stderr=subprocess.DEVNULL) as screen:
        os.close(writer)
        display = ":" + os.read(reader, 20).decode().strip()
        os.close(reader)
        try:
            with started("view", stream, state=tmp_path, DISPLAY=display) as process:
                line = process.stderr.readline()
                while "close the window" not in line:
                    assert "failed" not in line or pytest.skip(f"no window here: {line}")
                    line = process.stderr.readline()
                processes = family(process.pid)
                assert {where for where, _ in listening(processes)} == {LOOPBACK}
                assert ended(process)[:2] == (0, "")
                assert alive(processes) == set()
        finally:
            screen.terminate()


def test_without_the_viewer_it_is_reported_what_to_install(stream, refused, monkeypatch):
    monkeypatch.setattr("tsas_cli.reporting.viewer.child.find_spec", lambda name: None)
    line = refused(stream, "--web")
    assert line.startswith("tsas: package rerun-sdk: the viewer's program is not installed")
    assert "pip install" in line
