"""The error for a damaged file, or an encrypted one."""

from tsas_cli.support.errors import InputError


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
