"""The viewer opened: on a file or for what is live, in a window or in the browser.

It counts how it is used, which a person should know before it starts.
"""

import os
import sys
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlencode

from tsas_cli.reporting.viewer.child import Child, viewer_child
from tsas_cli.reporting.viewer.page_server import PAGE_STREAM, served_page
from tsas_cli.reporting.viewer.ports import LOOPBACK, free_ports

BIND = ("--bind", LOOPBACK)
ALL_OF_IT = ("--server-memory-limit", "75%")  # beyond it the oldest data go without a word
OPENS_S = 1.0  # after its port answers, a viewer without screen or graphics has failed by then
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
    """Return whether this session has a screen; macOS and Windows always have one."""
    return sys.platform in {"darwin", "win32"} or any(os.environ.get(name) for name in SCREENS)


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
    (own,) = free_ports(1, port)
    shown = ALL_OF_IT if file is None else (str(file.absolute()),)
    call = [*BIND, *NO_WELCOME, "--port", str(own), *shown]
    with viewer_child(call, port=own) as child:
        child.wait(OPENS_S)
        yield Viewer(child, proxy=_proxy(own))


@contextmanager
def _page(file: Path | None, port: int | None) -> Iterator[Viewer]:
    own, *data = free_ports(2 if file is None else 1, port)
    (inside,) = free_ports(1)
    call = [*BIND, "--serve-web", "--web-viewer-port", str(inside)]
    if file is None:
        shown = _proxy(data[0])
        call += [*ALL_OF_IT, "--port", str(data[0])]
    else:
        shown = f"http://{LOOPBACK}:{own}{PAGE_STREAM}"
        call.append(shown)
    with (
        viewer_child(call, port=inside) as child,
        served_page(own, inside=inside, file=file, data=data),
    ):
        yield Viewer(child, page=_address(own, shown), proxy=shown)


def _proxy(port: int) -> str:
    return f"rerun+http://{LOOPBACK}:{port}/proxy"


def _address(page: int, shown: str) -> str:
    """Return the page's address with what it shows.

    WebGL is what every browser draws; dark is what a window is by itself, and what the colours are
    chosen for.
    """
    query = {"url": shown, "renderer": "webgl", "theme": "dark", "hide_welcome_screen": "true"}
    return f"http://{LOOPBACK}:{page}/?{urlencode(query)}"
