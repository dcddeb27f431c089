"""The viewer opened: on a file or for what is live, in a window or in the browser."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlencode

from tsas_cli.reporting.viewer.child import Child, viewer_child
from tsas_cli.reporting.viewer.page_server import FILE, served_page
from tsas_cli.reporting.viewer.ports import LOOPBACK, free_ports

BIND = ("--bind", LOOPBACK)
ALL_OF_IT = ("--server-memory-limit", "75%")  # beyond it the oldest data go without a word
OPENS_S = 1.0  # after its port answers, a viewer without screen or graphics has failed by then
NO_WELCOME = ("--hide-welcome-screen",)  # it would load examples from elsewhere


@dataclass(frozen=True)
class Viewer:
    """An open viewer; `page` is its address in the browser, `proxy` takes what is live."""

    child: Child
    page: str = ""
    proxy: str = ""

    def wait(self) -> None:
        """Return when the viewer has been closed; see `Child.wait`."""
        self.child.wait()


@contextmanager
def window_of(path: Path, *, port: int | None = None) -> Iterator[Viewer]:
    """Show a file in a window; `port` is its own, any that is free without it."""
    with _window(port, str(path.absolute())) as (child, _):
        yield Viewer(child)


@contextmanager
def page_of(path: Path, *, port: int | None = None) -> Iterator[Viewer]:
    """Serve a file and the viewer's page, both at one port."""
    (own,), (inside,) = free_ports(1, port), free_ports(1)
    file = f"http://{LOOPBACK}:{own}{FILE}"
    with (
        _child_that_serves(inside, file) as child,
        served_page(own, inside=inside, file=path),
    ):
        yield Viewer(child, page=_address(own, file))


@contextmanager
def window_for_live(*, port: int | None = None) -> Iterator[Viewer]:
    """Open a window that shows what is sent to it; `port` is its own."""
    with _window(port, *ALL_OF_IT) as (child, own):
        yield Viewer(child, proxy=_proxy(own))


@contextmanager
def page_for_live(*, port: int | None = None) -> Iterator[Viewer]:
    """Serve the viewer's page and, at the port after it, what is sent to it."""
    (own, data), (inside,) = free_ports(2, port), free_ports(1)
    with (
        _child_that_serves(inside, *ALL_OF_IT, "--port", str(data)) as child,
        served_page(own, inside=inside, data=data),
    ):
        yield Viewer(child, page=_address(own, _proxy(data)), proxy=_proxy(data))


def _proxy(port: int) -> str:
    return f"rerun+http://{LOOPBACK}:{port}/proxy"


def _address(page: int, data: str) -> str:
    """Return the page's address with what it shows.

    WebGL is what every browser draws; dark is what a window is by itself, and what the colours are
    chosen for.
    """
    query = {"url": data, "renderer": "webgl", "theme": "dark", "hide_welcome_screen": "true"}
    return f"http://{LOOPBACK}:{page}/?{urlencode(query)}"


@contextmanager
def _window(port: int | None, *arguments: str) -> Iterator[tuple[Child, int]]:
    (own,) = free_ports(1, port)
    call = [*BIND, *NO_WELCOME, "--port", str(own), *arguments]
    with viewer_child(call, port=own) as child:
        child.wait(OPENS_S)
        yield child, own


@contextmanager
def _child_that_serves(port: int, *arguments: str) -> Iterator[Child]:
    call = [*BIND, "--serve-web", "--web-viewer-port", str(port), *arguments]
    with viewer_child(call, port=port) as child:
        yield child
