"""`model.toml`: a model written, read and checked, and the record of the model that was given."""

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Literal, Self

import tomlkit
from pydantic import Field, model_validator

from tsas_cli.identification.estimate import Estimate, StoredValue, check_value
from tsas_cli.identification.fitted_to import FittedTo
from tsas_cli.identification.model import CORRECTION, Model, data_sheet
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.recordings.dataset import read_from
from tsas_cli.recordings.manifest import MANIFEST_FILE, Manifest, Run, read_toml
from tsas_cli.recordings.session import Session
from tsas_cli.recordings.validation import parse
from tsas_cli.records.base import DatasetSource, Record
from tsas_cli.records.calibration import MODEL_FILE
from tsas_cli.support.errors import InputError, nearest
from tsas_cli.support.plausible import Range
from tsas_cli.support.strict_table import StrictTable

IN_MEMORY = "in memory"  # in place of a file, for a model passed in Python
CORRECTIONS_N = Range(-1e5, 1e5, "N")
LOAD_STIFFNESS = Range(1e-9, 1e9, "N/mm")  # as in a dataset: a drive alone has a load without force
MAY_BE_ZERO = ("friction_coefficient", "preload_N")  # among the positive parameters


def model_of(given: Model | Path) -> Model:
    """Return a model in memory, or that of a file; both are checked alike.

    InputError: as from `read_model`.
    """
    if not isinstance(given, Model):
        return read_model(given)
    values = []
    for e in given.estimates:
        of = "" if e.run is None else f" of run {e.run}"
        content = {name: value for name, value in vars(e).items() if name not in ("name", "run")}
        stored = parse(StoredValue, content, f"the model in memory, {e.name}{of}")
        values.append((e.name, e.run, stored))
    return _checked(values, "the model in memory", given.session)


def model_for(given: Model | Path, runs: Sequence[Run]) -> Model:
    """Return a model, or that of a file, with those values of single runs that belong to these.

    A model that does not say what it was fitted to is taken by the runs' names.

    InputError: as from `read_model`.
    """
    model = model_of(given)
    if isinstance(given, Model) or (source := read_source(given)) is None:
        return model
    read: Sequence[Run] = ()
    with suppress(InputError):
        read = source.read(_file_of(given)).manifest.run
    return model.for_runs(recordings_of(source, read), runs)


def read_source(path: Path) -> DatasetSource | None:
    """Return which recordings a model was fitted to, None where its file does not say it.

    InputError: as from `read_model`, but for the values.
    """
    said = _read(path).dataset
    if "hashes" not in said:
        return None
    return parse(_OfDataset, {"dataset": said}, path).dataset


def recordings_of(source: DatasetSource, runs: Iterable[Run]) -> dict[str, str]:
    """Return the checksum of each recording that was read, by run id.

    `runs` are those of the dataset; without them the ids are those that the files are named after.
    """
    ids = {run.file: run.id for run in runs}
    named = {
        ids.get(file, Path(file).stem): digest.lower()
        for file, digest in source.hashes.items()
        if file != MANIFEST_FILE
    }
    return {run: d for run, d in named.items() if source.chosen is None or run in source.chosen}


def stated_model(manifest: Manifest, given: Model | Path | None) -> Model:
    """Return a model, or that of a file, completed by the manifest's data sheet.

    InputError: as from `read_model`.
    """
    stated = data_sheet(manifest)
    if given is None:
        return stated
    return replace(model_for(given, manifest.run).over(stated), session=stated.session)


def source_of(
    given: object | None, out: Path | None, name: str = MODEL_FILE, *, without: str = "data sheet"
) -> dict[str, str]:
    """Return the record of a stage's given model in `out`: its file and checksum.

    `name` is that of the file in a folder, `without` the entry where none is given. Anything but a
    path is a model in memory.
    """
    if given is None:
        return {"file": without}
    if not isinstance(given, Path):
        return {"file": IN_MEMORY}
    path = given / name if given.is_dir() else given
    return read_from(path, out or Path())


_Value = tuple[str, str | None, StoredValue]  # with its name and its run


class _ModelTables(StrictTable):
    format: Literal[1]
    kind: Literal["model"] = "model"
    version: str = ""
    dataset: dict[str, object] = Field(default_factory=dict)
    session: Session | None = None
    fitted_to: FittedTo | None = None
    parameters: dict[str, StoredValue] = Field(default_factory=dict)
    runs: dict[str, dict[str, StoredValue]] = Field(default_factory=dict)
    bristles: dict[str, StoredValue] = Field(default_factory=dict)
    effects: dict[str, dict[str, StoredValue]] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _effects_have_parameters(self) -> Self:
        for name, values in self.effects.items():
            if not values:
                raise ValueError(f"effects.{name} has no parameter: give one or delete the table")
        return self

    @model_validator(mode="after")
    def _session_is_in_order(self) -> Self:
        if self.session is not None and not self.session.goes_on_at(self.session.last):
            raise ValueError("session ends before it begins, or one of both has a time zone")
        return self


