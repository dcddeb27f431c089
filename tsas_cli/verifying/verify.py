"""Verification of every recorded checksum below a folder, and of its inputs."""

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from tsas_cli.recordings.manifest import MANIFEST_FILE
from tsas_cli.recordings.storage import is_address
from tsas_cli.support import limits
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import read_json, sha256_of
from tsas_cli.support.replacing import SUMS
from tsas_cli.verifying.claims import Claim, claims_of
from tsas_cli.verifying.outputs import outputs_of

_State = Literal["fits", "changed", "missing", "cannot tell"]
_OURS = {".json", ".toml", ".html"}


@dataclass(frozen=True)
class Verified:
    """The state of one file; `by` recorded its checksum, empty if no file did."""

    file: str
    state: _State
    by: str = ""
    why: str = ""


@dataclass
class _Walk:
    """State of a verification: pending files, and those verified so far."""

    raw: Sequence[Path]
    waiting: deque[Path]
    step: Callable[[], None]
    seen: set[Path] = field(default_factory=set)
    sums: dict[Path, str] = field(default_factory=dict)
    claimed: set[Path] = field(default_factory=set)
    known: dict[tuple[str, str], Path] = field(default_factory=dict)


def verify_all(
    start: Path, raw: Sequence[Path] = (), step: Callable[[], None] = lambda: None
) -> list[Verified]:
    """Return the state of a page or of all outputs below a folder, and of their inputs.

    `raw` are folders to search for raw recordings that have moved. `step` is called after each
    file.

    InputError: there is no output of tsas, or a single file records no checksum.
    """
    if not start.exists():
        raise InputError("does not exist", where=start, expected="a folder, or a page")
    files = [start] if start.is_file() else _ours_below(start)
    if not files:
        raise InputError(
            "holds no output of tsas",
            where=start,
            expected=f"the folder of a stage or a dataset, a folder above, or {SUMS}",
        )
    walk = _Walk(raw, deque(files), step)
    claims, found = list[Claim](), list[Verified]()
    while walk.waiting:
        path = walk.waiting.popleft()
        # A list that is a link to that of another folder still applies to its own folder.
        itself = path.parent.resolve() / path.name
        if itself in walk.seen:
            continue
        walk.seen.add(itself)
        try:
            for claim in claims_of(path):
                claims.append(claim)
                if claim.path is not None and claim.path != path:
                    walk.waiting.extend(_related(claim.path))
        except InputError as error:
            state: _State = "changed" if limits.is_text(path) else "cannot tell"
            found.append(Verified(_shown(path), state, "", error.what))
    # Claims with a location come first: other claims may refer to the files found there.
    ordered = sorted(claims, key=lambda claim: claim.path is None)
    found += [_judged(claim, walk) for claim in ordered]
    found += list(_unlisted(walk, claims, {one.file for one in found if one.state != "fits"}))
    if not found and start.is_file():
        raise InputError(
            "it records no checksum",
            where=start,
            expected="a page of tsas report, or the folder of a stage or of a dataset",
        )
    return found + list(_unclaimed(walk, {one.file for one in found}))


def _ours_below(folder: Path) -> list[Path]:
    """Return the files below a folder that record checksums; hidden folders are skipped."""
    return [
        path
        for path in sorted(folder.rglob("*"))
        if (path.suffix in _OURS or path.name == SUMS)
        and path.is_file()
        and not any(part.startswith(".") for part in path.relative_to(folder).parts)
        and _records_checksums(path)
    ]


def _records_checksums(path: Path) -> bool:
    """Return whether a file records checksums, or would if it were intact."""
    if path.name in {SUMS, MANIFEST_FILE} or (path.parent / SUMS).is_file():
        return True
    try:
        if path.suffix == ".json":
            content = read_json(path)
            return isinstance(content, dict) and {"format", "stage"} <= content.keys()
        lost = path.suffix == ".html" and not path.stat().st_size  # a page of zero bytes is damaged
        return lost or any(True for _ in claims_of(path))
    except InputError:
        return path.suffix == ".html"  # a damaged or unreadable page of tsas


