"""A new project: a map, a place for recordings, and the pipeline that takes them to a page."""

import shutil
from collections.abc import Sequence
from pathlib import Path

from tsas_cli.errors import InputError
from tsas_cli.files import new_folder
from tsas_cli.recordings.guess.proposal import Proposal, propose
from tsas_cli.recordings.guess.text import map_text
from tsas_cli.recordings.ingest import find_files

HERE = Path(__file__).parent
MAKE = ("settings.mk", "ingest.mk", "chain.mk")
MAP, RAW = "bench.toml", "raw"


def makefile() -> str:
    """Return the Makefile of a project; the project's own pipelines run the same steps."""
    return "\n".join((HERE / "make" / name).read_text(encoding="utf-8") for name in MAKE)


def start(folder: Path, sources: Sequence[Path]) -> tuple[list[str], Proposal | None]:
    """Write a project; return its files, and the proposal for its map where there are sources.

    The sources are copied into `raw/`, a folder with its name. A folder that is there gets the
    files beside what it holds.

    Raises
    ------
    InputError
        A file of that name is there, a source cannot be read, or two have the same name.
    """
    name = folder.resolve().name or "bench"
    texts = {
        "Makefile": makefile(),
        "README.md": _file("README.md", name),
        ".gitignore": _file("gitignore", name),
        f"{RAW}/README.md": _file("raw.md", name),
    }
    copies = _copies(sources, folder)
    proposal = propose(find_files(sources, "*")) if sources else None
    texts[MAP] = map_text(proposal) if proposal else _file("bench.toml", name)
    _refuse_existing(folder, [*texts, *copies])
    if folder.exists():
        _write(folder, texts, copies)
    else:
        with new_folder(folder) as new:
            _write(new, texts, copies)
    return [*texts, *copies], proposal


def _file(name: str, project: str) -> str:
    return (HERE / "files" / name).read_text(encoding="utf-8").replace("{name}", project)


def _copies(sources: Sequence[Path], folder: Path) -> dict[str, Path]:
    """Return where in the project each file of the sources goes; what is in raw/ stays there."""
    copies: dict[str, Path] = {}
    for source in sources:
        for path in find_files([source], "*"):
            if path.resolve().is_relative_to((folder / RAW).resolve()):
                continue
            inside = path.relative_to(source.parent) if source.is_dir() else Path(path.name)
            if source.is_dir() and not source.name:
                inside = path.relative_to(source)
            place = f"{RAW}/{inside.as_posix()}"
            if place in copies:
                raise InputError(f"two sources are called {inside}", where=path)
            copies[place] = path
    return copies


def _refuse_existing(folder: Path, names: Sequence[str]) -> None:
    if folder.is_file():
        raise InputError("is a file", where=folder, expected="a folder's name")
    there = [name for name in names if (folder / name).exists()]
    if there:
        raise InputError(
            f"{', '.join(there)} {'is' if len(there) == 1 else 'are'} there already",
            where=folder,
            expected="a folder without them",
            remedy="nothing is overwritten: choose another folder, or move them away",
        )


def _write(folder: Path, texts: dict[str, str], copies: dict[str, Path]) -> None:
    for name, text in texts.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    for name, source in copies.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(source, folder / name)
