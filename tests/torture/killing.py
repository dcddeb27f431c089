"""The command line in a process of its own that ends at a chosen moment.

Children are forked from a process that has loaded everything, so that a call costs what the stage
costs. A moment is a time after the start, or the k-th file operation: an audit hook of the child
sees each one just before it is done.
"""

import os
import signal
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

AT_MOST_S = 240.0
WRITING = {
    "os.rename", "os.remove", "os.mkdir", "os.rmdir", "os.link", "os.chmod", "os.fsync", "os.write",
    "fcntl.flock", "ctypes.dlsym", "tempfile.mkstemp", "tempfile.mkdtemp", "shutil.rmtree",
}  # fmt: skip
LOOKING = {"open", "os.listdir", "os.scandir"}  # of these, what is done below out/


@dataclass(frozen=True)
class Moment:
    """When a call ends, and by which signal: before an operation, or after a time [s]."""

    operation: int | None = None
    after_s: float | None = None
    number: int = signal.SIGKILL

    def __str__(self) -> str:
        """Return it as it is told in a finding."""
        when = (
            f"at operation {self.operation}" if self.after_s is None else f"at {self.after_s:.4f} s"
        )
        return f"{signal.Signals(self.number).name} {when}"


@dataclass(frozen=True)
class Ended:
    """How a call ended: its exit code, negative for a signal; what it took, and said."""

    code: int
    took_s: float
    operations: int
    said: str


def call(home: Path, words: tuple[str, ...], moment: Moment | None = None) -> Ended:
    """Run tsas in a folder, until it ends or is ended."""
    log, counter = home / "log", home / "operations"
    counter.unlink(missing_ok=True)
    began = time.monotonic()
    pid = os.fork()
    if pid == 0:
        _child(home, words, moment, log, counter)
    status = _waited(pid, began, moment)
    took_s = time.monotonic() - began
    operations = int(counter.read_text()) if counter.exists() else 0
    said = log.read_text(encoding="utf-8", errors="replace")
    return Ended(os.waitstatus_to_exitcode(status), took_s, operations, said)


def _waited(pid: int, began: float, moment: Moment | None) -> int:
    told = moment is None or moment.after_s is None
    while True:
        ended, status = os.waitpid(pid, os.WNOHANG)
        if ended:
            return status
        now = time.monotonic() - began
        if not told and moment and moment.after_s is not None and now >= moment.after_s:
            os.kill(pid, moment.number)
            told = True
        if now > AT_MOST_S:
            os.kill(pid, signal.SIGKILL)
            raise TimeoutError(f"{pid} goes on for {now:.0f} s")
        time.sleep(0.0005 if not told else 0.002)


def _child(
    home: Path, words: tuple[str, ...], moment: Moment | None, log: Path, counter: Path
) -> None:
    code = 70
    try:
        os.chdir(home)
        descriptor = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(descriptor, 1)
        os.dup2(descriptor, 2)
        sys.argv = ["tsas", *words]
        count = _watched(moment)
        from tsas_cli.__main__ import main

        try:
            main()
        except SystemExit as stopped:
            code = int(stopped.code or 0)
        sys.stdout.flush()
        sys.stderr.flush()
        if moment is None:
            counter.write_text(str(count[0]))
    finally:
        os._exit(code)


def _watched(moment: Moment | None) -> list[int]:
    """Count file operations, and end this process before the one that is meant."""
    count = [0]
    at = moment.operation if moment else None

    def seen() -> None:
        count[0] += 1
        if count[0] == at and moment:
            os.kill(os.getpid(), moment.number)

    def hook(event: str, arguments: tuple[Any, ...]) -> None:
        if event in WRITING or (event in LOOKING and _is_output(arguments[0])):
            seen()

    for name in ("fsync", "write"):  # which tell no hook
        setattr(os, name, _told(getattr(os, name), seen))
    sys.addaudithook(hook)
    return count


def _told(function: Any, seen: Any) -> Any:
    def told(*arguments: Any) -> Any:
        seen()
        return function(*arguments)

    return told


def _is_output(path: object) -> bool:
    return isinstance(path, str | bytes | os.PathLike) and "out" in Path(os.fsdecode(path)).parts
