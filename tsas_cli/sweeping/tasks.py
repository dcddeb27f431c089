"""The tasks of a sweep: each with its inputs, and a name that depends on all of them."""

import glob
import hashlib
import json
import re
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from tsas_cli.recordings.manifest import MANIFEST_FILE, read_toml, why_no_dataset
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import in_subfolders, sha256_of
from tsas_cli.sweeping.outcome import Row, versions
from tsas_cli.sweeping.plan import SweepPlan, points_of
from tsas_cli.sweeping.values import Options, Values, sorted_values

WILD = "*?["
TASK_FILE = "task.json"  # in each task's folder: its inputs and results
LONGEST = 100  # characters of the readable part of a name


@dataclass(frozen=True)
class SweepSource:
    """A dataset by its name in the plan, or one run of it; `sha256` is that of the manifest."""

    name: str
    folder: Path
    sha256: str
    run: str | None = None


@dataclass(frozen=True)
class Task:
    """One call of a stage, whose result depends on `inputs` alone: files by their checksums."""

    key: str  # its name: the varied values, and a digest of `inputs`
    source: SweepSource | None  # the dataset or run; None if the stage has none
    point: Row  # the varied values
    inputs: Mapping[str, Any]
    places: Mapping[str, str]  # the paths of the files

    def text(self, out: Path, **more: Any) -> str:
        """Return the task as JSON for a worker."""
        places = {**self.places, "out": str(out.resolve())}
        return json.dumps({"key": self.key, "inputs": self.inputs, "places": places, **more})


def tasks_of(plan: SweepPlan, base: Path, options: Options) -> list[Task]:
    """Return the tasks of a plan, dataset by dataset.

    InputError: a dataset or file does not exist, a name is unknown, a value is invalid, or tasks
    are duplicate.
    """
    sources: list[SweepSource | None] = [None]
    if plan.datasets:
        sources = [*sources_of(plan.datasets, base, each_run=plan.each_run)]
    points = points_of(plan, base)
    values_of = [sorted_values({**plan.options, **point}, options, base) for point in points]
    many = len({source and source.name for source in sources}) > 1
    tasks = [
        _task(plan.stage, source, point, values, named=many)
        for source in sources
        for point, values in zip(points, values_of, strict=True)
    ]
    keys = [task.key for task in tasks]
    if len(set(keys)) < len(keys):
        duplicate = Counter(keys).most_common(1)[0][0]
        raise InputError(
            f"duplicate task {duplicate}",
            where="the plan",
            expected="distinct points",
            remedy="remove the repeated value",
        )
    return tasks


def _task(
    stage: str, source: SweepSource | None, point: Row, values: Values, *, named: bool
) -> Task:
    inputs: Row = {"stage": stage, "versions": versions()}
    places = {name: str(path.resolve()) for name, path in values.paths.items()}
    runs: Row = {}
    if source is not None:
        inputs["dataset"] = {"name": source.name, "sha256": source.sha256}
        places["dataset"] = str(source.folder.resolve())
        if source.run is not None:
            runs = {"runs": [source.run]}
    inputs |= values.kinds | {"options": values.kinds["options"] | runs}
    digest = hashlib.sha256(json.dumps(inputs, sort_keys=True).encode()).hexdigest()[:10]
    words = ",".join(_words(source, point, named=named)) or stage
    return Task(f"{words[:LONGEST]}-{digest}", source, point, inputs, places)


def _words(source: SweepSource | None, point: Row, *, named: bool) -> Iterator[str]:
    """Yield the parts of a task's name that identify it, valid in a file name."""
    if source is not None and (named or not (point or source.run)):
        yield _plain(source.name)
    if source is not None and source.run is not None:
        yield _plain(source.run)
    for name, value in point.items():
        text = f"{value:.6g}" if isinstance(value, float) else str(value)
        yield _plain(f"{name}={text}")


def _plain(text: str) -> str:
    return re.sub(r"[^A-Za-z0-9.=+_-]+", "-", text).strip("-.")


def sources_of(names: tuple[str, ...], base: Path, *, each_run: bool) -> list[SweepSource]:
    """Return the datasets of names and patterns, in order; with `each_run` their runs.

    A pattern such as `rigs/*` selects the folders that hold a `dataset.toml`.

    InputError: a folder holds no dataset, or a pattern matches none.
    """
    found: dict[Path, SweepSource] = {}
    for name in names:
        for source in _matching(name, base):
            found.setdefault(source.folder.resolve(), source)  # patterns may overlap
    if not each_run:
        return list(found.values())
    sources = []
    for source in found.values():
        try:
            runs = read_toml(source.folder / MANIFEST_FILE)["run"]
            sources += [replace(source, run=str(run["id"])) for run in runs] or [source]
        except (InputError, KeyError, TypeError):  # the task of the dataset reports the fault
            sources.append(source)
    return sources


def _matching(name: str, base: Path) -> Iterator[SweepSource]:
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
        inside = in_subfolders(folder, (MANIFEST_FILE,))
        raise InputError(
            why_no_dataset(folder),
            where=folder,
            expected="a dataset folder",
            remedy=f"its subfolders are datasets: use '{name}/*'" if inside else "",
        )
    return SweepSource(Path(name).as_posix(), folder, sha256_of(folder / MANIFEST_FILE))
