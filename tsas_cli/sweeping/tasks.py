"""The tasks of a sweep: each with its inputs, and a name that depends on all of them."""

import hashlib
import json
import re
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tsas_cli.support.errors import InputError
from tsas_cli.sweeping.outcome import Row
from tsas_cli.sweeping.plan import SweepPlan, points_of
from tsas_cli.sweeping.sources import SweepSource, sources_of
from tsas_cli.sweeping.values import Options, Values, sorted_values
from tsas_cli.sweeping.versions import versions

TASK_FILE = "task.json"  # in each task's folder: its inputs and results
LONGEST = 100  # characters of the readable part of a name


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
    options = dict(values.options)
    inputs: Row = {"stage": stage, "versions": versions()}
    places = {name: str(path.resolve()) for name, path in values.files.items()}
    if source is not None:
        inputs["dataset"] = {"name": source.name, "sha256": source.sha256}
        places["dataset"] = str(source.folder.resolve())
        if source.run is not None:
            options["runs"] = [source.run]
    inputs |= {"options": options, "files": values.sums}
    inputs |= {"conditions": values.conditions, "settings": values.settings}
    inputs |= {"model": values.model, "plant": values.plant}
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
