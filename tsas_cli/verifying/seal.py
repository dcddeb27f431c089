"""The last lines of a page: what it was made from, and the checksum of all above."""

import hashlib
import json
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tsas_cli.errors import InputError
from tsas_cli.recordings.storage import Place, told_from

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
    read = [
        {
            "file": name,
            "folder": told_from(page.parent, folder),
            "sha256": hashlib.sha256((folder / name).read_bytes()).hexdigest(),
        }
        for folder, name in files
    ]
    said = json.dumps(read, ensure_ascii=False).replace("--", "-\\u002d")  # would end the comment
    body = f"{text.rstrip()}\n{_READ}{said} -->\n"
    return f"{body}<!-- sha256 of all above: {hashlib.sha256(body.encode()).hexdigest()} -->\n"


def sealed(path: Path) -> Seal | None:
    """Return the seal of a page, or None where it has none.

    Raises
    ------
    InputError
        It cannot be read, or its seal is broken.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", where=path) from error
    if _READ.encode() not in content:
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


_LENGTH = len("<!-- sha256 of all above:  -->\n") + 64
