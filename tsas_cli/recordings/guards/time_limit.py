"""A time limit for a block of Python code."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


@contextmanager
def at_most(seconds: float) -> Iterator[None]:
    """Run the block with a time limit; without one on Windows and outside the main thread.

    Raises
    ------
    TimeoutError
        The block took longer.
    """

    def late(number: int, frame: FrameType | None) -> None:
        del number, frame
        raise TimeoutError

    on_main = threading.current_thread() is threading.main_thread()
    if not on_main or not hasattr(signal, "setitimer"):
        yield
        return
    before = signal.signal(signal.SIGALRM, late)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
