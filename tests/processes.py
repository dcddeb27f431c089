"""Which processes are alive, and where they listen; reads /proc."""

import time
from pathlib import Path

SOON_S = 40.0  # on a machine that is busy


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
