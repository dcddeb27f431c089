"""Versions that determine the last bits of a result; all workers of a sweep must agree."""

import hashlib
import platform
from collections.abc import Mapping
from functools import cache
from importlib.metadata import version
from pathlib import Path

from tsas_cli.support import __version__
from tsas_cli.support.errors import InputError

LIBRARIES = ("numpy", "scipy", "numba", "pyarrow")
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "TSAS_THREADS": "1"}  # a task is one process


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
