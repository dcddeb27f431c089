"""The seal of a page: its origin in the first lines, its inputs and its checksum at the end.

The last line is the checksum of all above. The head identifies a page whose end is lost.
"""

import hashlib
import json
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tsas_cli.recordings.storage import Location, location_text
from tsas_cli.support.errors import InputError

_TYPE = "<!DOCTYPE html>\n"
_HEAD = "<!-- a page of tsas, which ends with its own checksum -->\n"
PAGE_MARK = _HEAD.encode()
_READ = "<!-- tsas has read: "
_SUM = re.compile(rb"<!-- sha256 of all above: ([0-9a-f]{64}) -->\n")


@dataclass(frozen=True)
class Seal:
    """The recorded and the actual checksum of a page, and its input files."""

    sha256: str
    found: str
    read: tuple[Any, ...]


def with_seal(text: str, files: Iterable[tuple[Location, str]], page: Path) -> str:
    """Return a page's text with its seal; locations are relative to the page.

    `files` are folders, or addresses, each with the name of a file in it.
    """
    home = page.parent.resolve()
    read = [
        {
            "file": name,
            "folder": location_text(home, folder),
            "sha256": hashlib.sha256((folder / name).read_bytes()).hexdigest(),
        }
        for folder, name in files
    ]
    listed = json.dumps(read, ensure_ascii=False).replace("--", "-\\u002d")  # would end the comment
    marked = text.replace(_TYPE, _TYPE + _HEAD, 1)
    body = f"{marked.rstrip()}\n{_READ}{listed} -->\n"
    return f"{body}<!-- sha256 of all above: {hashlib.sha256(body.encode()).hexdigest()} -->\n"


def sealed(path: Path) -> Seal | None:
    """Return the seal of a page, or None if it is no page of tsas.

    InputError: the page cannot be read, or its seal is broken.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", where=path) from error
    if not any(mark in content for mark in _MARKS):
        return None
    body, line = content[:-_LENGTH], content[-_LENGTH:]
    checksum = _SUM.fullmatch(line)
    if checksum is None:
        raise InputError("its last line is not the checksum of its seal", where=path)
    listed = body.rpartition(_READ.encode())[2].rstrip()
    try:
        read = json.loads(listed.removesuffix(b"-->"))
    except ValueError as error:
        raise InputError("does not list its inputs", where=path) from error
    found = hashlib.sha256(body).hexdigest()
    return Seal(checksum[1].decode(), found, tuple(read) if isinstance(read, list) else ())


_MARKS = (PAGE_MARK, _READ.encode(), b"<!-- sha256 of all above: ")
_LENGTH = len("<!-- sha256 of all above:  -->\n") + 64
