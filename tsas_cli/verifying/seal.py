"""What a page says of itself: at its head whose it is, at its end what it was made from.

The last line is the checksum of all above. The head is there for a page that has lost its end.
"""

import hashlib
import json
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tsas_cli.recordings.storage import Place, told_from
from tsas_cli.support.errors import InputError

_TYPE = "<!DOCTYPE html>\n"
_HEAD = "<!-- a page of tsas, which ends with its own checksum -->\n"
MARK = _HEAD.encode()
_READ = "<!-- tsas has read: "
_SUM = re.compile(rb"<!-- sha256 of all above: ([0-9a-f]{64}) -->\n")


@dataclass(frozen=True)
class Seal:
    """A page's checksum as it was written and as it is, and the files that it was made from."""

    sha256: str
    found: str
    read: tuple[Any, ...]


def with_seal(text: str, files: Iterable[tuple[Place, str]], page: Path) -> str:
    """Return a page's text with the comments that `sealed` reads; places are said from the page.

    `files` are folders, or addresses, each with the name of a file there.
    """
    home = page.parent.resolve()
    read = [
        {
            "file": name,
            "folder": told_from(home, folder),
            "sha256": hashlib.sha256((folder / name).read_bytes()).hexdigest(),
        }
        for folder, name in files
    ]
    said = json.dumps(read, ensure_ascii=False).replace("--", "-\\u002d")  # would end the comment
    marked = text.replace(_TYPE, _TYPE + _HEAD, 1)
    body = f"{marked.rstrip()}\n{_READ}{said} -->\n"
    return f"{body}<!-- sha256 of all above: {hashlib.sha256(body.encode()).hexdigest()} -->\n"


def sealed(path: Path) -> Seal | None:
    """Return the seal of a page, or None where nothing in it is that of a page of ours.

    Raises
    ------
    InputError
        It cannot be read, or its seal is broken.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", where=path) from error
    if not any(mark in content for mark in _MARKS):
        return None
    body, line = content[:-_LENGTH], content[-_LENGTH:]
    told = _SUM.fullmatch(line)
    if told is None:
        raise InputError("its last line is not the checksum that was there", where=path)
    said = body.rpartition(_READ.encode())[2].rstrip()
    try:
        read = json.loads(said.removesuffix(b"-->"))
    except ValueError as error:
        raise InputError("does not say what it was made from", where=path) from error
    found = hashlib.sha256(body).hexdigest()
    return Seal(told[1].decode(), found, tuple(read) if isinstance(read, list) else ())


_MARKS = (MARK, _READ.encode(), b"<!-- sha256 of all above: ")
_LENGTH = len("<!-- sha256 of all above:  -->\n") + 64
