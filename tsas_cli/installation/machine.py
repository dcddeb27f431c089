"""Capabilities of this machine: cache of compiled code, threads, viewer, PDF."""

import os
import platform
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from tsas_cli.numerics.compiled import cache_folder
from tsas_cli.numerics.side_by_side import threads
from tsas_cli.reporting.pdf import browser
from tsas_cli.reporting.viewer.child import drawn_with, program
from tsas_cli.reporting.viewer.open import SCREENS, has_screen
from tsas_cli.support.errors import InputError
from tsas_cli.support.limits import THREADS


@dataclass(frozen=True)
class Ability:
    """A capability of this machine, the evidence, and the remedy if it is missing."""

    name: str
    works: bool
    found: str
    remedy: str = ""


def abilities() -> Iterator[Ability]:
    """Yield the capabilities; none is required for a calibration or a diagnosis."""
    yield _compiled_code()
    yield _queried("threads", lambda: f"{threads()} of {os.cpu_count()} cores, {THREADS} sets it")
    yield _queried("viewer", lambda: str(program()))
    yield _queried("drawing", drawn_with)
    yield _screen()
    yield _queried("Chromium", browser)


def _queried(name: str, query: Callable[[], str]) -> Ability:
    try:
        return Ability(name, True, query())
    except InputError as error:
        found = f"{error.where}: {error.what}" if error.where else error.what
        return Ability(name, False, found, error.remedy or error.expected)


def _compiled_code() -> Ability:
    folder = cache_folder()
    if folder is None:
        return Ability(
            "compiled code",
            False,
            "cannot be cached: every call compiles for seconds",
            "set TSAS_CACHE_DIR to a writable folder",
        )
    size = sum(path.stat().st_size for path in Path(folder).rglob("*") if path.is_file())
    cached = f"{size / 1e6:.1f} MB" if size else "empty: the first calls compile for seconds"
    return Ability("compiled code", True, f"{folder}, {cached}")


def _screen() -> Ability:
    if has_screen():
        names = [f"{name}={os.environ[name]}" for name in SCREENS if os.environ.get(name)]
        return Ability("screen", True, ", ".join(names) or platform.system())
    return Ability(
        "screen", False, "none", "`tsas view` serves a page for the browser and prints its address"
    )
