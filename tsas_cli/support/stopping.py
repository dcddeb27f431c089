"""Ctrl-C and other stop signals: the normal end of a command that only displays something."""

import atexit
import math
import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from importlib.machinery import ExtensionFileLoader
from types import FrameType
from typing import Any

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)  # Ctrl-C, `kill`, a terminal that closes
EXIT_CODE = 130  # of a command that was stopped, as typer has it
CLEANUP_S = 3.0  # in which further signals are ignored
AGAIN_S = 0.01  # after which a stop is raised that could not be, or was swallowed
_LOADING = {
    method.__code__
    for method in (ExtensionFileLoader.create_module, ExtensionFileLoader.exec_module)
}


class Stopped(BaseException):
    """A stop signal was received."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C or its kin.

    CPython remembers a plain `KeyboardInterrupt` that leaves text which a library executes, and
    ends `python -m tsas_cli` by SIGINT then, even where it was caught; not so a subclass of it.
    """


@contextmanager
def until_stopped() -> Iterator[None]:
    """Run the block until it ends or a stop signal arrives; the caller sees no difference."""
    with suppress(Stopped):
        before = _handle(Stopped)
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)


def stopped_once() -> None:
    """Handle every stop signal like Ctrl-C until the process ends; the exit code is the first's.

    Signals that arrive when Python takes its modules apart, after all that is done at exit, would
    end the process by themselves: they are ignored.
    """

    def ignore() -> None:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        for number in SIGNALS:
            signal.signal(number, signal.SIG_IGN)

    atexit.register(ignore)
    sys.unraisablehook = _raise_again
    _handle(Interrupted)


def _raise_again(lost: "sys.UnraisableHookArgs") -> None:
    """Raise a stop again, shortly after, that was raised in a destructor, which ends there."""
    if issubclass(lost.exc_type, (Interrupted, Stopped)):
        _raise_later(lost.exc_type)
    else:
        sys.__unraisablehook__(lost)


def _raise_later(kind: type[BaseException]) -> None:
    signal.signal(signal.SIGALRM, lambda _, frame: _raise(kind, frame))
    signal.setitimer(signal.ITIMER_REAL, AGAIN_S)


def _raise(kind: type[BaseException], frame: FrameType | None) -> None:
    """Raise a stop, or later while a compiled library is loaded: it may swallow it, or abort."""
    while frame is not None:
        if frame.f_code in _LOADING:
            _raise_later(kind)
            return
        frame = frame.f_back
    raise kind


@contextmanager
def asked_first(ask: Callable[[], None]) -> Iterator[None]:
    """Call `ask` at the first Ctrl-C in the block; the second one is as before."""

    def first(number: int, frame: FrameType | None) -> None:
        del number, frame
        signal.signal(signal.SIGINT, before)
        ask()

    before = signal.signal(signal.SIGINT, first)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


class _Received:
    """When this process has received its last stop signal, whatever block it was in."""

    last_s = -math.inf


def _handle(kind: type[BaseException]) -> dict[signal.Signals, Any]:
    """Raise `kind` at signals from now on; return the handlers of before.

    Further signals within `CLEANUP_S` do not disturb the clean-up. A library may swallow the
    exception: a later signal raises it again.
    """
    _Received.last_s = -math.inf

    def stop(number: int, frame: FrameType | None) -> None:
        del number
        now_s = time.monotonic()
        if now_s - _Received.last_s > CLEANUP_S:
            _Received.last_s = now_s
            _raise(kind, frame)

    handled = [number for number in SIGNALS if signal.getsignal(number) != signal.SIG_IGN]
    return {number: signal.signal(number, stop) for number in handled}
