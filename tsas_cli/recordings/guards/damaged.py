"""The error for a damaged file."""

from tsas_cli.support.errors import InputError


def damaged(path: object, kind: str, error: Exception) -> InputError:
    """Return the error for a file that the library for its format refuses."""
    reason = str(error).splitlines()[0] if str(error) else type(error).__name__
    return InputError(
        f"cannot be read as {kind} ({reason})",
        where=path,
        remedy="the file may be incomplete: copy or export it again",
    )