class _OfDataset(Record):
    dataset: DatasetSource


def write_model(
    path: Path,
    model: Model,
    *,
    version: str,
    dataset: Mapping[str, object],
    fitted_to: FittedTo | None = None,
) -> None:
    """Write `model.toml`, with the recordings that the model was fitted to and their ranges."""
    file = _ModelTables(
        format=1,
        version=version,
        dataset=dict(dataset),
        session=model.session,
        fitted_to=fitted_to,
    )
    for e in model.estimates:
        entry = StoredValue.model_validate(e, from_attributes=True)
        group, _, name = e.name.rpartition(".")
        if group == "bristles":
            file.bristles[name] = entry
        elif group:
            file.effects.setdefault(group, {})[name] = entry
        elif e.run is None:
            file.parameters[e.name] = entry
        else:
            file.runs.setdefault(e.run, {})[e.name] = entry
    without = None if file.bristles else {"bristles"}
    content = file.model_dump(exclude_none=True, exclude=without)
    path.write_text(tomlkit.dumps(content), encoding="utf-8")


def read_model(path: Path) -> Model:
    """Return the model of a `model.toml` or `model-extended.toml`.

    InputError: the file is missing, not TOML, of another format, or has an unknown or duplicate
    parameter, one of a single run that all runs share, one for all runs and for a single one, or an
    implausible value.
    """
    file = _read(path)
    values: list[_Value] = []
    values += [(name, None, v) for name, v in file.parameters.items()]
    values += [(name, run, v) for run, named in file.runs.items() for name, v in named.items()]
    values += [(f"bristles.{name}", None, v) for name, v in file.bristles.items()]
    values += [
        (f"{effect}.{name}", None, v)
        for effect, named in file.effects.items()
        for name, v in named.items()
    ]
    where = _file_of(path)
    for_all = {name for name, run, _ in values if run is None}
    for name, run, _ in values:  # a sweep may set both
        if run is not None and name in for_all:
            raise InputError(
                f"{name} is given for all runs and for run {run}",
                where=where,
                expected="one of both",
                remedy="delete the value that does not hold",
            )
    return _checked(values, where, file.session)


def read_fitted_to(path: Path) -> FittedTo | None:
    """Return the ranges of what a model was fitted to, None where its file does not say them.

    InputError: as from `read_model`, but for the values.
    """
    return _read(path).fitted_to


def _file_of(path: Path) -> Path:
    """Return a model's file, that in a folder where the path is one."""
    if not path.is_dir():
        return path
    if (path / MODEL_FILE).exists():
        return path / MODEL_FILE
    models = sorted(file.name for file in path.glob("model*.toml"))
    raise InputError(
        f"holds no {MODEL_FILE}",
        where=path,
        remedy=f"name one of its models: {', '.join(models)}"
        if models
        else "give a model file, or a folder that `tsas calibrate` has written",
    )


def _read(path: Path) -> _ModelTables:
    path = _file_of(path)
    return parse(_ModelTables, read_toml(path), path)


def _checked(values: Sequence[_Value], where: object, session: Session | None) -> Model:
    """Return the model of these values, each with its name and its run, if they can be."""
    ranges = {
        name: Range(q.lower, q.upper, q.unit, or_zero=name in MAY_BE_ZERO)
        for name, q in QUANTITIES.items()
    } | {CORRECTION: CORRECTIONS_N, "load_stiffness_N_per_mm": LOAD_STIFFNESS}
    seen: set[tuple[str, str | None]] = set()
    for name, run, value in values:
        if name not in ranges:
            known = [other for other in ranges if ("." in other) == ("." in name)]
            raise InputError(f"unknown parameter {name}", where=where, remedy=nearest(name, known))
        if run is not None and ("." in name or name == CORRECTION):
            raise InputError(
                f"{name} belongs to run {run}",
                where=where,
                expected=f"one {name} for all runs",
                remedy="simulate the runs with a model each",
            )
        if (name, run) in seen:
            raise InputError(f"duplicate parameter {name}", where=where)
        seen.add((name, run))
        check_value(name, value, ranges[name], where)
    return Model(
        tuple(Estimate(name=name, run=run, **value.model_dump()) for name, run, value in values),
        session,
    )
