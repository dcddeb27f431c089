"""The compile decorator of every kernel, and the cache that its machine code lives in."""

import hashlib
import os
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

Function = TypeVar("Function", bound=Callable[..., Any])

PLAIN = os.environ.get("TSAS_PLAIN_PYTHON") == "1"


def kernel(function: Function) -> Function:
    """Compile a numeric function with numba, once per version of the package's sources.

    With `TSAS_PLAIN_PYTHON=1` in the environment the function stays as it is, for debugging and
    for the tests that hold the compiled code against the plain one.
    """
    if PLAIN:
        return function
    import numba

    numba.config.CACHE_DIR = _cache_folder()  # type: ignore[attr-defined] # set by name at run time
    return cast(Function, numba.njit(cache=True, error_model="numpy")(function))


@cache
def _cache_folder() -> str:
    """Return a folder named after the sources: numba does not see edits in imported kernels."""
    import platformdirs

    digest = hashlib.sha256()
    package = Path(__file__).parent.parent
    for part in ("effects", "numerics", "physics"):
        for source in sorted((package / part).rglob("*.py")):
            digest.update(source.read_bytes())
    root = Path(os.environ.get("TSAS_CACHE_DIR") or platformdirs.user_cache_dir("tsas"))
    folder = root / "kernels" / digest.hexdigest()[:16]
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:  # a read-only home: compile for this process only
        return tempfile.mkdtemp(prefix="tsas-kernels-")
    return str(folder)
