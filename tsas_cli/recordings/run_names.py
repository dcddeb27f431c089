"""Valid run ids: they become file names on any system."""

import os
import unicodedata
from collections.abc import Iterable

_SLASHES = "/\\"
_ON_WINDOWS = '<>:"|?*'  # where a colon opens another stream of the same file
_DEVICES = {"con", "prn", "aux", "nul", *(f"{d}{n}" for d in ("com", "lpt") for n in range(10))}


def check_run_name(name: str, *, on_windows: bool = os.name == "nt") -> None:
    """Refuse an id that is no valid file name.

    ValueError: it is empty, not printable, too long, or a Windows device; it has a slash, or a
    blank at either end.
    """
    bad = _SLASHES + (_ON_WINDOWS if on_windows else "")
    unusable = name in {"", ".", ".."} or any(c in name for c in bad) or not name.isprintable()
    if unusable or len(f"{name}.parquet".encode()) > 255 or name != name.strip():
        raise ValueError(
            "must be usable as a file name (no slash, no control character, no blank at its ends, "
            "not too long)"
        )
    if name.partition(".")[0].lower() in _DEVICES:
        raise ValueError("is a device on Windows, not a file name")


def colliding_names(names: Iterable[str]) -> tuple[str, str] | None:
    """Return two ids that name one file since only case or Unicode form differs; or None."""
    known: dict[str, str] = {}
    for name in names:
        other = known.setdefault(unicodedata.normalize("NFC", name).casefold(), name)
        if other != name:
            return other, name
    return None
