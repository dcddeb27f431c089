"""Whether a window can be opened here."""

import os
import sys

SCREENS = ("WAYLAND_DISPLAY", "WAYLAND_SOCKET", "DISPLAY")  # where Linux says that it has one


def has_screen() -> bool:
    """Return whether this session has a screen; macOS and Windows always have one."""
    return sys.platform in {"darwin", "win32"} or any(os.environ.get(name) for name in SCREENS)
