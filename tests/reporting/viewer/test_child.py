"""A script stands for the viewer here; tests/commands/test_view.py starts the real one."""

import os
import signal
import socket
import subprocess
import sys

import pytest

from tests.outputs import refused
from tests.processes import SOON_S, alive, family
from tsas_cli.reporting.viewer import child
from tsas_cli.reporting.viewer.child import DRAWS, LOOPBACK, free_ports, viewer_child
from tsas_cli.support.errors import InputError

SERVE = f"""#!{sys.executable}
import signal, socket, subprocess, sys, time
if sys.argv[2] == "stubborn":
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
server = socket.create_server(("{LOOPBACK}", int(sys.argv[1])))
if sys.argv[2] in ("opens", "cannot"):
    time.sleep(0.5)
    print("Error: no screen" if sys.argv[2] == "cannot" else "wgpu adapter backend: Gl", flush=True)
    time.sleep(0.3)
    sys.exit(sys.argv[2] == "cannot")
server.accept() if sys.argv[2] == "closed" else time.sleep(60)
"""
FAIL = f"""#!{sys.executable}
import sys
print("starting\\n\\nError: no adapter\\n", file=sys.stderr)
sys.exit(3)
"""


@pytest.fixture
def script(tmp_path, monkeypatch):
    def install(text):
        path = tmp_path / "viewer"
        path.write_text(text)
        path.chmod(0o755)
        monkeypatch.setattr(child, "program", lambda: path)
        return path

    return install


@pytest.fixture
def port():
    return free_ports(1)[0]


@pytest.fixture
def viewer(script, port):
    """Return a function that opens a viewer of a kind."""
    script(SERVE)
    return lambda kind="": viewer_child([str(port), kind], port=port)


@pytest.mark.parametrize("kind", ["willing", "stubborn"])
def test_it_answers_in_the_block_and_is_gone_after_it(viewer, port, monkeypatch, kind):
    if kind == "stubborn":
        monkeypatch.setattr(child, "END_S", 0.3)
    with viewer(kind) as running:
        socket.create_connection((LOOPBACK, port), timeout=1).close()
        assert os.getpgid(running.process.pid) == running.process.pid
    assert not family(running.process.pid)
    assert running.process.returncode == (-signal.SIGKILL if kind == "stubborn" else -15)


def test_a_wait_can_be_short(viewer):
    with viewer() as running:
        running.wait(0.1)
        assert family(running.process.pid)


def test_a_window_is_open_when_the_viewer_draws_and_not_before(viewer):
    with viewer("opens") as running:
        running.wait(SOON_S, DRAWS)
        assert running.process.poll() is None
    with pytest.raises(InputError, match="no screen"), viewer("cannot") as running:
        running.wait(SOON_S, DRAWS)


def test_it_is_gone_after_an_error_too(viewer):
    with pytest.raises(ZeroDivisionError), viewer() as running:
        1 / 0  # noqa: B018
    assert not family(running.process.pid)


def test_a_viewer_that_is_closed_is_no_failure(viewer):
    with viewer("closed") as running:
        running.wait()
    assert running.process.returncode == 0


def test_a_viewer_that_fails_is_quoted(script, port):
    script(FAIL)
    told = r"failed \(Error: no adapter\).*--web.*tsas doctor"
    refused(viewer_child([], port=port), told)


def test_a_viewer_that_does_not_answer_is_ended(script, monkeypatch):
    script(SERVE)
    monkeypatch.setattr(child, "START_S", 0.3)
    port, other = free_ports(2)
    refused(viewer_child([str(port), ""], port=other), f"does not answer on port {other}")


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux ends the children of the dead")
def test_it_dies_with_a_parent_that_is_killed(script, port):
    path = script(SERVE)
    parent = f"""
from pathlib import Path
from tsas_cli.reporting.viewer import child
child.program = lambda: Path({str(path)!r})
with child.viewer_child(["{port}", ""], port={port}) as running:
    print(running.process.pid, flush=True)
    running.wait()
"""
    with subprocess.Popen([sys.executable, "-c", parent], stdout=subprocess.PIPE) as process:
        pid = int(process.stdout.readline())
        assert family(pid)
        process.kill()
    assert alive({pid}) == set()


def test_free_ports_are_free_and_no_two_are_the_same():
    ports = free_ports(5)
    assert len(set(ports)) == 5
    for port in ports:
        socket.create_server((LOOPBACK, port)).close()


def test_ports_asked_for_follow_each_other_up_to_the_last():
    first = next(p for p in iter(lambda: free_ports(1)[0], None) if p < 65000)
    assert free_ports(2, first) == (first, first + 1)
    with pytest.raises(InputError, match="port 65536"):
        free_ports(2, 65535)


@pytest.mark.parametrize("address", [LOOPBACK, "0.0.0.0"])  # noqa: S104 # by others
def test_a_port_in_use_is_refused_whoever_it_is_bound_to(address):
    with socket.create_server((address, 0)) as taken:
        port = taken.getsockname()[1]
        told = rf"^--port: port {port} cannot be had \(.*in use.*\); choose"
        with pytest.raises(InputError, match=told):
            free_ports(1, port)
