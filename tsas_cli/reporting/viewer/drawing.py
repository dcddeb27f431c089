"""Whether the viewer can draw on this machine: it draws one small picture without a window."""

import os
import re
import subprocess
import tempfile
from pathlib import Path

from tsas_cli.reporting.viewer.child import program
from tsas_cli.reporting.viewer.ports import LOOPBACK, free_ports
from tsas_cli.support.errors import InputError

LONGEST_S = 10.0
SIZE = "64x64"
ADAPTER = re.compile(r'backend: (\w+), device_type: (\w+), name: "([^"]*)"')


def drawn_with() -> str:
    """Return what the viewer draws with, for a person: "Vulkan on …".

    InputError: it is not installed, or cannot draw.
    """
    with tempfile.TemporaryDirectory(prefix="tsas-draw-") as folder:
        picture = Path(folder) / "picture.png"
        (port,) = free_ports(1)
        call = [str(program()), "--bind", LOOPBACK, "--port", str(port), "--headless"]
        call += ["--window-size", SIZE, "--hide-welcome-screen", "--screenshot-to", str(picture)]
        own = {"RUST_LOG": "info", "NO_COLOR": "1", "CI": "true"}  # CI: no usage statistics
        try:
            ended = subprocess.run(  # noqa: S603 # the program of a package of ours
                call,
                env=os.environ | own,
                stdin=subprocess.DEVNULL,
                capture_output=True,
                timeout=LONGEST_S,
                check=False,
            )
        except OSError as error:
            raise InputError(f"cannot be run ({error.strerror})", where=program()) from error
        except subprocess.TimeoutExpired as error:
            raise InputError(f"the viewer draws nothing within {LONGEST_S:g} s") from error
        if ended.returncode or not picture.is_file():
            raise InputError("the viewer finds nothing to draw with", remedy=_remedy())
    log = (ended.stdout + ended.stderr).decode(errors="replace")
    found = ADAPTER.search(log)
    if found is None:
        return "yes"
    backend, kind, name = found.groups()
    return f"{backend} on {name}" + (", in software" if kind == "Cpu" else "")


def _remedy() -> str:
    return (
        "install a driver for Vulkan (without a graphics card on Debian: "
        "`apt install mesa-vulkan-drivers libvulkan1`), or use `tsas view --web`"
    )
