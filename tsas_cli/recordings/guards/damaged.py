"""The error for a damaged file, or an encrypted one."""

from collections.abc import Iterator
from contextlib import contextmanager

from tsas_cli.support.errors import InputError
from tsas_cli.support.limits import out_of_memory


class EncryptedError(InputError):
    """The file, or a column of it, is encrypted."""


def damaged(path: object, kind: str, error: Exception) -> InputError:
    """Return the error for a file that the library for its format refuses."""
    if "crypt" in str(error):  # of pyarrow, at an encrypted file or column
        return EncryptedError(
            "holds encrypted columns",
            where=path,
            expected="columns that can be read",
            remedy="decrypt them, and write the file again without encryption",
        )
    reason = str(error).splitlines()[0] if str(error) else type(error).__name__
    return InputError(
        f"cannot be read as {kind} ({reason})",
        where=path,
        remedy="the file may be incomplete: copy or export it again",
    )


@contextmanager
def foreign(path: object, kind: str) -> Iterator[None]:
    """Convert the errors of the library for a format to `InputError`."""
    try:
        yield
    except InputError:
        raise
    except MemoryError as error:
        raise out_of_memory(path) from error
    except Exception as error:  # a damaged file raises any of a dozen types
        raise damaged(path, kind, error) from error
