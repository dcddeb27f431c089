"""A new project: a map, a folder for recordings, and the pipeline to a report."""

import filecmp
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path

import tomlkit

from tsas_cli.recordings.guess.proposal import MapProposal, propose
from tsas_cli.recordings.guess.text import map_text
from tsas_cli.recordings.ingest import find_files
from tsas_cli.recordings.readers.joined import joined_by
from tsas_cli.support.errors import InputError, printable
from tsas_cli.support.files import new_file, new_folder
from tsas_cli.support.replacing import sealed
from tsas_cli.support.temporaries import sweep

HERE = Path(__file__).parent
MAKE = ("settings.mk", "names.mk", "chain.mk", "ingest.mk")
MAP, RAW = "bench.toml", "raw"


def makefile() -> str:
    """Return the Makefile of a project; the pipelines of this repository run the same steps."""
    return "\n".join((HERE / "make" / name).read_text(encoding="utf-8") for name in MAKE)


def start(folder: Path, sources: Sequence[Path]) -> tuple[list[str], MapProposal | None]:
    """Return the files of a new project, and the proposal for its map if there are sources.

    The sources are copied into `raw/`, a folder with its name. Files are added to an existing
    folder one by one: after a kill, the same call writes the missing ones.

    InputError: a file exists with other content, a source cannot be read or is the folder itself,
    or two have the same name.
    """
    if folder.exists() and any(source.resolve() == folder.resolve() for source in sources):
        raise InputError(
            "is both the project and its recordings",
            where=folder,
            remedy=f"name a new folder, or move the recordings into {folder / RAW} and name that",
        )
    name = printable(folder.resolve().name) or "bench"
    quoted = tomlkit.item(name).as_string()
    files: dict[str, str | Path] = {  # by place in the project: a text, or what is copied there
        "Makefile": makefile(),
        "README.md": _file("README.md", name),
        ".gitignore": _file("gitignore", name),
        f"{RAW}/README.md": _file("raw.md", name),
    }
    proposal = propose(find_files(sources, "*")) if sources else None
    files[MAP] = sealed(map_text(proposal)) if proposal else _file("bench.toml", quoted)
    files |= _copies(sources, folder)
    present = _present(folder, files)
    if folder.exists():
        for home in {folder.parent, *((folder / place).parent for place in files)}:
            sweep(home)  # also if all files exist and nothing is written
        for place in [p for p in files if p not in present]:
            with new_file(folder / place, mark=b"", inputs=sources) as new:
                _write(new, files[place])
    else:
        with new_folder(folder, stage="init", inputs=sources) as new:
            for place, content in files.items():
                (new / place).parent.mkdir(parents=True, exist_ok=True)
                _write(new / place, content)
    return list(files), proposal


def _file(name: str, project: str) -> str:
    return (HERE / "files" / name).read_text(encoding="utf-8").replace("{name}", project)


def _copies(sources: Sequence[Path], folder: Path) -> dict[str, Path]:
    """Return the path in the project of each source file, except those already in raw/."""
    copies: dict[str, Path] = {}
    for source in sources:
        found = find_files([source], "*")
        for path in [one for file in found for one in (file, *joined_by(file))]:
            if path.resolve().is_relative_to((folder / RAW).resolve()):
                continue
            inside = path.relative_to(source.parent) if source.is_dir() else Path(path.name)
            if source.is_dir() and source.name in {"", ".."}:  # a name that is no folder's
                inside = path.relative_to(source)
            place = f"{RAW}/{inside.as_posix()}"
            if place in copies and copies[place] != path:  # lists may share a file
                raise InputError(f"two sources have the name {inside}", where=path)
            copies[place] = path
    return copies


def _present(folder: Path, files: Mapping[str, str | Path]) -> set[str]:
    """Return the files that exist already; refuse those with other content."""
    if folder.is_file():
        raise InputError("is a file", where=folder, expected="a folder's name")
    present = [place for place in files if (folder / place).exists()]
    other = [place for place in present if not _is_same(folder / place, files[place])]
    if other:
        raise InputError(
            f"{', '.join(other)} already {'exists' if len(other) == 1 else 'exist'}",
            where=folder,
            expected="a folder without them",
            remedy="nothing is overwritten: choose another folder, or move them away",
        )
    return set(present)


def _is_same(path: Path, content: str | Path) -> bool:
    if not path.is_file():
        return False
    if isinstance(content, str):
        return path.read_bytes() == content.encode()
    return filecmp.cmp(path, content, shallow=False)


def _write(path: Path, content: str | Path) -> None:
    if isinstance(content, str):
        path.write_text(content, encoding="utf-8")
    else:
        shutil.copyfile(content, path)