def _related(path: Path) -> Iterator[Path]:
    """Yield the files that may record checksums of an input's own inputs."""
    if path.suffix in _OURS and os.path.isfile(path):  # noqa: PTH113 # False for a name that is too long, too
        yield path
    if os.path.isfile(sums := path.parent / SUMS):  # noqa: PTH113
        yield sums
        yield from (p for p in sorted(path.parent.iterdir()) if p.suffix in _OURS and p.is_file())


def _judged(claim: Claim, walk: _Walk) -> Verified:
    path, by = claim.path, _shown(claim.by)
    walk.step()
    if path is not None and os.path.isfile(path):  # noqa: PTH113
        walk.claimed.add(path.resolve())
        if (claim.found or _sum(path, walk)) == claim.sha256:
            return Verified(_shown(path), "fits", by)
        own = claim.by.name in {SUMS, MANIFEST_FILE} or claim.by == path
        why = f"has changed since it was {'written' if own else 'read'}"
        return Verified(_shown(path), "changed", by, why)
    known = walk.known.get((claim.file, claim.sha256)) if path is None else None
    if known is None and claim.by.name != SUMS:
        known = _in_raw(claim, walk)
    if known is not None:
        walk.claimed.add(known.resolve())
        return Verified(_shown(known), "fits", by)
    if path is None:
        why = "is on object storage" if is_address(claim.file) else "its location is not recorded"
        return Verified(claim.file, "cannot tell", by, why)
    return Verified(_shown(path), "missing", by, "does not exist")


def _in_raw(claim: Claim, walk: _Walk) -> Path | None:
    """Return the raw recording with the name and the checksum of a claim, or None."""
    paths = (path for folder in walk.raw for path in sorted(folder.rglob("*")))
    same = (path for path in paths if path.name == Path(claim.file).name and path.is_file())
    return next((path for path in same if _sum(path, walk) == claim.sha256), None)


def _unlisted(walk: _Walk, claims: Iterable[Claim], reported: set[str]) -> Iterator[Verified]:
    """Yield the files that a stage's JSON names and that its folder's list lacks, or the list."""
    listed = {one.by.parent.resolve() / one.file for one in claims if one.by.name == SUMS}
    for path in sorted(walk.seen):
        lost = [path.parent / name for name in outputs_of(path)]
        lost = [file for file in lost if file not in listed]
        sums = path.parent / SUMS
        if _shown(sums) in reported:  # it is damaged
            continue
        if lost and not sums.is_file():
            reported.add(_shown(sums))
            yield Verified(_shown(sums), "missing", _shown(path), "does not exist")
        for file in lost:
            if not file.is_file():
                yield Verified(_shown(file), "missing", _shown(path), "does not exist")
            elif sums.is_file():
                why = f"{SUMS} does not list it"
                yield Verified(_shown(file), "changed", _shown(path), why)


def _unclaimed(walk: _Walk, reported: set[str]) -> Iterator[Verified]:
    """Yield the manifests, pages and files of stages without a recorded checksum."""
    files: dict[Path, str] = {}
    for path in sorted(walk.seen):
        if path.name == SUMS:
            unlisted = f"{SUMS} does not list it"
            files |= dict.fromkeys(path.parent.rglob("*"), unlisted)
        elif not (path.parent / SUMS).is_file():
            beside = [path]
            if path.suffix == ".json":  # a stage's folder
                beside += [*path.parent.iterdir(), *path.parent.glob("runs/*")]
            files |= dict.fromkeys(beside, "no checksum of it is recorded")
    for path, why in sorted(files.items()):
        known = path in walk.claimed or path.name == SUMS or _shown(path) in reported
        if path.is_file() and not known:
            yield Verified(_shown(path), "cannot tell", "", why)


def _sum(path: Path, walk: _Walk) -> str:
    """Return the checksum of a file, computed once."""
    key = path.resolve()
    if key not in walk.sums:
        try:
            walk.sums[key] = sha256_of(path)
        except OSError as error:
            walk.sums[key] = f"cannot be read ({error.strerror})"
        walk.known[path.name, walk.sums[key]] = path
    return walk.sums[key]


def _shown(path: Path) -> str:
    return os.path.relpath(path)
