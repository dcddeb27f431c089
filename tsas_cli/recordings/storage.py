"""Location of a dataset: a local folder, or an address on object storage (s3://…, gs://…).

An address has the few methods of a path that reading a dataset needs. It uses fsspec, which is
imported on first use.
"""

import logging
import os
import re
import threading
import time
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit
from urllib.request import url2pathname

from tsas_cli.recordings.storage_failures import may_pass, storage_error, timeout_s
from tsas_cli.support.errors import InputError

PACKAGES = {"s3": "s3fs", "gs": "gcsfs"}  # by scheme; the extras have the schemes' names
BYTES_IN_TIME = 4 << 20  # for each of these it has that time once more
TRIES, PAUSE_S = 3, 1.0  # the pause doubles
PATIENCE_S = 5.0  # after which it is said what is waited for
LOG = logging.getLogger("tsas")
_SUM = "tsas-sha256"  # key of an object's metadata
_METADATA = {"s3": "Metadata", "gs": "metadata"}
_EXPECTED = "SCHEME://BUCKET/PATH"
SCHEME = re.compile(r"(\w[\w+.-]*)://")


class NotThereError(InputError):
    """There is no such object on the storage."""

    def __init__(self, address: "Address") -> None:
        super().__init__(
            "is not on the storage",
            where=address,
            remedy="check the address; what was there may have been removed meanwhile",
        )


@dataclass(frozen=True)
class Address:
    """A folder or an object on object storage.

    What asks the storage raises NotThereError where there is no such object, and another InputError
    where the storage fails, is silent or refuses access.
    """

    scheme: str  # s3 or gs
    path: str  # bucket and key, without a slash at the end

    def __str__(self) -> str:
        """Return the address as text; it never holds a key or a password."""
        return f"{self.scheme}://{self.path}"

    def __truediv__(self, name: str) -> "Address":
        """Return the address of an object in this folder."""
        return Address(self.scheme, f"{self.path}/{name}")

    def resolve(self) -> "Address":
        """Return itself: object storage has no links."""
        return self

    def is_file(self) -> bool:
        """Return whether the object exists."""
        try:
            self.size()
        except NotThereError:
            return False
        return True

    def size(self) -> int:
        """Return the size of the object [bytes]."""
        info = self._call("_info", self.path)
        if info["type"] != "file":
            raise NotThereError(self)
        return int(info["size"])

    def read_bytes(self, start: int | None = None, end: int | None = None) -> bytes:
        """Return the bytes of the object, or those from `start` up to `end`, in one request."""
        return bytes(self._call("_cat_file", self.path, start=start, end=end))

    def read_part(self, start: int, end: int) -> bytes:
        """Return the bytes from `start` up to `end`, all of which the object has to hold."""
        part = {"start": start, "end": end, "transfers": end - start}
        return bytes(self._call("_cat_file", self.path, exactly=True, **part))

    def write_bytes(self, content: bytes) -> None:
        """Write the object, whole or not at all."""
        self._call("_pipe_file", self.path, content, transfers=len(content))

    def copy_from(self, file: Path, sha256: str) -> None:
        """Write the object and its checksum from a local file, whole or not at all."""
        metadata: dict[str, Any] = {_METADATA[self.scheme]: {_SUM: sha256}}
        size = file.stat().st_size
        self._call("_put_file", str(file), self.path, transfers=size, **metadata)

    def holds(self, sha256: str) -> bool:
        """Return whether `copy_from` has written the object from a file with this checksum."""
        try:
            if self.scheme == "s3":
                said = self._call("_metadata", self.path)
            else:
                said = self._call("_info", self.path).get("metadata") or {}
        except NotThereError:
            return False
        return bool(said.get(_SUM) == sha256)

    def _call(
        self, name: str, *given: Any, transfers: int = 0, exactly: bool = False, **named: Any
    ) -> Any:
        """Return what the storage's library answers; its errors become `InputError`.

        `transfers` is the number of bytes on the way, `exactly` whether so many have to come back.
        What is silent or breaks off is asked `TRIES` times. The libraries' own retries are off:
        they say nothing, and gcsfs goes on for a minute.
        """
        from fsspec.asyn import sync

        files = files_of(self.scheme)
        longest_s = timeout_s() * (1.0 + transfers / BYTES_IN_TIME)
        for tried in range(1, TRIES + 1):
            late = threading.Timer(PATIENCE_S, LOG.info, ["waits for %s", self])
            late.daemon = True
            late.start()
            try:
                found = sync(files.loop, getattr(files, name), *given, timeout=longest_s, **named)
                _refuse_short(found, transfers if exactly else None)
            except FileNotFoundError as error:
                if "specified bucket does not exist" not in str(error):
                    raise NotThereError(self) from error
                raise InputError("there is no such bucket", where=self) from error
            except Exception as error:  # fsspec passes on the errors of each storage's library
                failure = storage_error(self, error)
                if not may_pass(error) or tried == TRIES:
                    raise failure from error
                pause_s = PAUSE_S * 2.0 ** (tried - 1)
                again = f"try {tried + 1} of {TRIES} in {pause_s:g} s"
                LOG.warning("%s: %s; %s", self, failure.what, again)
                time.sleep(pause_s)
            else:
                return found
            finally:
                late.cancel()
        raise AssertionError  # the last try returns or raises


