"""Ctrl-C and its kin as the usual end of a command that only shows something."""

import math
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

NAMES = ("SIGINT", "SIGTERM", "SIGHUP")  # Ctrl-C, `kill`, a terminal that closes
SIGNALS = [getattr(signal, name) for name in NAMES if hasattr(signal, name)]
EXIT_CODE = 130  # of a command that was stopped, as typer has it
CLEANING_S = 3.0  # for which more signals are not heard


class Stopped(BaseException):
    """Somebody asked this command to end."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C or its kin.

    CPython remembers a plain `KeyboardInterrupt` that leaves text which a library executes, and
    ends `python -m tsas_cli` by SIGINT then, even where it was caught; not so a subclass of it.
    """


@contextmanager
def until_stopped() -> Iterator[None]:
    """Run the block until it ends, or until a person ends it; both are the same to the caller."""
    try:
        with _raising(Stopped):
            yield
    except Stopped:
        pass


@contextmanager
def cleaned_up_when_stopped() -> Iterator[None]:
    """Let every such signal do in the block what Ctrl-C does: what it has opened is closed."""
    with _raising(Interrupted):
        yield


@contextmanager
def _raising(kind: type[BaseException]) -> Iterator[None]:
    """Raise `kind` at a signal; more of them, soon after, do not disturb the cleaning up.

    A library may lose what is raised, in a destructor for one: a later signal raises it again.
    """
    heard_s = -math.inf

    def stop(number: int, frame: FrameType | None) -> None:
        nonlocal heard_s
        del number, frame
        now_s = time.monotonic()
        if now_s - heard_s > CLEANING_S:
            heard_s = now_s
            raise kind

    heard = [number for number in SIGNALS if signal.getsignal(number) != signal.SIG_IGN]
    before = {number: signal.signal(number, stop) for number in heard}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
