"""A limit to how long Python may be busy with one thing."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


@contextmanager
def at_most(seconds: float) -> Iterator[None]:
    """Run the block, which may take so long; on Windows and beside the main thread it may for ever.

    Raises
    ------
    TimeoutError
        It took longer.
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
