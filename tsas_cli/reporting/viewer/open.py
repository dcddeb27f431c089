"""The viewer opened: on a file or for what is live, in a window or in the browser.

It counts how it is used, which a person should know before it starts.
"""

import os
import shutil
import sys
from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import dataclass
from http import HTTPStatus
from http.client import HTTPConnection
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from urllib.parse import urlencode

from tsas_cli.reporting.viewer.child import DRAWS, LOOPBACK, Child, free_ports, viewer_child

PAGE_STREAM = "/stream.rrd"
KEPT = ("Content-Type", "Content-Length", "rerun-final-length")  # what the page reads of headers
HOSTS = (LOOPBACK, "localhost")
POLICY = (
    "default-src 'self' data: blob:; "
    "script-src 'self' 'unsafe-inline' 'wasm-unsafe-eval' blob:; style-src 'self' 'unsafe-inline'"
)
AT_ONCE = 1 << 20  # bytes
BIND = ("--bind", LOOPBACK)
ALL_OF_IT = ("--server-memory-limit", "75%")  # beyond it the oldest data go without a word
OPENS_S = 10.0  # after its port answers, a window is taken to be open, whatever the log says
SCREENS = ("WAYLAND_DISPLAY", "WAYLAND_SOCKET", "DISPLAY")  # where Linux says that it has one
NOTE = (
    "the viewer is Rerun's; its window sends Rerun usage statistics, never data, until you run "
    "`rerun analytics disable`; in the browser tsas keeps it from calling anyone (said once)"
)
NO_WELCOME = ("--hide-welcome-screen",)  # it would load examples from elsewhere


@dataclass(frozen=True)
class Viewer:
    """An open viewer; `page` is its address in the browser, `proxy` takes what is live."""

    child: Child
    page: str = ""
    proxy: str = ""


def opened(
    file: Path | None = None, *, in_browser: bool, port: int | None = None
) -> AbstractContextManager[Viewer]:
    """Show a file, or without one what is sent, in a window or on a page that is served.

    `port` is the window's or the page's own, any that is free without it; what is live goes to
    the page's next one.
    """
    return _page(file, port) if in_browser else _window(file, port)


def has_screen() -> bool:
    """Return whether this session has a screen; macOS always has one."""
    return sys.platform == "darwin" or any(os.environ.get(name) for name in SCREENS)


def note_once() -> str:
    """Return the note the first time that a user is about to start the viewer, then nothing.

    Where nothing can be remembered it is returned each time.
    """
    import platformdirs

    root = os.environ.get("TSAS_STATE_DIR") or platformdirs.user_state_dir("tsas")
    marker = Path(root) / "viewer-analytics-said"
    if marker.exists():
        return ""
    with suppress(OSError):
        marker.parent.mkdir(parents=True, exist_ok=True)
        marker.touch()
    return NOTE


@contextmanager
def _window(file: Path | None, port: int | None) -> Iterator[Viewer]:
    (taken,) = free_ports(1, port)
    shown = ALL_OF_IT if file is None else (str(file.absolute()),)
    call = [*BIND, *NO_WELCOME, "--port", str(taken), *shown]
    with viewer_child(call, port=taken) as child:
        child.wait(OPENS_S, DRAWS)
        yield Viewer(child, proxy=_proxy(taken))


@contextmanager
def _page(file: Path | None, port: int | None) -> Iterator[Viewer]:
    taken, *data = free_ports(2 if file is None else 1, port)
    (inside,) = free_ports(1)
    call = [*BIND, "--serve-web", "--web-viewer-port", str(inside)]
    if file is None:
        shown = _proxy(data[0])
        call += [*ALL_OF_IT, "--port", str(data[0])]
    else:
        shown = f"http://{LOOPBACK}:{taken}{PAGE_STREAM}"
        call.append(shown)
    with (
        viewer_child(call, port=inside) as child,
        served_page(taken, inside=inside, file=file, data=data),
    ):
        # WebGL is what every browser draws; dark is what a window is by itself, and what the
        # colours are chosen for.
        query = {"url": shown, "renderer": "webgl", "theme": "dark", "hide_welcome_screen": "true"}
        address = f"http://{LOOPBACK}:{taken}/?{urlencode(query)}"
        yield Viewer(child, page=address, proxy=shown)


def _proxy(port: int) -> str:
    return f"rerun+http://{LOOPBACK}:{port}/proxy"


@contextmanager
def served_page(
    port: int, *, inside: int, file: Path | None = None, data: Sequence[int] = ()
) -> Iterator[None]:
    """Serve the page that Rerun serves at the port `inside`, and a file at `PAGE_STREAM`.

    Rerun's own page calls its makers, a font server and GitHub, and no setting of theirs stops
    that: a content security policy lets the browser talk to this machine alone. The file is read
    from the disk here, so that only the browser holds it in memory.

    Of other addresses the page may only reach the ports `data`, which send what is live.
    """
    allowed = [f"{host}:{port}" for host in HOSTS]
    reached = " ".join(f"http://{host}:{one}" for one in (port, *data) for host in HOSTS)
    policy = f"{POLICY}; connect-src 'self' {reached} data: blob:"

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            # A page elsewhere may call this machine by its own name.
            if self.headers["Host"] not in allowed:
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
