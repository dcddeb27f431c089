"""The plan of a sweep: its stage, datasets, varied values and common options."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, get_args

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from tsas_cli.recordings.manifest import parse, read_toml
from tsas_cli.support.files import Raw
from tsas_cli.support.strict_table import StrictTable

StageName = Literal["check", "calibrate", "simulate", "diagnose", "track"]
STAGES: tuple[StageName, ...] = get_args(StageName)
MOST_STEPS = 100_000


def _listed(value: object) -> object:
    return [value] if isinstance(value, str) else value


class ValueRange(StrictTable):
    """Equally spaced values, or values of equal ratio with `scale = "log"`, including both ends."""

    first: float = Field(alias="from")
    last: float = Field(alias="to")
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


Axis = Annotated[tuple[Any, ...], Field(min_length=1)] | ValueRange


class SweepPlan(StrictTable):
    """The whole plan."""

    format: Literal[1] = 1
    kind: Literal["sweep"] = "sweep"
    stage: StageName
    datasets: Annotated[tuple[str, ...], BeforeValidator(_listed)] = ()
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

    Raises
    ------
    InputError
        The plan cannot be read, or a key is unknown or invalid.
    """
    if isinstance(given, Path):
        return parse(SweepPlan, read_toml(given), given), given.parent
    return parse(SweepPlan, dict(given), "the plan"), Path()
