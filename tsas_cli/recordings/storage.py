"""Where a dataset is: a local folder, or an address on object storage (s3://…, gs://…).

An address has the few methods of a path that reading a dataset needs. fsspec does the work, and is
imported only where there is an address.
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
CONNECT_S, READ_S, TRIES, ANSWER_S = 5.0, 10.0, 2, 25.0
_S3_WAITS = {"connect_timeout": CONNECT_S, "read_timeout": READ_S, "retries": {"max_attempts": 1}}
_EXPECTED = "SCHEME://BUCKET/PATH"
SCHEME = re.compile(r"(\w[\w+.-]*)://")
Returned = TypeVar("Returned")


@dataclass(frozen=True)
class Address:
    """A folder or an object on object storage.

    Parameters
    ----------
    scheme
        `s3` or `gs`.
    path
        Bucket and key, without a slash at the end.
    """

    scheme: str
    path: str

    def __str__(self) -> str:
        """Return it as it was given; it never holds a key or a password."""
        return f"{self.scheme}://{self.path}"

    def __truediv__(self, name: str) -> "Address":
        """Return what is in this folder."""
        return Address(self.scheme, f"{self.path}/{name}")

    def resolve(self) -> "Address":
        """Return itself: there are no links here."""
        return self

    def is_file(self) -> bool:
        """Say whether there is such an object.

        Raises
        ------
        InputError
            The storage cannot be asked.
        """
        try:
            self.size()
        except FileNotFoundError:
            return False
        return True

    def size(self) -> int:
        """Return how many bytes it has.

        Raises
        ------
        FileNotFoundError
            It is not there.
        InputError
            The storage cannot be asked.
        """
        told = self._asked(lambda files: _in_time(files, files._info, self.path))  # noqa: SLF001
        if told["type"] != "file":
            raise FileNotFoundError(str(self))
        return int(told["size"])

    def read_bytes(self, start: int | None = None, end: int | None = None) -> bytes:
        """Return its bytes, or those from `start` up to `end`, with one request.

        Raises
        ------
        FileNotFoundError
            It is not there.
        InputError
            The storage cannot be asked.
        """
        return bytes(self._asked(lambda files: files.cat_file(self.path, start=start, end=end)))

    def write_bytes(self, content: bytes) -> None:
        """Put an object there, whole or not at all.

        Raises
        ------
        InputError
            The storage cannot be asked, or refuses.
        """
        self._asked(lambda files: files.pipe_file(self.path, content))

    def copy_from(self, file: Path) -> None:
        """Put a local file there, whole or not at all.

        Raises
        ------
        InputError
            The storage cannot be asked, or refuses.
        """
        self._asked(lambda files: files.put_file(str(file), self.path))

    def _asked(self, call: Callable[[Any], Returned]) -> Returned:
        """Return what the storage answers; what goes wrong on the way is one line."""
        try:
            return call(files_of(self.scheme))
        except FileNotFoundError as error:
            if "specified bucket does not exist" not in str(error):
                raise
            raise InputError("there is no such bucket", where=self) from error
        except InputError:
            raise
        except Exception as error:  # fsspec hands on what each storage's library raises
            raise _said(self, error) from error


Place = Path | Address


def is_address(given: str) -> bool:
    """Say whether this names a place by scheme, as s3://bucket/path does."""
    return SCHEME.match(given) is not None


def place_of(given: "str | Place") -> Place:
    """Return a local path, or an address on object storage; file:///… is a local path too.

    Raises
    ------
    InputError
        The scheme is not known, no bucket is named, or the address holds more than a place.
    """
    if not isinstance(given, str):
        return given
    if not is_address(given):
        return Path(given)
    try:
        parts = urlsplit(given, allow_fragments=False)
    except ValueError as error:
        shown = f"{given.partition('://')[0]}://…"  # what follows may hold a key
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
            f"{parts.scheme}:// is no storage that is known",
            where=shown,
            expected="a folder, or an address that begins with file://, s3:// or gs://",
        )
    inner = parts.path.strip("/")
    if not parts.netloc or ".." in inner.split("/"):
        raise InputError("is no place in a bucket", where=shown, expected=_EXPECTED)
    return Address(parts.scheme, f"{parts.netloc}/{inner}".rstrip("/"))


def check_inside(path: Place, folder: Place) -> None:
    """Refuse a file that a link puts outside of its dataset's folder; an address has no links.

    Raises
    ------
    InputError
        It is outside.
    """
    if isinstance(path, Address) or isinstance(folder, Address):
        return
    if not path.resolve().is_relative_to(folder.resolve()):
        raise InputError("a link leads out of the dataset's folder", where=path)


def place_from(home: Path, told: str) -> Place:
    """Return the place that a stage has written down in `home`: an address, or from there."""
    return place_of(told) if is_address(told) else path_from(home, told)


def path_from(home: Path, told: str) -> Path:
    """Return the path that is told from a folder, which may have been reached by a link."""
    linked = os.path.abspath(home) != str(real := home.resolve())  # noqa: PTH100
    return Path(os.path.normpath((real if linked else home) / told))


def told_from(home: Path, place: Place) -> str:
    """Return how a stage writes a place down in `home`: an address, or the way from there."""
    if isinstance(place, Address):
        return str(place)
    here = home.parent.resolve() / home.name  # which replaces a link of that name
    return Path(os.path.relpath(place.resolve(), here)).as_posix()


@cache
def files_of(scheme: str) -> Any:
    """Return fsspec's view of a storage, with the credentials that its own library finds."""
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
    logging.getLogger(PACKAGES[scheme]).setLevel(logging.CRITICAL)  # what it logs, it raises too
    return files


if hasattr(os, "register_at_fork"):  # a storage's connections are those of one process
    os.register_at_fork(after_in_child=files_of.cache_clear)


def _in_time(files: Any, ask: Callable[..., Any], path: str) -> Any:
    """Return what a storage says of an object, if it does so in time.

    This comes before any other question. The libraries' own limits are per try, and gcsfs tries for
    a minute.
    """
    from fsspec.asyn import sync

    return sync(files.loop, ask, path, timeout=ANSWER_S)


def _said(address: Address, error: Exception) -> InputError:
    """Return what the storage's library raised as one line, without keys or signatures."""
    kinds = {kind.__name__ for kind in type(error).__mro__}
    if kinds & {"NoCredentialsError", "PartialCredentialsError", "ProfileNotFound"}:
        return InputError(
            "there are no credentials for it",
            where=address,
            remedy="set them as for the storage's own tools (docs/object-storage.md)",
        )
    if isinstance(error, PermissionError) or (
        "HttpError" in kinds and getattr(error, "code", None) in {401, 403}
    ):
        return InputError(
            "the storage refuses access",
            where=address,
            remedy="see that the credentials are right and may read the bucket",
        )
    if isinstance(error, TimeoutError | ConnectionError) or kinds & _UNREACHED:
        return InputError(
            f"the storage cannot be reached ({type(error).__name__})",
            where=address,
            remedy="see that the network is up, and the endpoint right where one is set",
        )
    reason = (str(error).splitlines() or [""])[0]
    reason = re.sub(r"//[^/\s@]+@|\?\S+", "…", reason)
    return InputError(f"the storage fails ({type(error).__name__}: {reason})", where=address)


# By name, since their libraries are there only where a storage is used.
_UNREACHED = {
    "ConnectionError",
    "HTTPClientError",
    "ClientConnectionError",
    "ClientPayloadError",
    "FSTimeoutError",
    "TransportError",
}