Location = Path | Address


def is_address(given: str) -> bool:
    """Return whether text is an address with a scheme, such as s3://bucket/path."""
    return SCHEME.match(given) is not None


def location_of(given: "str | Location") -> Location:
    """Return a local path, or an address on object storage; file:///… is a local path too.

    InputError: the scheme is unknown, no bucket is named, or the address holds a key or a
    signature.
    """
    if not isinstance(given, str):
        return given
    if not is_address(given):
        return Path(given)
    try:
        parts = urlsplit(given, allow_fragments=False)
    except ValueError as error:
        shown = f"{given.partition('://')[0]}://…"  # the rest may hold a key
        raise InputError("is no address", where=shown, expected=_EXPECTED) from error
    shown = f"{parts.scheme}://{parts.netloc.rpartition('@')[2]}{parts.path}"
    if "@" in parts.netloc or parts.query:
        raise InputError(
            "an address with a key, a password or a signature in it",
            where=shown,
            expected=_EXPECTED,
            remedy="keys belong into the environment or the storage's own settings",
        )
    if parts.scheme == "file":
        return Path(url2pathname(parts.path))
    if parts.scheme not in PACKAGES:
        raise InputError(
            f"{parts.scheme}:// is no known storage",
            where=shown,
            expected="a folder, or an address that begins with file://, s3:// or gs://",
        )
    inner = parts.path.strip("/")
    if not parts.netloc or ".." in inner.split("/"):
        raise InputError("names no object in a bucket", where=shown, expected=_EXPECTED)
    return Address(parts.scheme, f"{parts.netloc}/{inner}".rstrip("/"))


def check_inside(path: Location, folder: Location) -> None:
    """Refuse a file that a link places outside its dataset's folder; an address has no links."""
    if isinstance(path, Address) or isinstance(folder, Address):
        return
    if not is_inside(path, folder):
        raise InputError("a link leads out of the dataset's folder", where=path)


def is_inside(path: Path, folder: Path) -> bool:
    """Return whether no link leads from a path out of its folder; a circle leads nowhere."""
    return Path(os.path.realpath(path)).is_relative_to(os.path.realpath(folder))


def recorded_location(home: Path, text: str) -> Location:
    """Return the location that a stage recorded in `home`: an address, or a path relative to it."""
    return location_of(text) if is_address(text) else path_from(home, text)


def path_from(home: Path, relative: str) -> Path:
    """Return the path that is relative to a folder, which may have been reached by a link."""
    linked = os.path.abspath(home) != str(real := home.resolve())  # noqa: PTH100
    return Path(os.path.normpath((real if linked else home) / relative))


def location_text(home: Path, place: Location) -> str:
    """Return a location as a stage records it in `home`: an address, or a path relative to it."""
    if isinstance(place, Address):
        return str(place)
    here = home.parent.resolve() / home.name  # `home` will replace a link of that name
    return Path(os.path.relpath(place.resolve(), here)).as_posix()


@cache
def files_of(scheme: str) -> Any:
    """Return the fsspec file system of a storage, with the credentials that its library finds."""
    try:
        import fsspec

        made = fsspec.get_filesystem_class(scheme)
    except ImportError as error:
        raise InputError(
            f"addresses with {scheme}:// need the package {PACKAGES[scheme]}",
            remedy=f"install tsas[{scheme}]",
        ) from error
    wait_s = timeout_s()
    s3 = {"connect_timeout": wait_s, "read_timeout": wait_s, "retries": {"max_attempts": 1}}
    waits = {"timeout": wait_s} if scheme == "gs" else {"config_kwargs": s3}
    files = made(use_listings_cache=False, skip_instance_cache=True, **waits)
    files.retries = 1
    logging.getLogger(PACKAGES[scheme]).setLevel(logging.CRITICAL)  # it raises what it logs
    # A task that its call has given up fails in silence: the call has raised its own error.
    files.loop.call_soon_threadsafe(files.loop.set_exception_handler, lambda *_: None)
    return files


os.register_at_fork(after_in_child=files_of.cache_clear)  # connections belong to one process


def _refuse_short(found: Any, size: int | None) -> None:
    if size is not None and len(found) != size:
        raise ConnectionError(f"{len(found)} of {size} bytes")
