"""Ctrl-C and its kin as the usual end of a command that only shows something."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

NAMES = ("SIGINT", "SIGTERM", "SIGHUP")  # Ctrl-C, `kill`, a terminal that closes
SIGNALS = [getattr(signal, name) for name in NAMES if hasattr(signal, name)]


class Stopped(BaseException):
    """Somebody asked this command to end."""


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
    with _raising(KeyboardInterrupt):
        yield


@contextmanager
def _raising(kind: type[BaseException]) -> Iterator[None]:
    """Raise `kind` at the first signal; more of them do not disturb the cleaning up."""

    def stop(number: int, frame: FrameType | None) -> None:
        del number, frame
        for each in SIGNALS:
            signal.signal(each, signal.SIG_IGN)
        raise kind

    heard = [number for number in SIGNALS if signal.getsignal(number) != signal.SIG_IGN]
    before = {number: signal.signal(number, stop) for number in heard}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
