"""Checksums that files record of other files, at the time of writing or reading.

The first lines of a page say that it is one, so that a page whose end is lost is known; its inputs
and the checksum of all above stand at its end.
"""

import hashlib
import json
import os.path
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tsas_cli.recordings.manifest import MANIFEST_FILE, read_toml
from tsas_cli.recordings.storage import Location, is_address, location_text, path_from
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import read_json, sha256_of
from tsas_cli.support.replacing import SUMS, sealed
from tsas_cli.verifying.outputs import outputs_of

_TYPE = "<!DOCTYPE html>\n"
_HEAD = "<!-- a page of tsas, which ends with its own checksum -->\n"
PAGE_MARK = _HEAD.encode()
_READ = "<!-- tsas has read: "
_PAGE_SUM = re.compile(rb"<!-- sha256 of all above: ([0-9a-f]{64}) -->\n")
_MARKS = (PAGE_MARK, _READ.encode(), b"<!-- sha256 of all above: ")
_LENGTH = len("<!-- sha256 of all above:  -->\n") + 64
_SUM = re.compile(r"([0-9a-f]{64})  (.+)")
_INPUTS = ("model", "plant", "drive", "settings", "reference")  # keys of a stage's JSON


@dataclass(frozen=True)
class Claim:
    """A recorded checksum of a file, and the file that recorded it.

    `path` is its recorded location, if any; `found` is the actual checksum if it is already known,
    as for a part of a file.
    """

    by: Path
    file: str
    sha256: str
    path: Path | None = None
    found: str | None = None


def claims_of(path: Path) -> Iterator[Claim]:
    """Yield the checksums that a file records of others; none if tsas has not written it.

    InputError: the file cannot be read, or is not in the format of its name.
    """
    if path.name == SUMS:
        yield from _of_sums(path)
    elif path.name == MANIFEST_FILE:
        yield from _of_manifest(path)
    elif path.suffix == ".json":
        content = read_json(path)
        if isinstance(content, dict) and "stage" in content:
            yield from _of_stage(path, content)
    elif path.suffix == ".toml":
        yield from _of_dataset(path, read_toml(path).get("dataset"))
    elif path.suffix == ".html":
        yield from _of_page(path)


def _of_sums(path: Path) -> Iterator[Claim]:
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, ValueError) as error:
        raise InputError("cannot be read", where=path) from error
    if not lines:
        raise InputError(
            "is empty", where=path, expected="a line of checksum and name for each file"
        )
    for number, line in enumerate(lines, start=1):
        found = _SUM.fullmatch(line)
        if found is None:
            raise InputError("is no line of checksum and name", where=f"{path}, line {number}")
        yield Claim(path, found[2], found[1], path.parent / found[2])


def _of_manifest(path: Path) -> Iterator[Claim]:
    content = read_toml(path)
    runs = content.get("run")
    for run in runs if isinstance(runs, list) else []:
        if isinstance(run, dict) and {"file", "sha256"} <= run.keys():
            file = str(run["file"])
            yield Claim(path, file, str(run["sha256"]).lower(), path.parent / file)
    ingest = content.get("ingest")
    if isinstance(ingest, dict):
        yield from _of_file(path, ingest.get("map"))
        sources = ingest.get("sources")
        for source in sources.values() if isinstance(sources, dict) else ():
            yield from _of_file(path, source)


def _of_stage(path: Path, content: Mapping[str, Any]) -> Iterator[Claim]:
    yield from _of_dataset(path, content.get("dataset"))
    yield from _of_dataset(path, content.get("on"))
    for key in _INPUTS:
        yield from _of_file(path, content.get(key))
    models = content.get("models")  # of `tsas predict`
    for model in models if isinstance(models, list) else ():
        yield from _of_file(path, model)
    rig = content.get("rig")  # of `tsas plan`, whose path is relative to the plan's folder
    yield from _of_file(path, rig | {"folder": ""} if isinstance(rig, dict) else None)
    for side in (content.get("a"), content.get("b")):  # of `tsas compare`
        files = side.get("files") if isinstance(side, dict) else None
        for file, digest in files.items() if isinstance(files, dict) else ():
            yield Claim(path, str(file), str(digest))


