"""Location of a dataset: a local folder, or an address on object storage (s3://…, gs://…).

An address has the few methods of a path that reading a dataset needs. It uses fsspec, which is
imported on first use.
"""

import logging
import os
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, TypeVar
from urllib.parse import urlsplit
from urllib.request import url2pathname

from tsas_cli.support.errors import InputError

PACKAGES = {"s3": "s3fs", "gs": "gcsfs"}  # by scheme; the extras have the schemes' names
CONNECT_S, READ_S, TRIES, RESPONSE_S = 5.0, 10.0, 2, 25.0
_S3_WAITS = {"connect_timeout": CONNECT_S, "read_timeout": READ_S, "retries": {"max_attempts": 1}}
_EXPECTED = "SCHEME://BUCKET/PATH"
SCHEME = re.compile(r"(\w[\w+.-]*)://")
Returned = TypeVar("Returned")


@dataclass(frozen=True)
class Address:
    """A folder or an object on object storage.

    What asks the storage raises FileNotFoundError where there is no such object, and InputError
    where the storage fails or refuses access.
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
        except FileNotFoundError:
            return False
        return True

    def size(self) -> int:
        """Return the size of the object [bytes]."""
        info = self._call(lambda files: _in_time(files, files._info, self.path))  # noqa: SLF001
        if info["type"] != "file":
            raise FileNotFoundError(str(self))
        return int(info["size"])

    def read_bytes(self, start: int | None = None, end: int | None = None) -> bytes:
        """Return the bytes of the object, or those from `start` up to `end`, in one request."""
        return bytes(self._call(lambda files: files.cat_file(self.path, start=start, end=end)))

    def write_bytes(self, content: bytes) -> None:
        """Write the object, whole or not at all."""
        self._call(lambda files: files.pipe_file(self.path, content))

    def copy_from(self, file: Path) -> None:
        """Write the object from a local file, whole or not at all."""
        self._call(lambda files: files.put_file(str(file), self.path))

    def _call(self, call: Callable[[Any], Returned]) -> Returned:
        """Return the result of a storage call; its errors become `InputError`."""
        try:
            return call(files_of(self.scheme))
        except FileNotFoundError as error:
            if "specified bucket does not exist" not in str(error):
                raise
            raise InputError("there is no such bucket", where=self) from error
        except InputError:
            raise
        except Exception as error:  # fsspec passes on the errors of each storage's library
            raise _storage_error(self, error) from error


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
    if not path.resolve().is_relative_to(folder.resolve()):
        raise InputError("a link leads out of the dataset's folder", where=path)


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
    waits = {"timeout": READ_S} if scheme == "gs" else {"config_kwargs": _S3_WAITS}
    files = made(use_listings_cache=False, skip_instance_cache=True, **waits)
    files.retries = TRIES
    logging.getLogger(PACKAGES[scheme]).setLevel(logging.CRITICAL)  # it raises what it logs
    # A task that its call has given up fails in silence: the call has raised its own error.
    files.loop.call_soon_threadsafe(files.loop.set_exception_handler, lambda *_: None)
    return files


if hasattr(os, "register_at_fork"):  # connections belong to one process
    os.register_at_fork(after_in_child=files_of.cache_clear)


def _in_time(files: Any, ask: Callable[..., Any], path: str) -> Any:
    """Return a storage's description of an object, within `RESPONSE_S`.

    This is the first request of each call. The libraries' own limits are per try, and gcsfs retries
    for a minute.
    """
    from fsspec.asyn import sync

    return sync(files.loop, ask, path, timeout=RESPONSE_S)


def _storage_error(address: Address, error: Exception) -> InputError:
    """Return an error of the storage's library as one line, without keys or signatures."""
    kinds = {kind.__name__ for kind in type(error).__mro__}
    if kinds & {"NoCredentialsError", "PartialCredentialsError", "ProfileNotFound"}:
        return InputError(
            "no credentials found",
            where=address,
            remedy="set them as for the storage's own tools (docs/object-storage.md)",
        )
    code = getattr(error, "code", None)
    if (
        isinstance(error, PermissionError)
        or ("HttpError" in kinds and code in {401, 403})
        or (isinstance(error, OSError) and str(error).startswith("Forbidden"))  # of gcsfs
    ):
        return InputError(
            "the storage refuses access",
            where=address,
            remedy="check that the credentials are valid and may read the bucket",
        )
    if isinstance(error, TimeoutError | ConnectionError) or kinds & _UNREACHED:
        return InputError(
            f"the storage cannot be reached ({type(error).__name__})",
            where=address,
            remedy="check the network, and the endpoint if one is set",
        )
    reason = (str(error).splitlines() or [""])[0]
    reason = re.sub(r"//[^/\s@]+@|\?\S+", "…", reason)
    return InputError(f"the storage fails ({type(error).__name__}: {reason})", where=address)


# By name, since the libraries are optional.
_UNREACHED = {
    "ConnectionError",
    "HTTPClientError",
    "ClientConnectionError",
    "ClientPayloadError",
    "FSTimeoutError",
    "TransportError",
}
