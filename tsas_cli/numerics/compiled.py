"""The compile decorator of every kernel, and the cache that its machine code lives in."""

import hashlib
import logging
import os
import pickle
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

from numba.core import caching

# mypy: disable-error-code="no-untyped-call"


COMPILES = (
    "this call compiles numerical kernels, once after an installation or a change: up to half a "
    "minute longer"
)
DIGEST_BYTES = hashlib.sha256().digest_size


class MachineCode(caching.IndexDataCacheFile):
    """An index and its data files, each of which begins with the digest of the rest."""

    def save(self, key: Any, data: Any) -> None:
        """Store machine code; where there is no room it is compiled again next time."""
        with suppress(OSError):
            super().save(key, data)

    def load(self, key: Any) -> Any:
        """Return stored machine code, or None where it has to be compiled, which is logged."""
        data = super().load(key)
        if data is None:
            _say_once()
        return data

    def _load_index(self) -> dict[Any, str]:
        try:
            overloads: dict[Any, str] = super()._load_index()
        except (EOFError, pickle.UnpicklingError, ValueError, IndexError, KeyError, TypeError):
            _say(self._index_path)
            return {}
        return overloads

    def _save_data(self, name: str, data: Any) -> None:
        content = self._dump(data)
        with self._open_for_write(self._data_path(name)) as file:
            file.write(hashlib.sha256(content).digest() + content)

    def _load_data(self, name: str) -> Any:
        path = self._data_path(name)
        stored = Path(path).read_bytes()
        digest, content = stored[:DIGEST_BYTES], stored[DIGEST_BYTES:]
        if hashlib.sha256(content).digest() != digest:
            _say(path)
            return None
        return pickle.loads(content)  # noqa: S301 # our own file, its digest is right


@cache
def _say_once() -> None:
    logging.getLogger("tsas").info(COMPILES)


def _say(path: str) -> None:
    print(f"tsas: {path} is damaged; the kernel is compiled again", file=sys.stderr)


def checked(cache: Any) -> None:
    """Let a kernel's cache read and write its files as `MachineCode` does."""
    impl = cache._impl  # noqa: SLF001 # no other way
    cache._cache_file = MachineCode(  # noqa: SLF001
        cache.cache_path, impl.filename_base, impl.locator.get_source_stamp()
    )


Function = TypeVar("Function", bound=Callable[..., Any])

PARTS = ("controllers", "drive", "effects", "numerics", "physics")  # where kernels live
PLAIN = os.environ.get("TSAS_PLAIN_PYTHON") == "1"


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


def _compiled(function: Function, *, inlined: bool) -> Function:
    if PLAIN:
        return function
    import numba

    folder = cache_folder()
    numba.config.CACHE_DIR = folder or ""  # type: ignore[attr-defined] # numba sets it by name
    compiler = numba.njit(
        cache=folder is not None, error_model="numpy", nogil=True, forceinline=inlined
    )
    compiled = compiler(function)
    if folder is not None:
        from tsas_cli.numerics.compiled import checked

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
