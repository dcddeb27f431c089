"""The datasets of a plan: their folders, and the checksum of each manifest."""

import glob
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from tsas_cli.recordings.manifest import MANIFEST_FILE, read_toml
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import sha256_of

WILD = "*?["


@dataclass(frozen=True)
class SweepSource:
    """A dataset by its name in the plan, or one run of it; `sha256` is that of the manifest."""

    name: str
    folder: Path
    sha256: str
    run: str | None = None


def sources_of(names: tuple[str, ...], base: Path, *, each_run: bool) -> list[SweepSource]:
    """Return the datasets of names and patterns, in order; with `each_run` their runs.

    A pattern such as `rigs/*` selects the folders that hold a `dataset.toml`.

    InputError: a folder holds no dataset, or a pattern matches none.
    """
    found: dict[Path, SweepSource] = {}
    for name in names:
        for source in _matching(name, base):
            found.setdefault(source.folder.resolve(), source)  # patterns may overlap
    sources = list(found.values())
    return [run for source in sources for run in _runs(source)] if each_run else sources


def _matching(name: str, base: Path) -> Iterator[SweepSource]:
    """Yield the datasets of a name or a pattern."""
    if not any(sign in name for sign in WILD) or (base / name).is_dir():
        yield _source(name, base)
        return
    folders = sorted(glob.glob(name, root_dir=base, recursive=True))  # noqa: PTH207 # absolute too
    datasets = [folder for folder in folders if (base / folder / MANIFEST_FILE).is_file()]
    if not datasets:
        raise InputError(
            "no dataset matches",
            where=base / name,
            expected=f"folders with {MANIFEST_FILE}",
            remedy=f"{len(folders)} other files and folders match" if folders else "",
        )
    yield from (_source(folder, base) for folder in datasets)


def _source(name: str, base: Path) -> SweepSource:
    folder = base / name
    if not (folder / MANIFEST_FILE).is_file():
        inside = next(folder.glob(f"*/{MANIFEST_FILE}"), None) if folder.is_dir() else None
        raise InputError(
            "no dataset.toml here",
            where=folder,
            expected="a dataset folder",
            remedy=f"its subfolders are datasets: use '{name}/*'" if inside else "",
        )
    return SweepSource(Path(name).as_posix(), folder, sha256_of(folder / MANIFEST_FILE))


def _runs(source: SweepSource) -> Iterator[SweepSource]:
    """Yield each run; or the dataset if its manifest lists none, whose task reports the fault."""
    try:
        runs = [str(run["id"]) for run in read_toml(source.folder / MANIFEST_FILE)["run"]]
    except (InputError, KeyError, TypeError):
        runs = []
    yield from (SweepSource(source.name, source.folder, source.sha256, run) for run in runs)
    if not runs:
        yield source
