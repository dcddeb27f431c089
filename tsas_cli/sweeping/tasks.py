"""The tasks of a sweep: each with what it is told, and a name that changes when that does."""

import hashlib
import json
import re
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tsas_cli.support.errors import InputError
from tsas_cli.sweeping.answer import Row
from tsas_cli.sweeping.plan import Plan
from tsas_cli.sweeping.points import points_of
from tsas_cli.sweeping.sources import Source, sources_of
from tsas_cli.sweeping.values import Options, Values, sorted_values
from tsas_cli.sweeping.versions import versions

FILE = "task.json"  # in each task's folder: what it was told and what came out
LONGEST = 100  # characters of the part of a name that is for people


@dataclass(frozen=True)
class Task:
    """One call of a stage.

    Attributes
    ----------
    key
        Its name: what is special about it, and a digest of all that its result depends on.
    source
        The dataset or run, None where the stage takes none.
    point
        The values that are varied.
    inputs
        All that its result depends on, as plain data; files by their checksums.
    places
        Where the files are.
    """

    key: str
    source: Source | None
    point: Row
    inputs: Mapping[str, Any]
    places: Mapping[str, str]

    def text(self, out: Path, **more: Any) -> str:
        """Return the task as the text that a worker gets."""
        places = {**self.places, "out": str(out.resolve())}
        return json.dumps({"key": self.key, "inputs": self.inputs, "places": places, **more})


def tasks_of(plan: Plan, base: Path, options: Options) -> list[Task]:
    """Return the tasks of a plan, dataset by dataset.

    Raises
    ------
    InputError
        A dataset or file is not there, a name is unknown, a value is not allowed, or two tasks are
        the same.
    """
    sources: list[Source | None] = [None]
    if plan.datasets:
        sources = [*sources_of(plan.datasets, base, each_run=plan.each_run)]
    points = points_of(plan, base)
    told = [sorted_values({**plan.options, **point}, options, base) for point in points]
    many = len({source and source.name for source in sources}) > 1
    tasks = [
        _task(plan.stage, source, point, values, named=many)
        for source in sources
        for point, values in zip(points, told, strict=True)
    ]
    keys = [task.key for task in tasks]
    if len(set(keys)) < len(keys):
        twice = Counter(keys).most_common(1)[0][0]
        raise InputError(
            f"{twice} is there twice",
            where="the plan",
            expected="points that differ",
            remedy="take out the value that is repeated",
        )
    return tasks


def _task(stage: str, source: Source | None, point: Row, values: Values, *, named: bool) -> Task:
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


def _words(source: Source | None, point: Row, *, named: bool) -> Iterator[str]:
    """Yield what tells a task from others, fit for a file's name."""
    if source is not None and (named or not (point or source.run)):
        yield _plain(source.name)
    if source is not None and source.run is not None:
        yield _plain(source.run)
    for name, value in point.items():
        text = f"{value:.6g}" if isinstance(value, float) else str(value)
        yield _plain(f"{name}={text}")


def _plain(text: str) -> str:
    return re.sub(r"[^A-Za-z0-9.=+_-]+", "-", text).strip("-.")
