"""Commands that keep a viewer open, in processes of their own, and what these leave behind."""

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tsas_cli.reporting.viewer.open import SCREENS

ADDRESS = re.compile(r"http://127\.0\.0\.1:(\d+)/\?url=\S+")
SOON_S = 40.0  # on a machine that is busy


@contextmanager
def started(*words: object, state: Path, **environment: str) -> Iterator[subprocess.Popen[str]]:
    """Start `tsas WORDS` without a screen and without usage statistics; end it with the block."""
    env = {k: v for k, v in os.environ.items() if k not in SCREENS}
    env |= {"CI": "true", "TSAS_STATE_DIR": str(state), "PYTHONUNBUFFERED": "1", **environment}
    call = [sys.executable, "-m", "tsas_cli", *map(str, words)]
    with subprocess.Popen(
        call, env=env, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        try:
            yield process
        finally:
            process.kill()


def line_with_address(stream) -> re.Match:
    """Return the address in the first line of a stream that holds one."""
    for line in stream:
        if found := ADDRESS.search(line):
            return found
    raise AssertionError("no address before the end")


def ended(process: subprocess.Popen[str], number: int = signal.SIGINT) -> tuple[int, str, str]:
    """Ask a command to end; return its exit code and what it still said."""
    process.send_signal(number)
    out, err = process.communicate(timeout=SOON_S)
    return process.returncode, out, err


def family(pid: int) -> set[int]:
    """Return the process and all that it has started, which are alive."""
    parents = {}
    for status in Path("/proc").glob("[0-9]*/stat"):
        try:
            state, parent = status.read_text().rsplit(") ", 1)[1].split()[:2]
        except OSError:
            continue
        if state != "Z":
            parents[int(status.parent.name)] = int(parent)
    found = {pid} & parents.keys()
    while more := {p for p, parent in parents.items() if parent in found} - found:
        found |= more
    return found


def alive(pids: set[int]) -> set[int]:
    """Return which of these processes are alive, once they have had time to end."""
    until = time.monotonic() + SOON_S
    while (left := {p for p in pids if family(p)}) and time.monotonic() < until:
        time.sleep(0.05)
    return left


def listening(pids: set[int]) -> set[tuple[str, int]]:
    """Return addresses, as /proc/net writes them, and ports at which these processes listen."""
    sockets = set()
    for pid in pids:
        for descriptor in Path(f"/proc/{pid}/fd").iterdir():
            try:
                sockets.add(str(descriptor.readlink()))
            except OSError:
                continue
    found = set()
    for table in ("/proc/net/tcp", "/proc/net/tcp6"):
        for row in Path(table).read_text().splitlines()[1:]:
            fields = row.split()
            if fields[3] == "0A" and f"socket:[{fields[9]}]" in sockets:
                address, port = fields[1].split(":")
                found.add((address, int(port, 16)))
    return found
