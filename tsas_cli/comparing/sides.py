"""One side of a comparison: a model file, or the folder of a stage that says something of one."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Literal

from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model
from tsas_cli.identification.model_file import (
    IN_MEMORY,
    model_of,
    read_model,
    read_source,
    recordings_of,
)
from tsas_cli.physics.response import Dynamics
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.validation import parse
from tsas_cli.records.base import DatasetSource, OfDataset, ParameterValue, parameters_of
from tsas_cli.records.calibration import MODEL_FILE, CalibrationFile
from tsas_cli.records.comparison import ParameterPair, ValueDifference
from tsas_cli.records.diagnosis import EXTENDED_MODEL, DiagnosisFile, NamedCause
from tsas_cli.records.simulation import SimulationFile
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import read_json, sha256_of

AnyEstimate = Estimate | ParameterValue
Overlap = Literal["none", "some", "all", "unknown"]
MOST_DECIMALS = 10
FALSE_CLAIMS = 0.05  # of intervals of 95 % that exclude a difference of zero by chance
Kind = Literal["model", "calibration", "diagnosis", "simulation"]
STAGES: tuple[type[OfDataset], ...] = (CalibrationFile, DiagnosisFile, SimulationFile)


@dataclass(frozen=True)
class Side:
    """What is compared, as far as it is there.

    `source` says which recordings were read, None where a model does not say what it was fitted to.
    A simulation does not hold its model.
    """

    path: Path
    kind: Kind
    files: dict[str, str]
    model: Model | None = None
    dynamics: Dynamics = "slip"
    source: DatasetSource | None = None
    diagnosis: DiagnosisFile | None = None
    not_converged: str = ""

    @property
    def model_file(self) -> Path | None:
        """The file of the model, None of a simulation or a model in memory."""
        folder = self.path.parent if self.kind == "model" else self.path
        return next((folder / file for file in self.files if file.endswith(".toml")), None)

    @cached_property
    def _read(self) -> tuple[Dataset | None, str]:
        """The dataset as it was read, with the runs that were; or None, and why."""
        if self.source is None:
            return None, ""
        where = self.path if self.kind == "model" else self.path / next(iter(self.files))
        try:
            dataset = self.source.read(where)
        except InputError as error:
            return None, error.what if error.where == str(where) else error.line()
        dataset, chosen = dataset.under(**self.source.conditions), self.source.chosen
        return (dataset if chosen is None else dataset.only(chosen)), ""

    @property
    def dataset(self) -> Dataset | None:
        """The recordings as they were read, None where they are no longer there."""
        return self._read[0]

    @property
    def gone(self) -> str:
        """Why the recordings are not there."""
        return self._read[1]

    @cached_property
    def recordings(self) -> dict[str, str] | None:
        """The checksum of each recording that was read, by run id; None where it is not said."""
        runs = () if self.dataset is None else self.dataset.runs
        return None if self.source is None else recordings_of(self.source, runs)

    @property
    def named(self) -> tuple[NamedCause, ...]:
        """What a diagnosis names."""
        return () if self.diagnosis is None else self.diagnosis.named

    def has_seen(self, digest: str) -> bool | None:
        """Say whether the fit has read the recording of a checksum; None where that is unknown.

        A simulation does not say it.
        """
        if self.recordings is None or self.kind == "simulation":
            return None
        return digest in self.recordings.values()

    @property
    def effects(self) -> tuple[str, ...]:
        """The effects that the model holds, in the order of its file."""
        groups = [e.name.rpartition(".")[0] for e in self.model.estimates] if self.model else []
        return tuple(dict.fromkeys(group for group in groups if group not in ("", "bristles")))


def read_side(path: Path | Model) -> Side:
    """Read a model file, or a folder that `tsas calibrate`, `diagnose` or `simulate` has written.

    A model in memory is checked like its file.

    InputError: it is neither, more than one of them, or not whole.
    """
    if isinstance(path, Model):
        model = model_of(path)
        return Side(Path(IN_MEMORY), "model", {}, model, _dynamics_of(model))
    if path.is_file():
        return _of_model(path)
    there = [kind for kind in STAGES if (path / kind.FILE).is_file()]
    if not there and (path / MODEL_FILE).is_file():
        return _of_model(path / MODEL_FILE)
    if len(there) != 1:
        files = " and ".join(kind.FILE for kind in there)
        raise InputError(
            f"holds {files}" if there else "nothing that can be compared is here",
            where=path,
            expected=f"a model file, or a folder with one of "
            f"{', '.join(kind.FILE for kind in STAGES)}",
            remedy="give the model file" if there else "",
        )
    return _of_stage(path, there[0])


def _dynamics_of(model: Model) -> Dynamics:
    return "lugre" if any(e.name.startswith("bristles.") for e in model.estimates) else "slip"


def _of_model(path: Path) -> Side:
    model, files = read_model(path), {path.name: sha256_of(path)}
    return Side(path, "model", files, model, _dynamics_of(model), read_source(path))


def _of_stage(path: Path, kind: type[OfDataset]) -> Side:
    file = path / kind.FILE
    stage = parse(kind, read_json(file), file)
    files, source = {kind.FILE: sha256_of(file)}, stage.source()
    if isinstance(stage, SimulationFile):
        return Side(path, "simulation", files, None, stage.dynamics, source)
    name = EXTENDED_MODEL if isinstance(stage, DiagnosisFile) else MODEL_FILE
    model = read_model(path / name)
    files[name] = sha256_of(path / name)
    if isinstance(stage, DiagnosisFile):
        return Side(path, "diagnosis", files, model, source=source, diagnosis=stage)
    assert isinstance(stage, CalibrationFile)  # noqa: S101  the only other kind
    message = "" if stage.fit.converged else stage.fit.message
    return Side(path, "calibration", files, model, stage.dynamics, source, not_converged=message)


def rounded(value: float, low: float, high: float) -> tuple[str, str, str]:
    """Return a value and its interval, cut at the second digit of the interval's half width.

    >>> rounded(0.024987, 0.024969, 0.025005)
    ('0.024987', '0.024969', '0.025005')
    """
    width = (high - low) / 2.0
    decimals = max(1 - math.floor(math.log10(width)), 0) if width > 0.0 else MOST_DECIMALS
    if decimals >= MOST_DECIMALS:
        return f"{value:.4g}", f"{low:.4g}", f"{high:.4g}"
    return f"{value:.{decimals}f}", f"{low:.{decimals}f}", f"{high:.{decimals}f}"


def overlap(a: Side, b: Side) -> Overlap:
    """Say how many of the recordings that the two fits have read are the same, by checksum."""
    if a.recordings is None or b.recordings is None:
        return "unknown"
    first, second = set(a.recordings.values()), set(b.recordings.values())
    if not first & second:
        return "none"
    return "all" if first == second else "some"


def same_runs(a: Mapping[str, str], b: Mapping[str, str]) -> dict[str, str]:
    """Return, by the id in A, the id in B of each recording that both hold, by checksum.

    A recording that one side holds twice goes with the one of the same name, else the first.
    """
    out: dict[str, str] = {}
    for run, digest in a.items():
        there = [other for other, known in b.items() if known == digest]
        free = [other for other in there if other not in out.values()]
        if free:
            out[run] = run if run in free else free[0]
    return out


def pairs(a: Side, b: Side) -> list[ParameterPair]:
    """Return the parameters of two models in the order of A's, then those in B alone.

    What belongs to a run alone is paired where both were fitted to that recording.
    """
    if a.model is None or b.model is None:
        return []
    runs = same_runs(a.recordings or {}, b.recordings or {})
    how = overlap(a, b)
    first, others = (parameters_of(side.estimates) for side in (a.model, b.model))
    second = {(e.name, e.run): e for e in others}
    out = []
    for one in first:
        there = one.run is None or one.run in runs
        other = second.pop((one.name, runs.get(one.run or "")), None) if there else None
        found = None if other is None else _difference(one, other, how)
        out.append(ParameterPair(name=one.name, unit=one.unit, a=one, b=other, difference=found))
    return out + [ParameterPair(name=e.name, unit=e.unit, b=e) for e in second.values()]


def difference(a: AnyEstimate, b: AnyEstimate) -> ValueDifference:
    """Return B less A with its 95 % interval, for estimates whose errors are independent.

    The interval goes as far below as A above and B below in quadrature, and the other way round:
    low = d − √((b − b_low)² + (a_high − a)²), high = d + √((b_high − b)² + (a − a_low)²). For
    symmetric intervals of normal errors that is exact; for others Zou and Donner 2008, Statistics
    in Medicine 27:1693, "recovery of variance estimates".

    ValueError: one of them has no interval.
    """
    ends = a.value, a.interval_low, a.interval_high, b.value, b.interval_low, b.interval_high
    known = [end for end in ends if end is not None]
    if len(known) < len(ends):
        raise ValueError(f"{a.name} has no interval")
    at_a, a_low, a_high, at_b, b_low, b_high = known
    value = at_b - at_a
    low = value - math.hypot(at_b - b_low, a_high - at_a)
    high = value + math.hypot(b_high - at_b, at_a - a_low)
    apart = low > 0.0 or high < 0.0
    return ValueDifference(value=value, low=low, high=high, excludes_zero=apart)


def _difference(a: ParameterValue, b: ParameterValue, how: Overlap) -> ValueDifference | None:
    """Return the difference, with an interval where one may be claimed."""
    why = ""
    if any(e.interval_low is None or e.interval_high is None for e in (a, b)):
        why = "not estimated on both sides"
    elif a.at_bound or b.at_bound:
        why = "at its bound"
    elif how != "none":
        why = "not known to be independent" if how == "unknown" else "the same recordings"
    if a.value is None or b.value is None:
        return None
    return ValueDifference(value=b.value - a.value, why_none=why) if why else difference(a, b)
