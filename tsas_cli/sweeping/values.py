"""The named values of a task, sorted by kind: option, model, plant, condition, setting."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError

from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.recordings.dataset import CONDITIONS
from tsas_cli.recordings.manifest import Run, read_toml
from tsas_cli.recordings.validation import parse
from tsas_cli.records.calibration import MODEL_FILE
from tsas_cli.records.drive import DRIVE_FILE
from tsas_cli.support.errors import InputError, nearest
from tsas_cli.support.files import Raw, sha256_of
from tsas_cli.support.plausible import Range
from tsas_cli.tracking.settings import RigSettings, read_settings

KINDS = ("options", "files", "conditions", "settings", "model", "plant")
PLANT, SETTINGS = "plant.", "settings."
FILES = {"model": MODEL_FILE, "plant": MODEL_FILE, "drive": DRIVE_FILE, "settings": ""}
BITS = 64  # of an integer, the limit of Parquet and TOML
_ANY_RUN = {"id": "x", "file": "x", "sha256": "0" * 64}  # for the validation of conditions

Options = Mapping[str, TypeAdapter[Any]]


@dataclass(frozen=True)
class Values:
    """The values of one task by kind, and the paths of the files among them.

    The kinds are those of a task's inputs: `options`, keywords of the stage's call; `files`, the
    checksums of those that are files; `model` and `plant`, which replace values of their file or
    of the data sheet; `conditions`, which replace those of every run in the manifest; `settings` of
    the closed loop, by dotted keys.
    """

    kinds: dict[str, Raw]
    paths: dict[str, Path]


def sorted_values(given: Mapping[str, Any], options: Options, base: Path) -> Values:
    """Return the named values of a task by kind; their paths are relative to `base`.

    `options` holds the type of each keyword of the stage's call.

    InputError: a name is unknown, a value is invalid, or a file does not exist.
    """
    kinds: dict[str, Raw] = {kind: {} for kind in KINDS}
    paths, of_runs = dict[str, Path](), "model" in options and "plant" not in options
    for name, value in given.items():
        if isinstance(value, int) and value.bit_length() >= BITS:
            raise InputError(
                f"{name} is an integer of {value.bit_length() + 1} bits",
                where="the plan",
                expected=f"at most {BITS}, as in TOML",
            )
        if name in FILES and name in options:
            paths[name], kinds["files"][name] = _file(name, value, base)
        elif name in options:
            kinds["options"][name] = _option(name, value, options[name])
        elif name in CONDITIONS and of_runs:
            kinds["conditions"][name] = number = _number(name, value)
            parse(
                Run, _ANY_RUN | {name: number}, "the plan"
            )  # which refuses what a manifest may not
            if name in QUANTITIES:  # a calibrated model has a preload of each run
                kinds["model"][name] = _quantity(name, value, name)
        elif name in QUANTITIES and "model" in options:
            kinds["model"][name] = _quantity(name, value, name)
        elif name.removeprefix(PLANT) in QUANTITIES and "plant" in options:
            own = name.removeprefix(PLANT)
            kinds["plant"][own] = _quantity(name, value, own)
        elif name.startswith(SETTINGS) and "settings" in options:
            kinds["settings"][name.removeprefix(SETTINGS)] = value
        else:
            raise InputError(f"unknown name {name}", where="the plan", remedy=_hint(name, options))
    if kinds["settings"]:
        read_settings(with_settings(paths.get("settings"), kinds["settings"]))
    reference = kinds["options"].get("reference")
    if isinstance(reference, str) and (base / reference).is_file():
        del kinds["options"]["reference"]
        paths["reference"], kinds["files"]["reference"] = _file("reference", reference, base)
    return Values(kinds, paths)


def _hint(name: str, options: Options) -> str:
    """Return a hint with the nearest name that a stage with such options knows."""
    if "settings" in options and name in RigSettings.model_fields:
        return f"did you mean {SETTINGS}rig.{name}?"
    known = list(options)
    if "model" not in options:
        return nearest(name, known)
    known += [*QUANTITIES, *(() if "plant" in options else CONDITIONS)]
    of_models = "and the parameters of a model: see `tsas effects`"
    hint = nearest(name, known)
    return hint if hint.startswith("did") else f"{nearest('', options)}, {of_models}"


def _option(name: str, value: Any, allowed: TypeAdapter[Any]) -> Any:
    try:
        allowed.validate_python(value, strict=True)
    except ValidationError as error:
        message = error.errors()[0]["msg"]
        raise InputError(
            f"{name} is {value!r}", where="the plan", expected=message[0].lower() + message[1:]
        ) from error
    return value


def _file(name: str, value: Any, base: Path) -> tuple[Path, dict[str, str]]:
    """Return the path of a file, or of its default name in a folder, and its checksum record."""
    if not isinstance(value, str):
        raise InputError(f"{name} is {value!r}", where="the plan", expected="a file's path")
    path = base / value
    file = path / FILES[name] if path.is_dir() and FILES[name] else path
    if not file.is_file():
        raise InputError("does not exist", where=file, expected=f"the file of {name}")
    return file, {"file": value, "sha256": sha256_of(file)}


def _quantity(label: str, value: Any, name: str) -> float:
    """Return the value of a model's quantity, within its bounds."""
    number, quantity = _number(label, value), QUANTITIES[name]
    if not quantity.lower <= number <= quantity.upper:
        raise InputError(
            f"{label} is {number:g}",
            where="the plan",
            expected=str(Range(quantity.lower, quantity.upper, quantity.unit)),
        )
    return number


def _number(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"{name} is {value!r}", where="the plan", expected="a number")
    if not math.isfinite(value):
        raise InputError(f"{name} is {value}", where="the plan", expected="a finite number")
    return float(value)


def with_settings(path: Path | None, changes: Mapping[str, Any]) -> Raw:
    """Return the content of a settings file, or of none, with some dotted keys replaced.

    InputError: the file cannot be read, or a part of a dotted key is no table.
    """
    content = {} if path is None else read_toml(path)
    for key, value in changes.items():
        *tables, last = key.split(".")
        inner = content
        for table in tables:
            inner = inner.setdefault(table, {})
            if not isinstance(inner, dict):
                raise InputError(f"{table} of settings.{key} is no table", where="the plan")
        inner[last] = value
    return content
