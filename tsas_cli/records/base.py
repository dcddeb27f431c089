"""What the stages' JSON files have in common; a file is written and read by the same class.

A number that is not finite becomes None, as JSON has none; what a file holds beyond these fields
is left alone (docs/formats.md).
"""

import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    SerializerFunctionWrapHandler,
    ValidationInfo,
    model_serializer,
    model_validator,
)

from tsas_cli.recordings.dataset import Dataset, read_dataset
from tsas_cli.recordings.manifest import MANIFEST_FILE
from tsas_cli.recordings.quality.finding import Finding
from tsas_cli.recordings.storage import Location, recorded_location
from tsas_cli.support import __version__
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import write_json
from tsas_cli.support.wording import count_of, listed

TWO_SIDED = 1.96  # standard errors on each side of a 95 % interval
_MOST_LISTED = 4  # runs by name; of more, their number
_ROUNDING = 1e-9  # relative, of a value at the end of its interval


def number_text(value: float | None, form: str = ".3g") -> str:
    """Return a number for a table or a sentence, without an exponent; nothing where there is none.

    A small one keeps its exponent: 12400, 0.00321, 3.2e-05.
    """
    text = "" if value is None else f"{value:{form}}"
    return f"{float(text):.0f}" if "e+0" in text else text


def span_text(values: Iterable[float | None]) -> str:
    """Return the lowest and the highest of the known values, or the one that both are.

    >>> span_text([0.5, None, 1.25]), span_text([0.5]), span_text([None])
    ('0.5 to 1.25', '0.5', '')
    """
    known = [value for value in values if value is not None]
    ends = (min(known), max(known)) if known else ()
    return " to ".join(dict.fromkeys(map(number_text, ends)))


def check_interval(value: float | None, low: float | None, high: float | None) -> None:
    """Raise ValueError for an interval with one end, with swapped ends, or without its value."""
    if (low is None) != (high is None):
        raise ValueError("interval_low and interval_high go together")
    if low is not None and high is not None and low > high:
        raise ValueError(f"interval_low {low:g} is above interval_high {high:g}")
    if value is None or low is None or high is None:
        return
    if not low - _ROUNDING * abs(low) <= value <= high + _ROUNDING * abs(high):
        raise ValueError(
            f"value {value:g} lies outside of its interval, {low:g} to {high:g}; "
            "a value that is set by hand has no interval_low, interval_high and stderr"
        )


def value_text(
    value: float | None, ends: tuple[float | None, float | None], *, at_bound: bool, origin: str
) -> str:
    """Return a value and the ends of its interval for a printed table; without these its origin."""
    low, high = ends
    if value is None or low is None or high is None:
        return f"{number_text(value, '.5g')} ({origin})"
    return f"{value:.5g} [{low:.5g}, {high:.5g}]{'  AT BOUND' if at_bound else ''}"


def _none_if_not_finite(value: Any, info: ValidationInfo) -> Any:
    """Return None for a number that is not finite; in a file such a number is an error."""
    made = isinstance(value, float) and not (info.context or {}).get("file")
    return None if made and not math.isfinite(value) else value


Number = Annotated[float | None, BeforeValidator(_none_if_not_finite)]
NotNegative = Annotated[Annotated[float, Field(ge=0)] | None, BeforeValidator(_none_if_not_finite)]


