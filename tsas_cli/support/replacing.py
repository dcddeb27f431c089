"""Rules for replacing: with `--force`, an output replaces an earlier one of the same stage only.

It never replaces what was edited since, an input of the call, or a path that contains or lies
inside one.
"""

import hashlib
import json
import os
import re
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from tsas_cli.support.errors import InputError
from tsas_cli.support.temporaries import is_empty_folder

SUMS = "SHA256SUMS"
_DATASET = "dataset.toml"
LEFT_BY_DESKTOPS = frozenset({".DS_Store", "Thumbs.db", "desktop.ini"})
_SWEEP = "sweep"
_HEAD_BYTES = 4096  # of a file, which contain its mark
_SEAL = re.compile(rb"^(?:# |<!-- )sha256 of all above: ([0-9a-f]{64})(?: -->)?\n", re.MULTILINE)


def sealed(text: str, *, markup: bool = False) -> str:
    """Return the text of a TOML file with a last line that tells whether it was edited since.

    With `markup` the text is HTML or XML.
    """
    seal = f"sha256 of all above: {hashlib.sha256(text.encode()).hexdigest()}"
    return f"{text}<!-- {seal} -->\n" if markup else f"{text}# {seal}\n"


def refuse_address(path: Path) -> None:
    """Refuse an address as output, which would create a folder `s3:`."""
    if path.parts and path.parts[0] in {"s3:", "gs:", "file:"}:
        raise InputError(
            "is an address",
            where=path.as_posix().replace(":/", "://", 1),
            expected="a local folder or file",
            remedy="write there, then copy it",
        )


def refuse_kind(path: Path, *, folder: bool) -> None:
    """Refuse to replace a file by a folder, a folder by a file, or a device or pipe by either."""
    if not path.exists() or (path.is_dir() if folder else path.is_file()):
        return
    kind = "a folder" if path.is_dir() else "a file" if path.is_file() else "a device or a pipe"
    raise InputError(
        f"is {kind}", where=path, expected=f"a {'folder' if folder else 'file'}'s name"
    )


def exists(path: Path) -> InputError:
    """Return the error for an output that exists."""
    return InputError(
        "already exists",
        where=path,
        expected="a new name",
        remedy="choose another --out, or replace it with --force",
    )


def refuse_folder(path: Path, *, stage: str, inputs: Iterable[object], force: bool) -> None:
    """Refuse an existing path, unless it is an earlier output of the same stage and `force` is set.

    `stage` is named as in its JSON, "ingest" for datasets; only inputs that are local paths count.
    """
    refuse_inputs(path, inputs)
    if not os.path.lexists(path) or is_empty_folder(path):
        return
    if not force:
        raise exists(path)
    if Path.cwd().is_relative_to(path.resolve()):
        raise InputError(
            "is the current folder, or holds it",
            where=path,
            remedy="choose another folder with --out",
        )
    if path.exists():
        _refuse_foreign(path, stage)


def refuse_file(path: Path, *, mark: bytes, inputs: Iterable[object], force: bool) -> None:
    """Refuse an existing path, unless it is an earlier output of the same stage and `force` is set.

    An earlier output has `mark` in its first 4 KiB, and its seal fits, if it has one; only inputs
    that are local paths count.
    """
    refuse_inputs(path, inputs)
    if not os.path.lexists(path):
        return
    if not force:
        raise exists(path)
    if not path.exists():
        return
    with path.open("rb") as stream:
        content = stream.read(_HEAD_BYTES)
        written = mark in content
        content += stream.read() if mark and written else b""
    if not written:
        raise InputError(
            "is not an earlier output of this command",
            where=path,
            expected="a new name, or a file that it has written",
            remedy="choose another --out",
        )
    if _is_edited(content):
        raise _edited(path)


def refuse_inputs(path: Path, inputs: Iterable[object]) -> None:
    """Refuse an output that is an input, contains one, or lies inside one.

    Links and other spellings of a path are followed.
    """
    if not os.path.lexists(path):
        return
    read = [source for source in inputs if isinstance(source, Path) and source.exists()]
    refuse_holding(path, read)
    above = _above(path)
    for source in read:
        if above & _ids(source):
            raise InputError(
                f"lies inside {source}, which is an input",
                where=path,
                expected="an --out beside the inputs, or a new name",
            )


