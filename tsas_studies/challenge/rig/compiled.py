"""Compile the rig's kernels, and keep the machine code, apart from the product's."""

import hashlib
import os
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
import platformdirs

Function = TypeVar("Function", bound=Callable[..., Any])


def compiled(function: Function) -> Function:
    """Compile a function with numba, once per version of the rig's sources where a cache can be."""
    folder = _cache_folder()
    numba.config.CACHE_DIR = folder or ""  # type: ignore[attr-defined] # set by name
    return cast("Function", numba.njit(cache=folder is not None)(function))


@cache
def _cache_folder() -> str | None:
    """Return a folder named after the sources: numba does not see edits in other files."""
    digest = hashlib.sha256()
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.read_bytes())
    root = Path(os.environ.get("TSAS_CACHE_DIR") or platformdirs.user_cache_dir("tsas"))
    folder = root / "rig" / digest.hexdigest()[:16]
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return None
    return str(folder) if os.access(folder, os.W_OK) else None
