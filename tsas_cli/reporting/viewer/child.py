"""The viewer as a child process that never outlives this one."""

import math
import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import IO

from tsas_cli.support.errors import InputError

LONGEST_S = 10.0
SIZE = "64x64"
ADAPTER = re.compile(r'backend: (\w+), device_type: (\w+), name: "([^"]*)"')
LOOPBACK = "127.0.0.1"
LAST = 65535
START_S = 30.0  # a program of 300 MB, read from a slow disk
END_S = 3.0
LOOK_S = 0.05
MOST_LOGGED = 1 << 20  # bytes that are searched
DRAWS = b"wgpu adapter"  # in the log of a viewer whose window is open
NAMES = {"darwin": "Rerun.app/Contents/MacOS/Rerun"}
# Linux ends a child whose parent dies, where the child asks for it before it becomes the viewer.
ASK = (
    "import ctypes, os, signal, sys\n"
    "ctypes.CDLL(None).prctl(1, signal.SIGKILL)\n"
    "os.execv(sys.argv[1], sys.argv[1:])"
)


@dataclass(frozen=True)
class Child:
    """The running viewer."""

    process: subprocess.Popen[bytes]
    log: IO[bytes]

    def wait(self, at_most_s: float = math.inf, logged: bytes = b"") -> None:
        """Return when the viewer has been closed, has logged this, or after some seconds.

        InputError: it has failed.
        """
        until = time.monotonic() + at_most_s
        while self.process.poll() is None and time.monotonic() < until:
            # Not by seek: the viewer writes where this file stands.
            if logged and logged in os.pread(self.log.fileno(), MOST_LOGGED, 0):
                break
            time.sleep(LOOK_S)  # short: not every system lets a signal interrupt a long wait
        self.refuse_failure()

    def refuse_failure(self) -> None:
        """Raise what the viewer said last, where it has failed."""
        code = self.process.poll()
        if not code:
            return
        self.log.seek(0)
        lines = self.log.read().decode(errors="replace").split("\n")
        last = next((line.strip() for line in reversed(lines) if line.strip()), f"exit code {code}")
        raise InputError(
            f"the viewer has failed ({last})",
            remedy="try `tsas view --web`; `tsas doctor` says what the viewer can do here",
        )


def program() -> Path:
    """Return the path of the viewer, which is inside the package `rerun_cli`.

    The script `rerun` beside Python only calls it: who ends the script leaves it running.

    InputError: the package or its program is not installed.
    """
    spec = find_spec("rerun_cli")
    folders = [] if spec is None else list(spec.submodule_search_locations or ())
    names = dict.fromkeys((NAMES.get(sys.platform, "rerun"), "rerun"))  # older wheels have no app
    found = [path for f in folders for name in names if (path := Path(f) / name).is_file()]
    if not found:
        raise InputError(
            "the viewer's program is not installed",
            where="package rerun-sdk",
            remedy="install it anew: `pip install --force-reinstall rerun-sdk`",
        )
    return found[0]


@contextmanager
def viewer_child(arguments: Sequence[str], *, port: int) -> Iterator[Child]:
    """Start the viewer, wait until its port answers, and end it when the block ends.

    InputError: it is not installed, fails at its start, or does not answer.
    """
    call = [str(program()), *arguments]
    if sys.platform == "linux":
        call = [sys.executable, "-I", "-S", "-c", ASK, *call]
    quiet = {"RUST_LOG": "warn,re_renderer=info", "NO_COLOR": "1"}  # with DRAWS
    with tempfile.TemporaryFile() as log:
        process = subprocess.Popen(  # noqa: S603 # the program of a package of ours
            call,
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=log,
            env=os.environ | quiet,
            start_new_session=True,  # Ctrl-C in the terminal comes here, and we end the viewer
        )
        child = Child(process, log)
        try:
            _await_response(child, port)
            yield child
        finally:  # with whatever it has started
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGTERM)
                try:
                    process.wait(END_S)
                except subprocess.TimeoutExpired:
                    os.killpg(process.pid, signal.SIGKILL)
                    process.wait()


def _await_response(child: Child, port: int) -> None:
    until = time.monotonic() + START_S
    while time.monotonic() < until:
        child.refuse_failure()
        with suppress(OSError), socket.create_connection((LOOPBACK, port), timeout=1.0):
            return
        time.sleep(LOOK_S)
    raise InputError(
        f"the viewer does not answer on port {port} after {START_S:g} s",
        remedy="`tsas doctor` says what the viewer can do here",
    )


def free_ports(count: int, first: int | None = None) -> tuple[int, ...]:
    """Return ports on 127.0.0.1 that nothing listens on: any, or `first` and those after it.

    InputError: one of those asked for is in use, or may not be had.
    """
    wanted = [0] * count if first is None else range(first, first + count)
    with ExitStack() as held:  # all at once, so that no two are the same
        return tuple(held.enter_context(_listening(port)).getsockname()[1] for port in wanted)


def _listening(port: int) -> socket.socket:
    reason = f"the last is {LAST}"
    if port <= LAST:
        try:
            return socket.create_server((LOOPBACK, port))
        except OSError as error:
            reason = str(error.strerror)
    raise InputError(
        f"port {port} cannot be had ({reason})",
        where="--port",
        remedy="choose another one, or leave --port out",
    )


def drawn_with() -> str:
    """Return what the viewer draws with, for a person: "Vulkan on …".

    InputError: it is not installed, or cannot draw.
    """
    with tempfile.TemporaryDirectory(prefix="tsas-draw-") as folder:
        picture = Path(folder) / "picture.png"
        (port,) = free_ports(1)
        call = [str(program()), "--bind", LOOPBACK, "--port", str(port), "--headless"]
        call += ["--window-size", SIZE, "--hide-welcome-screen", "--screenshot-to", str(picture)]
        settings = {"RUST_LOG": "info", "NO_COLOR": "1", "CI": "true"}  # CI: no usage statistics
        try:
            ended = subprocess.run(  # noqa: S603 # the program of a package of ours
                call,
                env=os.environ | settings,
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
            raise InputError(
                "the viewer finds nothing to draw with",
                remedy="install a driver for Vulkan (without a graphics card on Debian: `apt "
                "install mesa-vulkan-drivers libvulkan1`), or use `tsas view --web`",
            )
    log = (ended.stdout + ended.stderr).decode(errors="replace")
    found = ADAPTER.search(log)
    if found is None:
        return "yes"
    backend, kind, name = found.groups()
    return f"{backend} on {name}" + (", in software" if kind == "Cpu" else "")