def _of_dataset(path: Path, dataset: object) -> Iterator[Claim]:
    """Yield the files of an input dataset; its folder is relative to that of `path`."""
    if isinstance(dataset, dict) and isinstance(dataset.get("hashes"), dict):
        folder = dataset.get("folder")
        for file, digest in dataset["hashes"].items():
            yield _claim(path, folder, str(file), str(digest).lower())


def _of_file(path: Path, record: object) -> Iterator[Claim]:
    if isinstance(record, dict) and isinstance(record.get("sha256"), str):
        file, folder = str(record.get("file")), record.get("folder")
        yield _claim(path, folder, file, record["sha256"])


def _of_page(path: Path) -> Iterator[Claim]:
    """Yield the checksum of a page, and those of its inputs; none if it is no page of tsas.

    InputError: the page cannot be read, or what it ends with is broken.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", where=path) from error
    if not any(mark in content for mark in _MARKS):
        return
    body, line = content[:-_LENGTH], content[-_LENGTH:]
    checksum = _PAGE_SUM.fullmatch(line)
    if checksum is None:
        raise InputError("its last line is not the checksum of its seal", where=path)
    listed = body.rpartition(_READ.encode())[2].rstrip()
    try:
        read = json.loads(listed.removesuffix(b"-->"))
    except ValueError as error:
        raise InputError("does not list its inputs", where=path) from error
    found = hashlib.sha256(body).hexdigest()
    yield Claim(path, path.name, checksum[1].decode(), path, found)
    for record in read if isinstance(read, list) else ():
        yield from _of_file(path, record)


def _claim(path: Path, folder: object, file: str, digest: str) -> Claim:
    """Return the claim for a file in a folder that is relative to that of `path`, or an address."""
    if not isinstance(folder, str):
        return Claim(path, file, digest)
    location = os.path.join(folder, file)  # noqa: PTH118 # may be an address
    if is_address(location):
        return Claim(path, location, digest)
    return Claim(path, file, digest, path_from(path.resolve().parent, location))


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
    return sealed(f"{marked.rstrip()}\n{_READ}{listed} -->\n", markup=True)


def change_notes(given: Iterable[object]) -> list[str]:
    """Return a sentence for each folder, of what is given, that is not as its stage has written it.

    Of a file in such a folder, that file counts alone; what is no path, or no stage has written,
    tells nothing.
    """
    changed, lacking = [], []
    for path in dict.fromkeys(path for path in given if isinstance(path, Path)):
        folder = path if path.is_dir() else path.parent
        sums, written = folder / SUMS, {n for f in folder.glob("*.json") for n in outputs_of(f)}
        if not sums.is_file():
            if written if path == folder else path.name in written:
                lacking.append(f"{folder.name}/{SUMS} is missing")
            continue
        try:
            listed = list(claims_of(sums))
        except InputError:
            changed.append(f"{folder.name}/{SUMS}")
            continue
        taken = [claim for claim in listed if path in (folder, folder / claim.file)]
        if found := [f"{folder.name}/{c.file}" for c in taken if not _fits(folder / c.file, c)]:
            changed.append(", ".join(found))
        lost = (written if path == folder else {path.name}) - {claim.file for claim in listed}
        if lost:
            lacking.append(f"{folder.name}/{SUMS} does not list {', '.join(sorted(lost))}")
    more = "`tsas verify` says more."
    return [
        f"Changed since it was written: {found}. What is shown of it is not what the stage found; "
        f"{more}"
        for found in changed
    ] + [
        f"Without a checksum: {found}. What is shown of it may not be what the stage found; {more}"
        for found in lacking
    ]


def _fits(path: Path, claim: Claim) -> bool:
    try:
        return sha256_of(path) == claim.sha256
    except OSError:
        return False
