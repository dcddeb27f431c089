"""The manifest `dataset.toml` of a dataset, format 1: what it says and how it is checked."""

import tomllib
from datetime import datetime
from pathlib import Path, PurePosixPath
from typing import Any, Literal, TypeVar

import tomlkit
from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator, model_validator

from tsas_cli.errors import InputError, nearest

FILE = "dataset.toml"
Load = Literal["spring", "force", "displacement"]
T = TypeVar("T", bound=BaseModel)


class _Table(BaseModel):
    # A dataset made with any tool must work: keys that we do not know travel along, and
    # `tsas check` names them with the nearest known one.
    model_config = ConfigDict(frozen=True, extra="allow", allow_inf_nan=False)

    def unknown_keys(self) -> dict[str, str]:
        """Return each key that format 1 does not know, with the hint that belongs to it."""
        known = type(self).model_fields
        return {key: nearest(key, known) for key in self.model_extra or {}}


class Rig(_Table):
    """What the data sheet says; every key optional, the unit in the key."""

    tendon_diameter_mm: float | None = Field(default=None, gt=0)
    tendon_modulus_GPa: float | None = Field(default=None, gt=0)
    friction_coefficient: float | None = Field(default=None, ge=0)
    load_stiffness_N_per_mm: float | None = Field(default=None, gt=0)
    turntable_radius_mm: float | None = Field(default=None, gt=0)
    gear_ratio: float | None = Field(default=None, gt=0)
    inertia_N_mm_s2: float | None = Field(default=None, gt=0)
    proximal_length_mm: float | None = Field(default=None, ge=0)
    distal_length_mm: float | None = Field(default=None, ge=0)


class Run(_Table):
    """One run: its file with checksum, and the conditions under which it was recorded."""

    id: str = Field(min_length=1)
    file: str
    sha256: str = Field(pattern=r"^[0-9a-fA-F]{64}$")
    started: datetime | None = None
    sheath_length_mm: float | None = Field(default=None, gt=0)
    total_bend_rad: float | None = Field(default=None, ge=0)
    preload_N: float | None = Field(default=None, ge=0)
    load: Load = "spring"

    @field_validator("file")
    @classmethod
    def _stays_inside(cls, file: str) -> str:
        path = PurePosixPath(file.replace("\\", "/"))
        drive = any(":" in part for part in path.parts[:1])
        if path.is_absolute() or ".." in path.parts or drive:
            raise ValueError("must stay inside the dataset's folder (no '..', no absolute path)")
        return str(path)

    @field_validator("id")
    @classmethod
    def _can_name_a_file(cls, name: str) -> str:
        too_long = len(f"{name}.parquet".encode()) > 255
        bad = name in {".", ".."} or any(c in name for c in "/\\") or not name.isprintable()
        if bad or too_long:
            raise ValueError(
                "must be usable as a file name (no slash, no control character, not too long)"
            )
        return name


class Manifest(_Table):
    """The whole manifest."""

    format: Literal[1]
    name: str
    kind: Literal["measured", "simulated"]
    description: str = ""
    license: str | None = None
    source: str | None = None
    rig: Rig = Rig()
    run: tuple[Run, ...] = Field(min_length=1)
    ingest: dict[str, Any] | None = None  # the files and the map that `tsas ingest` has read

    @property
    def session_start(self) -> datetime | None:
        """When the first run began, or None where not all runs say when they did."""
        started = [run.started for run in self.run if run.started is not None]
        zones = {at.tzinfo is None for at in started}
        return min(started) if len(started) == len(self.run) and len(zones) == 1 else None

    @model_validator(mode="after")
    def _ids_differ(self) -> "Manifest":
        ids = [run.id for run in self.run]
        twice = sorted({i for i in ids if ids.count(i) > 1})
        if twice:
            raise ValueError(f"run id {twice[0]!r} is there twice")
        return self


def read_manifest(folder: Path) -> Manifest:
    """Read and check `dataset.toml` in a folder.

    Raises
    ------
    InputError
        It is missing, is not TOML, or says something that format 1 does not allow.
    """
    path = folder / FILE
    if not path.is_file():
        raise InputError(
            "no dataset.toml here",
            where=folder,
            expected="a dataset folder",
            remedy="make one from your files with `tsas ingest`",
        )
    return parse(Manifest, read_toml(path), path)


def read_toml(path: Path) -> dict[str, Any]:
    """Read a TOML file.

    Raises
    ------
    InputError
        The file cannot be read or is not TOML.
    """
    try:
        return tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", where=path) from error
    except (ValueError, RecursionError) as error:  # not TOML, not text, a number of 5,000 digits
        raise InputError(f"is not TOML ({error})", where=path) from error


def parse(model: type[T], content: dict[str, Any], path: Path) -> T:
    """Validate the content of a file; all that is wrong with it becomes one line.

    Raises
    ------
    InputError
        Something is missing, unknown or not allowed.
    """
    try:
        return model.model_validate(content)
    except ValidationError as error:
        raise InputError(
            "; ".join(_sentence(e, model) for e in error.errors()), where=path
        ) from error


def _sentence(error: Any, model: type[BaseModel]) -> str:
    place = ".".join(str(part) for part in error["loc"])
    if error["type"] == "extra_forbidden":
        return (
            f"unknown key {place} ({nearest(str(error['loc'][-1]), _known(model, error['loc']))})"
        )
    if error["type"] == "missing":
        return f"{place} is missing"
    message = error["msg"].removeprefix("Value error, ")
    message = message[0].lower() + message[1:]
    got = "" if isinstance(error["input"], dict | list) else f", got {error['input']!r}"
    return f"{place}: {message}{got}" if place else message


def _known(model: Any, location: tuple[Any, ...]) -> list[str]:
    """Return the keys that are known at the place of an error, as far as they can be told."""
    for part in location[:-1]:
        field = getattr(model, "model_fields", {}).get(part)
        if field is None:
            continue
        inner = [a for a in getattr(field.annotation, "__args__", ()) if hasattr(a, "model_fields")]
        model = inner[0] if inner else field.annotation
    return list(getattr(model, "model_fields", {}))


def write_manifest(folder: Path, manifest: Manifest) -> None:
    """Write `dataset.toml`; keys that are not set are left out."""
    content = manifest.model_dump(mode="python", exclude_none=True)
    content["run"] = list(content["run"])
    (folder / FILE).write_text(tomlkit.dumps(content), encoding="utf-8")
