"""How long a storage may be silent, and what its failures mean."""

import errno
import os
import re

from tsas_cli.support.errors import InputError
from tsas_cli.support.plausible import Range

TIMEOUT = "TSAS_STORAGE_TIMEOUT_S"  # of a request; one of many bytes has longer
TIMEOUT_S, TIMEOUTS_S = 20.0, Range(0.1, 3600.0, "s")
_REASON = 120  # characters of what a library says
_BUSY = {errno.EBUSY, getattr(errno, "EREMOTEIO", errno.EIO)}  # 503 and 500, as s3fs has them
_BUSY_CODES = {408, 429, *range(500, 505)}
# By name, since the libraries are optional.
_UNREACHED = {
    "ConnectionError",
    "HTTPClientError",
    "ClientConnectionError",
    "ClientPayloadError",
    "FSTimeoutError",
    "TransportError",
    "FlexibleChecksumError",
    "ChecksumError",
    "RequestException",
}


def timeout_s() -> float:
    """Return the time limit of a request [s], of the environment where it says one.

    InputError: it says no time, or one that nobody waits.
    """
    given = os.environ.get(TIMEOUT) or str(TIMEOUT_S)
    try:
        return TIMEOUTS_S(float(given))
    except ValueError as error:
        raise InputError(f"is {given!r}", where=TIMEOUT, expected=str(TIMEOUTS_S)) from error


def may_pass(error: Exception) -> bool:
    """Return whether an error may be over at the next try."""
    kinds = {kind.__name__ for kind in type(error).__mro__}
    number, code = getattr(error, "errno", None), getattr(error, "code", None)
    unreached = isinstance(error, TimeoutError | ConnectionError) or kinds & _UNREACHED
    return bool(unreached) or number in _BUSY or ("HttpError" in kinds and code in _BUSY_CODES)


def storage_error(address: object, error: Exception) -> InputError:
    """Return an error of the storage's library as one line, without keys or signatures."""
    kinds = {kind.__name__ for kind in type(error).__mro__}
    code = getattr(error, "code", None)
    if kinds & {"NoCredentialsError", "PartialCredentialsError", "ProfileNotFound"}:
        what = "no credentials found"
        remedy = "set them as for the storage's own tools (docs/object-storage.md)"
    elif (
        isinstance(error, PermissionError)
        or ("HttpError" in kinds and code in {401, 403})
        or (isinstance(error, OSError) and str(error).startswith("Forbidden"))  # of gcsfs
    ):
        what = "the storage refuses access"
        remedy = "check that the credentials are valid and may read the bucket"
    elif isinstance(error, TimeoutError | ConnectionError) or kinds & _UNREACHED:
        what = f"the storage cannot be reached, or breaks off ({type(error).__name__})"
        remedy = (
            "check the network, and the endpoint if one is set; repeat the call, "
            f"with a longer {TIMEOUT} (in seconds) if the storage is slow"
        )
    else:
        said = str(error).splitlines() or [""]
        reason = " ".join(said[: 2 if said[0].endswith(":") else 1])  # others may hold a key
        reason = re.sub(r"//[^/\s@]+@|\?\S+", "…", reason)[:_REASON]
        what = f"the storage fails ({type(error).__name__}: {reason})"
        remedy = "check the address, and repeat the call"
    return InputError(what, where=address, remedy=remedy)