def refuse_holding(path: Path, inputs: Iterable[Path]) -> None:
    """Refuse an output that is an input or contains one."""
    if not os.path.lexists(path):
        return
    ours = _ids(path)
    for source in inputs:
        if ours & _above(source):
            raise InputError(
                "is an input, and would be replaced", where=source, remedy="choose another --out"
            )


def _ids(path: Path) -> set[tuple[int, int]]:
    """Return device and inode of a path, for a link of itself and its target."""
    found = {path.lstat()}
    if path.exists():
        found.add(path.stat())
    return {(each.st_dev, each.st_ino) for each in found}


def _above(path: Path) -> set[tuple[int, int]]:
    """Return the ids of a path and its parent folders, with and without resolving links."""
    ids: set[tuple[int, int]] = set()
    for start in {Path(os.path.abspath(path)), path.resolve()}:  # noqa: PTH100 # keeps links
        for each in (start, *start.parents):
            if os.path.lexists(each):
                ids |= _ids(each)
    return ids


def _refuse_foreign(path: Path, stage: str) -> None:
    """Refuse a folder that is no output of the stage, or holds files of other origin."""
    ours = _of_ingest(path) if stage == "ingest" else _of_stage(path, stage)
    if ours is None:
        raise InputError(
            f"is not an earlier output of `tsas {stage}`",
            where=path,
            expected="a new name, or a folder that it has written",
            remedy="choose another --out",
        )
    # A link to a folder is a file.
    files = (p for p in path.rglob("*") if p.is_symlink() or not p.is_dir())
    names = (p.relative_to(path).as_posix() for p in files if p.name not in LEFT_BY_DESKTOPS)
    refuse_others(path, sorted(set(names) - ours.keys()), stage)
    for name in sorted(ours):
        file, digest = path / name, ours[name]
        if digest and file.is_file() and not _fits(file, digest):
            raise _edited(file)


def refuse_others(path: Path, foreign: Sequence[str], stage: str) -> None:
    """Refuse a folder that holds files of other origin than a stage, unless there are none."""
    if foreign:
        raise InputError(
            f"holds files that `tsas {stage}` has not written ({', '.join(foreign[:5])})",
            where=path,
            expected="an earlier output only",
            remedy="move them elsewhere, or choose another --out",
        )


def _edited(path: Path) -> InputError:
    return InputError(
        "has changed since it was written",
        where=path,
        expected="an earlier output as it was written",
        remedy="move it elsewhere, or choose another --out",
    )


def _fits(path: Path, digest: str) -> bool:
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest() == digest.lower()


def _is_edited(content: bytes) -> bool:
    """Return whether the seal of a file does not fit what is above, or is not its last line."""
    *_, seal = (None, *_SEAL.finditer(content))
    if seal is None:
        return False
    fits = hashlib.sha256(content[: seal.start()]).hexdigest() == seal[1].decode()
    return not fits or seal.end() != len(content)


def _of_stage(folder: Path, stage: str) -> Mapping[str, str] | None:
    """Return the checksums of an earlier output of a stage; None if the folder is none."""
    try:
        lines = (folder / SUMS).read_text(encoding="utf-8").splitlines()
    except (OSError, ValueError):
        return None
    listed = {name: digest for digest, _, name in (line.partition("  ") for line in lines)}
    summaries = (folder / name for name in listed if "/" not in name and name.endswith(".json"))
    stages = {_stage_in(summary) for summary in summaries} - {None}
    # A task's folder also holds the JSON of its stage.
    owner = {_SWEEP} if _SWEEP in stages else stages
    return listed | {SUMS: ""} if owner == {stage} else None


def _stage_in(summary: Path) -> object:
    try:
        content = json.loads(summary.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return None
    return content.get("stage") if isinstance(content, dict) else None


def _of_ingest(folder: Path) -> Mapping[str, str] | None:
    """Return the checksums of an ingested dataset, "" where unknown; None if the folder is none."""
    try:
        text = (folder / _DATASET).read_bytes()
        content = tomllib.loads(text.decode("utf-8"))
        ingested = set(content["ingest"]["sources"])
        runs = {r["file"]: r.get("sha256", "") for r in content["run"] if r["id"] in ingested}
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None
    if _is_edited(text):
        raise _edited(folder / _DATASET)
    return runs | {_DATASET: ""}
