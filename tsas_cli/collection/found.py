"""The manifests and diagnoses below folders."""

import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from tsas_cli.support.limits import is_text

MANIFEST, DIAGNOSIS = "dataset.toml", "diagnosis.json"


class FileKey(NamedTuple):
    """Location of a file: number of the root folder, folder relative to it, and name."""

    root: int
    folder: str
    file: str


_MOST = 2**63 - 1  # of an integer in the index; as a time, the year 2262


class Stamp(NamedTuple):
    """Evidence of a change of a file: time of its last modification [ns] and size [bytes]."""

    mtime_ns: int
    size: int


def files_below(roots: Sequence[Path]) -> tuple[dict[FileKey, Stamp], list[str]]:
    """Return the manifests and diagnoses below folders, and the folders that cannot be read.

    Hidden folders, links to folders and the `runs` of a dataset are skipped.
    """
    found: dict[FileKey, Stamp] = {}
    problems: list[str] = []
    for number, root in enumerate(roots):
        if not is_text(root):
            problems.append(f"{root}: its name is not UTF-8; rename it")
            continue
        pending = [""]
        while pending:
            folder = pending.pop()
            try:
                pending += _scanned(root, number, folder, found, problems)
            except OSError as error:
                problems.append(f"{root / folder}: cannot be read ({error.strerror})")
    return found, problems


def _scanned(
    root: Path, number: int, folder: str, found: dict[FileKey, Stamp], problems: list[str]
) -> Iterator[str]:
    """Add the files of one folder to `found`; return its subfolders."""
    here = f"{folder}/" if folder else ""
    inner = []
    with os.scandir(f"{root}/{folder}") as entries:
        for entry in entries:
            name = entry.name
            if name in (MANIFEST, DIAGNOSIS):
                if entry.is_file():
                    state = entry.stat()
                    changed_ns = max(-_MOST, min(state.st_mtime_ns, _MOST))
                    found[FileKey(number, folder, name)] = Stamp(changed_ns, state.st_size)
            elif not name.startswith(".") and entry.is_dir(follow_symlinks=False):
                if name.isprintable():
                    inner.append(name)
                else:
                    problems.append(f"{root / folder / name}: a name with control characters")
    dataset = FileKey(number, folder, MANIFEST) in found
    return (f"{here}{name}" for name in inner if not (dataset and name == "runs"))
