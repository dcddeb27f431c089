"""The plan of a sweep: its stage, datasets, common options, and the varied values of each task."""

import itertools
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, get_args

import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet
from pydantic import Discriminator, Field, Tag, model_validator

from tsas_cli.recordings.manifest import read_toml
from tsas_cli.recordings.validation import parse
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import Raw
from tsas_cli.support.plausible import AnyNumber
from tsas_cli.support.strict_table import StrictTable, Texts
from tsas_cli.support.wording import count_of
from tsas_cli.sweeping.outcome import Row

StageName = Literal["check", "calibrate", "simulate", "diagnose", "track"]
STAGES: tuple[StageName, ...] = get_args(StageName)
MOST_STEPS = 100_000


class ValueRange(StrictTable):
    """Equally spaced values, or values of equal ratio with `scale = "log"`, including both ends."""

    first: AnyNumber = Field(alias="from")
    last: AnyNumber = Field(alias="to")
    steps: int = Field(ge=2, le=MOST_STEPS)
    scale: Literal["linear", "log"] = "linear"

    @model_validator(mode="after")
    def _has_logarithms(self) -> "ValueRange":
        if self.scale == "log" and min(self.first, self.last) <= 0.0:
            raise ValueError("a log scale needs positive ends")
        return self

    def values(self) -> list[float]:
        """Return the values in order; the ends are exact."""
        space = np.linspace if self.scale == "linear" else np.geomspace
        return [float(value) for value in space(self.first, self.last, self.steps)]


Axis = Annotated[
    Annotated[tuple[Any, ...], Field(min_length=1), Tag("list")]
    | Annotated[ValueRange, Tag("range")],
    # Else an error is said of both forms.
    Discriminator(lambda value: "range" if isinstance(value, dict | ValueRange) else "list"),
]


class SweepPlan(StrictTable):
    """The whole plan."""

    format: Literal[1] = 1
    kind: Literal["sweep"] = "sweep"
    stage: StageName
    datasets: Texts = ()
    each_run: bool = False
    options: Raw = Field(default_factory=dict)
    vary: dict[str, Axis] = Field(default_factory=dict)
    combine: Literal["grid", "zip"] = "grid"
    sets: str | None = None

    @model_validator(mode="after")
    def _goes_together(self) -> "SweepPlan":
        if self.stage == "track" and (self.datasets or self.each_run):
            raise ValueError("track has no datasets")
        if self.stage != "track" and not self.datasets:
            raise ValueError(f"datasets is missing: {self.stage} needs at least one")
        lengths = {name: len(axis) for name, axis in self.axes().items()}
        if self.combine == "zip" and len(set(lengths.values())) > 1:
            listed = ", ".join(f"{name} {n}" for name, n in lengths.items())
            raise ValueError(f"lists to be zipped differ in length: {listed}")
        if self.each_run and "runs" in {**self.options, **self.vary}:
            raise ValueError("each_run makes one task per run: leave out runs")
        for name in self.vary:
            if name in self.options:
                raise ValueError(f"{name} is in options and in vary")
        return self

    def axes(self) -> dict[str, list[Any]]:
        """Return the values of each axis."""
        return {
            name: axis.values() if isinstance(axis, ValueRange) else list(axis)
            for name, axis in self.vary.items()
        }


def read_plan(given: Path | Mapping[str, Any]) -> tuple[SweepPlan, Path]:
    """Return a plan, from its file or its content, and the folder of its relative paths.

    InputError: the plan cannot be read, or a key is unknown or invalid.
    """
    if isinstance(given, Path):
        return parse(SweepPlan, read_toml(given), given), given.parent
    return parse(SweepPlan, dict(given), "the plan"), Path()


MOST_TASKS = 1_000_000


def points_of(plan: SweepPlan, base: Path) -> list[Row]:
    """Return the values of every task by name; one empty point without variation.

    The last axis varies fastest. Each row of the table is combined with every point of the axes.

    InputError: the table cannot be read, shares a name with an axis or option, or the points are
    too many.
    """
    axes = plan.axes()
    sets = [Row()] if plan.sets is None else _sets(base / plan.sets)
    for name in {name for row in sets for name in row}:
        if name in axes or name in plan.options:
            raise InputError(f"{name} is in the plan and in {plan.sets}", where="the plan")
    lengths = [len(values) for values in axes.values()]
    count = (min(lengths, default=1) if plan.combine == "zip" else math.prod(lengths)) * len(sets)
    if count > MOST_TASKS:
        raise InputError(f"{count} points", where="the plan", expected=f"at most {MOST_TASKS}")
    together = zip(*axes.values(), strict=True) if axes and plan.combine == "zip" else None
    rows = list(together or itertools.product(*axes.values()))
    return [row | dict(zip(axes, values, strict=True)) for row in sets for values in rows]


def _sets(path: Path) -> list[Row]:
    """Return the rows of a table of parameter sets; empty cells are left out."""
    try:
        if path.suffix.lower() == ".csv":
            options = pa.csv.ConvertOptions(null_values=[""], strings_can_be_null=True)
            table = pa.csv.read_csv(path, convert_options=options)
        else:
            table = pa.parquet.ParquetFile(path).read()
    except (pa.ArrowException, OSError) as error:
        reason = str(error).splitlines()[0]
        raise InputError(
            f"cannot be read ({reason})", where=path, expected="a table as CSV or Parquet"
        ) from error
    if len(set(table.column_names)) < len(table.column_names):
        raise InputError("duplicate column", where=path)
    if not 0 < table.num_rows <= MOST_TASKS:
        raise InputError(count_of(table.num_rows, "row"), where=path, expected=f"1 to {MOST_TASKS}")
    return [{k: v for k, v in row.items() if v is not None} for row in table.to_pylist()]
