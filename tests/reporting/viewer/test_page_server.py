"""The page's server in front of one that stands for Rerun's own."""

import re
import resource
from contextlib import contextmanager
from http.client import HTTPConnection
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Thread
from urllib.request import urlopen

import pytest

from tsas_cli.reporting.viewer.child import LOOPBACK, free_ports
from tsas_cli.reporting.viewer.open import served_page

PAGE, CONTENT = b"<html>" * 400_000, bytes(range(256)) * 10_000


class Rerun(BaseHTTPRequestHandler):
    """Answers with the path that was asked for, and a page."""

    def do_GET(self):
        if self.path.startswith("/missing"):
            self.send_error(404)
            return
        self.send_response(200)
        self.send_header("Content-Type", "application/wasm")
        self.send_header("X-Path", self.path)
        self.send_header("rerun-final-length", self.path)
        self.end_headers()
        self.wfile.write(PAGE)

    def log_message(self, *_):
        pass


@pytest.fixture
def inside():
    with ThreadingHTTPServer((LOOPBACK, 0), Rerun) as server:
        Thread(target=server.serve_forever, args=(0.01,), daemon=True).start()
        yield server.server_port
        server.shutdown()


@contextmanager
def served(inside, **parts):
    (port,) = free_ports(1)
    with served_page(port, inside=inside, **parts):
        yield port


def get(port, path, host=None):
    connection = HTTPConnection(LOOPBACK, port, timeout=40)
    headers = {"Host": f"{LOOPBACK}:{port}" if host is None else host}
    connection.request("GET", path, headers=headers)
    answer = connection.getresponse()
    content = answer.read()
    connection.close()
    return answer.status, answer.headers, content


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "any name"
    path.write_bytes(CONTENT)
    return path


def test_the_page_is_passed_on_and_the_file_is_beside_it(inside, file):
    with served(inside, file=file) as port:
        status, headers, content = get(port, "/re_viewer_bg.wasm?v=1")
        assert (status, content) == (200, PAGE)
        assert headers["Content-Type"] == "application/wasm"
        assert headers["rerun-final-length"] == "/re_viewer_bg.wasm?v=1"
        status, headers, content = get(port, "/stream.rrd")
        assert (status, content) == (200, CONTENT)
        assert int(headers["Content-Length"]) == len(CONTENT)
        assert "Access-Control-Allow-Origin" not in headers
        assert get(port, "/missing.svg")[0] == 404


def test_the_browser_lets_the_page_reach_this_machine_alone(inside):
    with served(inside, data=[4711]) as port:
        policy = get(port, "/")[1]["Content-Security-Policy"]
    reached = {source for source in policy.split() if "//" in source or "*" in source}
    own = {f"http://{host}:{p}" for host in (LOOPBACK, "localhost") for p in (port, 4711)}
    assert {source.rstrip(";") for source in reached} == own
    assert re.search(r"(^|; )default-src 'self'", policy)


def test_a_page_elsewhere_that_names_this_machine_its_own_gets_nothing(inside, file):
    with served(inside, file=file) as port:
        for path in ("/", "/stream.rrd"):
            assert get(port, path, host=f"evil.example:{port}")[0] == 403
            assert get(port, path, host=f"localhost:{port}")[0] == 200


def test_a_large_file_is_not_in_memory(inside, tmp_path):
    path = tmp_path / "large"
    with path.open("wb") as stream:
        stream.truncate(150_000_000)  # takes no place on the disk
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with served(inside, file=path) as port, urlopen(f"http://{LOOPBACK}:{port}/stream.rrd") as got:
        size = sum(len(piece) for piece in iter(lambda: got.read(1 << 20), b""))
    assert size == 150_000_000
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 50_000  # kB


def test_without_a_file_there_is_none_and_the_port_is_free_again_afterwards(inside):
    with served(inside) as port:
        assert get(port, "/stream.rrd")[2] == PAGE  # that is up to Rerun
    assert free_ports(1, port) == (port,)


def test_a_reader_that_goes_away_stops_nobody_else(inside, file, capfd):
    with served(inside, file=file) as port:
        connection = HTTPConnection(LOOPBACK, port, timeout=40)
        connection.request("GET", "/stream.rrd", headers={"Host": f"{LOOPBACK}:{port}"})
        connection.sock.close()
        connection.close()
        assert get(port, "/stream.rrd")[2] == CONTENT
    assert capfd.readouterr().err == ""
