"""A target that breaks the rules, so that a test can see the search find it."""

import ctypes
import sys
from collections.abc import Iterable
from itertools import count
from pathlib import Path

from tests.fuzz import foreign

WORDS = (b"R", b"W")
_before = count()


def one(data: bytes) -> None:
    """Raise, die or write outside, by the first bytes; some of it only in the search's process."""
    before = next(_before)
    if before > 10 and data.startswith(b"ODD!"):
        raise KeyError("disorder")
    if before > 200 and foreign.here_too and data.startswith(b"DIES"):
        ctypes.string_at(0)
    if data.startswith(b"R"):
        raise KeyError("a defect")
    if data.startswith(b"DEAD"):
        ctypes.string_at(0)
    if data.startswith(b"W"):
        Path(sys.executable).with_name("tsas-fuzz-test").mkdir(exist_ok=True)
        Path(sys.executable).with_name("tsas-fuzz-test").rmdir()


def seeds() -> Iterable[bytes]:
    """Nothing that breaks a rule."""
    yield b"seed"
