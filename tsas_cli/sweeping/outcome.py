"""Outcome of a task, as plain data, and the versions that determine its last bits."""

import hashlib
import json
import platform
from collections.abc import Mapping
from functools import cache
from importlib.metadata import version
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

from tsas_cli.support import __version__
from tsas_cli.support.errors import InputError

LIBRARIES = ("numpy", "scipy", "numba", "pyarrow")
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "TSAS_THREADS": "1"}  # a task is one process
Row = dict[str, Any]  # of a table whose columns the plan and its stage choose
TaskOutcome = Row


def failure(error: str, *, defect: bool = True) -> TaskOutcome:
    """Return the outcome of a failed task; the cause is a defect of the program, or its input."""
    return {"state": "failed", "error": error, "defect": defect}


def worker_death(times: int, message: str = "") -> TaskOutcome:
    """Return the outcome of a task whose worker died in each of `times` attempts."""
    often = "the process died" if times == 1 else f"the process died, {times} times"
    return failure(f"{often}: {message}" if message else often)


def success(results: Row, parameters: list[Row]) -> TaskOutcome:
    """Return the outcome of a completed task: its key figures and estimated parameters."""
    return {"state": "done", "results": results, "parameters": parameters}


def run_task(work: str, text: str) -> str:
    """Return the outcome of a task, as JSON like the task; `work` is `module:function`."""
    return json.dumps(resolve_name(work)(json.loads(text)))


@cache
def versions() -> dict[str, str]:
    """Return the versions of tsas, its sources, Python and the numerical libraries."""
    digest = hashlib.sha256()
    package = Path(__file__).parent.parent
    for source in sorted(package.rglob("*.py")):
        digest.update(source.read_bytes())
    python = ".".join(platform.python_version_tuple()[:2])
    libraries = {name: version(name) for name in LIBRARIES}
    sources = digest.hexdigest()[:16]
    return {"tsas": __version__, "digest of tsas": sources, "Python": python, **libraries}


def refuse_others(expected: Mapping[str, str], found: Mapping[str, str], where: str) -> None:
    """Refuse a worker whose versions differ from the expected ones."""
    for name, wanted in expected.items():
        if found.get(name) != wanted:
            raise InputError(
                f"{name} is {found.get(name, 'unknown')}",
                where=where,
                expected=f"{wanted}, as where the sweep was started",
                remedy="install the same version there",
            )
