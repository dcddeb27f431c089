"""What an output may not be or replace: `--force` deletes an earlier output, and nothing else."""

import os
from collections.abc import Iterable
from pathlib import Path

from tsas_cli.errors import InputError
from tsas_cli.temporaries import is_empty_folder

SUMS = "SHA256SUMS"
_LEFT_BY_DESKTOPS = frozenset({".DS_Store", "Thumbs.db", "desktop.ini"})


def refuse_address(path: Path) -> None:
    """Keep `--out s3://…` from becoming a folder `s3:`."""
    if path.parts and path.parts[0] in {"s3:", "gs:", "file:"}:
        raise InputError(
            "is an address",
            where=path.as_posix().replace(":/", "://", 1),
            expected="a local folder or file",
            remedy="write there, then copy it",
        )


def refuse_kind(path: Path, *, folder: bool) -> None:
    """Keep a folder from replacing a file, a file a folder, and both a device or a pipe."""
    if not path.exists() or (path.is_dir() if folder else path.is_file()):
        return
    kind = "a folder" if path.is_dir() else "a file" if path.is_file() else "a device or a pipe"
    raise InputError(
        f"is {kind}", where=path, expected=f"a {'folder' if folder else 'file'}'s name"
    )


def refuse_existing(path: Path, *, force: bool) -> None:
    """Keep what is there, unless it is to be replaced; an empty folder is nothing."""
    if os.path.lexists(path) and not is_empty_folder(path) and not force:
        raise exists(path)


def exists(path: Path) -> InputError:
    """Return what is said of a name that is taken."""
    return InputError(
        "already exists",
        where=path,
        expected="a name that is free",
        remedy="choose another --out, or replace it with --force",
    )


def refuse_current(path: Path) -> None:
    """Keep `--out . --force` from deleting the folder that somebody works in."""
    if Path.cwd().is_relative_to(path.resolve()):
        raise InputError(
            "is the current folder, or holds it",
            where=path,
            remedy="choose an --out that is a folder of its own",
        )


def refuse_foreign(path: Path, new: Path) -> None:
    """Keep `--out DATASET --force` from deleting recordings, or what else somebody keeps there."""
    if not path.is_dir():
        return
    ours = {member.name for member in new.iterdir()}
    there = {member.name for member in path.iterdir()}
    foreign = sorted(there - ours - _listed(path) - {SUMS} - _LEFT_BY_DESKTOPS)
    if foreign:
        raise InputError(
            f"holds something else than an earlier output ({', '.join(foreign[:5])})",
            where=path,
            expected=f"a folder with {', '.join(sorted(ours))}",
            remedy="choose another --out",
        )


def _listed(folder: Path) -> set[str]:
    """Return what `SHA256SUMS` names in a folder itself: what an earlier output has put there."""
    try:
        lines = (folder / SUMS).read_text(encoding="utf-8").splitlines()
    except (OSError, ValueError):
        return set()
    return {line.partition("  ")[2].partition("/")[0] for line in lines}


def refuse_input(path: Path, inputs: Iterable[Path]) -> None:
    """Keep an output from replacing what it is made of.

    Raises
    ------
    InputError
        One of the inputs is the output, or lies in it.
    """
    for source in inputs:
        if source.resolve().is_relative_to(path.resolve()):
            raise InputError(
                "is read, and would be replaced",
                where=source,
                remedy="choose another --out",
            )
