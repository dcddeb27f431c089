"""The compile decorator of every kernel, and the cache that its machine code lives in."""

import hashlib
import os
from collections.abc import Callable, Collection
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

Function = TypeVar("Function", bound=Callable[..., Any])

PARTS = ("controllers", "drive", "effects", "numerics", "physics")  # where kernels live
PLAIN = "1" in (os.environ.get("TSAS_PLAIN_PYTHON"), os.environ.get("NUMBA_DISABLE_JIT"))


def kernel(function: Function) -> Function:
    """Compile a numeric function with numba, once per version of the package's sources.

    It is inlined into every compiled caller: a call counts references, which costs up to a fifth.
    With `TSAS_PLAIN_PYTHON=1` in the environment the function stays as it is, for debugging and
    for the tests that compare compiled with plain code.
    """
    return _compiled(function, inlined=True)


def seldom_kernel(function: Function) -> Function:
    """Compile a numeric function that most runs do not need: its callers do not grow by it."""
    return _compiled(function, inlined=False)


def summing_kernel(function: Function) -> Function:
    """Compile a numeric function whose sums may be taken in any order, several at a time."""
    return _compiled(function, inlined=True, fastmath={"reassoc", "contract", "nsz"})


def _compiled(function: Function, *, inlined: bool, fastmath: Collection[str] = ()) -> Function:
    if PLAIN:
        return function
    import numba

    folder = cache_folder()
    numba.config.CACHE_DIR = folder or ""  # type: ignore[attr-defined] # numba sets it by name
    compiler = numba.njit(
        cache=folder is not None,
        error_model="numpy",
        nogil=True,
        forceinline=inlined,
        fastmath=set(fastmath),
    )
    compiled = compiler(function)
    if folder is not None:
        from tsas_cli.numerics.machine_code import checked

        checked(cast("Any", compiled)._cache)  # noqa: SLF001 # no other way
    return cast("Function", compiled)


@cache
def cache_folder() -> str | None:
    """Return a folder named after a hash of the sources, or None where none can be written.

    Numba by itself does not notice edits of the kernels that a kernel calls.
    """
    import platformdirs

    digest = hashlib.sha256()
    package = Path(__file__).parent.parent
    for part in PARTS:
        for source in sorted((package / part).rglob("*.py")):
            digest.update(source.read_bytes())
    root = Path(os.environ.get("TSAS_CACHE_DIR") or platformdirs.user_cache_dir("tsas"))
    folder = root / "kernels" / digest.hexdigest()[:16]
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return None
    return str(folder) if os.access(folder, os.W_OK) else None
