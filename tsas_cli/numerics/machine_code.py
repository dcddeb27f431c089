"""The files of kernels' machine code: damaged ones count as absent, so that it is compiled again.

Numba itself unpickles what it finds: a file that was cut short ends the process.
"""

# mypy: disable-error-code="no-untyped-call"

import hashlib
import pickle
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any

from numba.core import caching

DIGEST_BYTES = hashlib.sha256().digest_size


class MachineCode(caching.IndexDataCacheFile):
    """An index and its data files, each of which begins with the digest of the rest."""

    def save(self, key: Any, data: Any) -> None:
        """Store machine code; where there is no room it is compiled again next time."""
        with suppress(OSError):
            super().save(key, data)

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


def _say(path: str) -> None:
    print(f"tsas: {path} is damaged; the kernel is compiled again", file=sys.stderr)


def checked(cache: Any) -> None:
    """Let a kernel's cache read and write its files as `MachineCode` does."""
    impl = cache._impl  # noqa: SLF001 # no other way
    cache._cache_file = MachineCode(  # noqa: SLF001
        cache.cache_path, impl.filename_base, impl.locator.get_source_stamp()
    )
