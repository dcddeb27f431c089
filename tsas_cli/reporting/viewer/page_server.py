"""The viewer's page on 127.0.0.1, and beside it the file that it shows.

Rerun's own page calls its makers, a font server and GitHub, and no setting of theirs stops that. So
it is passed on with a content security policy: the browser lets it talk to this machine alone. The
page reads the file from the disk through this server, so that only the browser holds it in memory.
"""

import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from http import HTTPStatus
from http.client import HTTPConnection
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread

from tsas_cli.reporting.viewer.ports import LOOPBACK

PAGE_STREAM = "/stream.rrd"
KEPT = ("Content-Type", "Content-Length", "rerun-final-length")  # what the page reads of headers
HOSTS = (LOOPBACK, "localhost")
POLICY = (
    "default-src 'self' data: blob:; "
    "script-src 'self' 'unsafe-inline' 'wasm-unsafe-eval' blob:; style-src 'self' 'unsafe-inline'"
)
AT_ONCE = 1 << 20  # bytes


@contextmanager
def served_page(
    port: int, *, inside: int, file: Path | None = None, data: Sequence[int] = ()
) -> Iterator[None]:
    """Serve the page that Rerun serves at the port `inside`, and a file at `PAGE_STREAM`.

    Of other addresses the page may only reach the ports `data`, which send what is live.
    """
    own = [f"{host}:{port}" for host in HOSTS]
    reached = " ".join(f"http://{host}:{one}" for one in (port, *data) for host in HOSTS)
    policy = f"{POLICY}; connect-src 'self' {reached} data: blob:"

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            if self.headers["Host"] not in own:  # a page elsewhere that calls this machine its own
                self.send_error(HTTPStatus.FORBIDDEN)
                return
            with suppress(ConnectionError):  # the browser has seen enough
                if file is not None and self.path == PAGE_STREAM:
                    self._send_file(file)
                else:
                    self._pass_on()

        def _send_file(self, path: Path) -> None:
            with path.open("rb") as content:
                self.send_response(HTTPStatus.OK)
                self.send_header("Content-Type", "application/octet-stream")
                self.send_header("Content-Length", str(path.stat().st_size))
                self.end_headers()
                shutil.copyfileobj(content, self.wfile, AT_ONCE)

        def _pass_on(self) -> None:
            connection = HTTPConnection(LOOPBACK, inside)
            try:
                connection.request("GET", self.path)
                response = connection.getresponse()
                self.send_response(response.status)
                for name in KEPT:
                    if (value := response.headers[name]) is not None:
                        self.send_header(name, value)
                self.send_header("Content-Security-Policy", policy)
                self.end_headers()
                shutil.copyfileobj(response, self.wfile, AT_ONCE)
            finally:
                connection.close()

        def log_message(self, format: str, *args: object) -> None:  # noqa: A002 # theirs
            """Say nothing: the terminal is for the person."""

    with ThreadingHTTPServer((LOOPBACK, port), Handler) as server:
        server.daemon_threads = True
        thread = Thread(target=server.serve_forever, args=(0.05,), daemon=True)
        thread.start()
        try:
            yield
        finally:
            server.shutdown()
            thread.join()