class Record(BaseModel):
    """A part of what a stage has found; the keys in `SPARSE` are left out where they are empty."""

    model_config = ConfigDict(
        frozen=True, extra="ignore", allow_inf_nan=False, populate_by_name=True
    )
    SPARSE: ClassVar[frozenset[str]] = frozenset()

    def content(self) -> dict[str, Any]:
        """Return what JSON holds of it."""
        return self.model_dump(mode="json", by_alias=True)

    @model_serializer(mode="wrap")
    def _without_what_is_empty(self, dump: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return {key: v for key, v in dump(self).items() if v or key not in self.SPARSE}


class DatasetSource(Record):
    """The recordings that were read: their dataset, where it was, and which of its runs.

    `folder` is relative to that of the file; `chosen` are the runs, None where it is all;
    `conditions` are values given in place of the manifest's.
    """

    SPARSE = frozenset({"chosen", "conditions"})
    name: str
    folder: str = ""
    hashes: dict[str, str]
    chosen: tuple[str, ...] | None = None
    conditions: dict[str, float] = {}

    def found(self, where: Path) -> Location:
        """Return the dataset's folder, as the file `where` says it.

        InputError: there is no dataset any more.
        """
        folder = recorded_location(where.parent, self.folder)
        if not self.folder or not (folder / MANIFEST_FILE).is_file():
            raise InputError(
                f"the dataset {self.name} is no longer at {folder}",
                where=where,
                expected=f"a folder with {MANIFEST_FILE}",
                remedy="give the dataset's folder too",
            )
        return folder

    def read(self, where: Path) -> Dataset:
        """Return the dataset as it was read by the stage that wrote the file `where`.

        InputError: there is none any more, or it has changed.
        """
        dataset = read_dataset(self.found(where))
        self.check(dataset, where)
        return dataset

    def check(self, dataset: Dataset, where: Path) -> None:
        """Refuse a dataset that has changed since the stage that wrote `where` has read it."""
        now = dataset.hashes()
        for file in sorted(now.keys() | self.hashes.keys()):
            if now.get(file, "").lower() != self.hashes.get(file, "").lower():
                raise InputError(
                    f"{file} of {dataset.folder} has changed since this stage read it",
                    where=where,
                    expected=f"SHA-256 {self.hashes[file]}"
                    if file in self.hashes
                    else "no such file",
                    remedy="run the stage again, or give the dataset that it has read",
                )


class StageFile(Record):
    """The fields of every stage's file; `FILE` is its name."""

    FILE: ClassVar[str]
    format: Literal[1] = 1
    stage: str
    version: str = __version__

    def write(self, folder: Path) -> None:
        """Write it into the folder of its stage."""
        write_json(folder / self.FILE, self.content())


class OfDataset(StageFile):
    """The file of a stage that reads a dataset; `chosen` and `conditions` as in `DatasetSource`.

    `despite` are the errors in the recordings that were accepted, `warnings` what the checks warn
    of.
    """

    SPARSE = DatasetSource.SPARSE | {"despite", "warnings"}
    dataset: DatasetSource
    chosen: tuple[str, ...] | None = None
    conditions: dict[str, float] = {}
    despite: tuple[Finding, ...] = ()
    warnings: tuple[Finding, ...] = ()

    def accepted(self) -> list[str]:
        """Return a sentence for each kind of error in the recordings that was accepted."""
        return _sentences("Despite an error in", self.despite)

    def warned(self) -> list[str]:
        """Return a sentence for each kind of warning of the checks."""
        return _sentences("The checks warn of", self.warnings)

    def source(self) -> DatasetSource:
        """Return the recordings as a model file names them."""
        stated = {"chosen": self.chosen, "conditions": self.conditions}
        return self.dataset.model_copy(update=stated)


def _sentences(opening: str, findings: Sequence[Finding]) -> list[str]:
    kinds: dict[tuple[str, str | None], list[Finding]] = {}
    for one in findings:
        kinds.setdefault((one.code, one.column), []).append(one)
    sentences = []
    for (code, _), alike in kinds.items():
        runs = [f"run {one.run}" if one.run else "the manifest" for one in alike]
        each = list(dict.fromkeys(runs))
        same = len({one.sentence for one in alike}) == 1
        where = _named(each) if same else each[0]
        others = "" if same or len(each) < 2 else f"; others of the kind in {_named(each[1:])}"
        sentences.append(f"{opening} {where}: {alike[0].sentence} (`{code}`){others}.")
    return sentences


def _named(runs: Sequence[str]) -> str:
    """Return a few runs by name, of more their number."""
    return listed(runs) if len(runs) <= _MOST_LISTED else count_of(len(runs), "run")


class ModelFile(Record):
    """The model that a stage has read: its file and checksum, None for the data sheet's model."""

    SPARSE = frozenset({"folder", "sha256"})
    file: str
    folder: str | None = None
    sha256: str | None = None


class PhaseSegment(Record):
    """A stretch of one run that is in one phase, from `start_s` up to and with `end_s`."""

    start_s: float
    end_s: float
    phase: str


class Value(Record):
    """A number with its unit, its standard error and 95 % interval; None where it has none."""

    value: Number
    stderr: NotNegative = None
    interval_low: Number = None
    interval_high: Number = None
    unit: str
    at_bound: bool = False

    @model_validator(mode="after")
    def _interval_has_two_ends(self) -> Self:
        check_interval(self.value, self.interval_low, self.interval_high)
        return self

    origin: str = Field(default="fitted", exclude=True)

    def text(self) -> str:
        """Return value and interval for a printed table; where there is none, its origin."""
        ends = self.interval_low, self.interval_high
        return value_text(self.value, ends, at_bound=self.at_bound, origin=self.origin)

    @property
    def interval(self) -> tuple[float, float] | None:
        """The 95 % interval, from the standard error where no ends are given."""
        if self.interval_low is not None and self.interval_high is not None:
            return self.interval_low, self.interval_high
        if self.stderr is None or self.value is None:
            return None
        half = TWO_SIDED * self.stderr
        return self.value - half, self.value + half


class ParameterValue(Value):
    """A value with its name, its run where it belongs to one, and where it is from."""

    name: str
    run: str | None = None
    origin: str


def parameters_of(estimates: Iterable[object]) -> tuple[ParameterValue, ...]:
    """Return estimates as the files hold them."""
    return tuple(ParameterValue.model_validate(e, from_attributes=True) for e in estimates)


class Fit(Record):
    """How a joint fit ended."""

    converged: bool
    message: str = ""
    evaluations: int = 0


class Evidence(Record):
    """How a diagnosis judged: what was held out, of how many runs, in how many blocks."""

    held_out: str = ""
    blocks: int = 0
    runs: int = 0
    sentence: str = ""
