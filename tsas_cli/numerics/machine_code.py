"""Numba's cache of machine code, with a digest of each file.

Numba itself unpickles what it finds: a file that was cut short ends the process.
"""

# mypy: disable-error-code="no-untyped-call"

import hashlib
import logging
import pickle
import sys
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any

from numba.core import caching

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
