"""The files below folders that say something about runs: manifests and diagnoses."""

import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from tsas_cli.support.limits import is_text

MANIFEST, DIAGNOSIS = "dataset.toml", "diagnosis.json"


class Place(NamedTuple):
    """Where a file is: which of the folders it was found below, its own folder there, its name."""

    root: int
    folder: str
    file: str


_MOST = 2**63 - 1  # what the index keeps, a time in the year 2262


class Stamp(NamedTuple):
    """What tells whether a file has changed: time of its last change [ns] and size [bytes]."""

    mtime_ns: int
    size: int


def files_below(roots: Sequence[Path]) -> tuple[dict[Place, Stamp], list[str]]:
    """Return every manifest and diagnosis below some folders, and what could not be looked into.

    Hidden folders, links to folders and the recordings of a dataset are not looked into.
    """
    found: dict[Place, Stamp] = {}
    problems: list[str] = []
    for number, root in enumerate(roots):
        if not is_text(root):
            problems.append(f"{root}: its name is no text; rename it")
            continue
        ahead = [""]
        while ahead:
            folder = ahead.pop()
            try:
                ahead += _looked_into(root, number, folder, found, problems)
            except OSError as error:
                problems.append(f"{root / folder}: cannot be looked into ({error.strerror})")
    return found, problems


def _looked_into(
    root: Path, number: int, folder: str, found: dict[Place, Stamp], problems: list[str]
) -> Iterator[str]:
    """Take note of the files of one folder; yield the folders in it."""
    here = f"{folder}/" if folder else ""
    inner = []
    with os.scandir(f"{root}/{folder}") as entries:
        for entry in entries:
            name = entry.name
            if name in (MANIFEST, DIAGNOSIS):
                if entry.is_file():
                    seen = entry.stat()
                    changed_ns = max(-_MOST, min(seen.st_mtime_ns, _MOST))
                    found[Place(number, folder, name)] = Stamp(changed_ns, seen.st_size)
            elif not name.startswith(".") and entry.is_dir(follow_symlinks=False):
                if name.isprintable():
                    inner.append(name)
                else:
                    problems.append(f"{root / folder / name}: a name with control characters")
    dataset = Place(number, folder, MANIFEST) in found
    return (f"{here}{name}" for name in inner if not (dataset and name == "runs"))
