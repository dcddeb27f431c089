"""The manifest `dataset.toml` of a dataset, format 1: what it says and how it is checked."""

import re
import tomllib
from collections import Counter
from collections.abc import Iterator
from datetime import date, datetime
from pathlib import Path, PurePosixPath
from typing import Annotated, Any, Literal, Self, TypeVar

import tomlkit
from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationError,
    field_validator,
    model_validator,
)

from tsas_cli.recordings.run_names import beside, check_run_name
from tsas_cli.recordings.storage import Address, Place, check_inside
from tsas_cli.support import limits
from tsas_cli.support.errors import InputError, nearest
from tsas_cli.support.files import Raw

FILE = "dataset.toml"
Load = Literal["spring", "force", "displacement"]
T = TypeVar("T", bound=BaseModel)
_SAID = 5  # of what is wrong with a file; the rest is counted
_SHOWN = 80  # characters of a value that is wrong
_PATH = 1000  # characters of a path in the dataset


def _as_date(value: object) -> object:
    """Return what is a date, or begins like one in ISO 8601; Pydantic takes numbers for seconds."""
    if isinstance(value, str):
        value = re.sub(r"^(\d{4})(\d\d)(\d\d)(?!\d)", r"\1-\2-\3", value)
        if re.match(r"\d{4}-\d\d-\d\d", value):
            return value
    elif isinstance(value, date):
        return value
    raise ValueError("is no date such as 2026-03-02 or 2026-03-02T09:30:00Z")


class _Table(BaseModel):
    # A dataset made with any tool must work: keys that we do not know travel along, and
    # `tsas check` names them with the nearest known one.
    model_config = ConfigDict(frozen=True, extra="allow", allow_inf_nan=False)

    @model_validator(mode="after")
    def _is_no_flood(self) -> Self:
        unknown = len(self.model_extra or {})
        if unknown > limits.UNKNOWN_KEYS:
            raise ValueError(
                f"{unknown} keys are unknown, at most {limits.UNKNOWN_KEYS} may travel along"
            )
        return self

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
    started: Annotated[datetime, BeforeValidator(_as_date)] | None = None
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
        if len(file) > _PATH or any(len(part.encode()) > 255 for part in path.parts):
            raise ValueError("is too long for a file's name")
        return str(path)

    @field_validator("id")
    @classmethod
    def _can_name_a_file(cls, name: str) -> str:
        check_run_name(name)
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
    ingest: dict[str, object] | None = None  # the files and the map that `tsas ingest` has read

    @property
    def session_start(self) -> datetime | None:
        """When the first run began, or None where not all runs say when they did."""
        started = [run.started for run in self.run if run.started is not None]
        zones = {at.tzinfo is None for at in started}
        return min(started) if len(started) == len(self.run) and len(zones) == 1 else None

    @model_validator(mode="after")
    def _ids_differ(self) -> "Manifest":
        if len(self.run) > limits.RUNS:
            raise ValueError(
                f"{len(self.run)} runs, at most {limits.RUNS} in one dataset; make several of it"
            )
        names = Counter(run.id for run in self.run)
        twice = [name for name, count in names.items() if count > 1]
        if twice:
            raise ValueError(f"run id {twice[0]!r} is there twice")
        alike = beside(names)
        if alike:
            raise ValueError(
                f"run ids {alike[0]!r} and {alike[1]!r} name one file on Windows and macOS"
            )
        return self


def read_manifest(folder: Place) -> Manifest:
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
    check_inside(path, folder)
    return parse(Manifest, read_toml(path), path)


def read_toml(path: Place) -> Raw:
    """Read a TOML file.

    Raises
    ------
    InputError
        The file cannot be read, is not TOML, or exceeds a limit.
    """
    try:
        text = (
            limits.decoded(path.read_bytes(0, limits.TOML_BYTES + 1), path, limits.TOML_BYTES)
            if isinstance(path, Address)
            else limits.text_of(path, limits.TOML_BYTES)
        )
        limits.toml(text, path)
        content = tomllib.loads(text)
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", where=path) from error
    except RecursionError as error:
        raise limits.too_deep(path) from error
    except ValueError as error:  # of TOML, of text, or of an integer without end
        raise InputError(f"is not TOML ({limits.reason(error)})", where=path) from error
    limits.depth(content, path)
    return content


def parse(model: type[T], content: Raw, path: object) -> T:
    """Validate the content of a file; all that is wrong with it becomes one line.

    Raises
    ------
    InputError
        Something is missing, unknown or not allowed.
    """
    try:
        read = model.model_validate(content, context={"file": path})
    except ValidationError as error:
        found = [e for e in error.errors(include_url=False) if not _follows(e)]
        said = [_sentence(e, model) for e in found[:_SAID]]
        more = [f"and {len(found) - _SAID} more"] if len(found) > _SAID else []
        raise InputError("; ".join(said + more), where=path) from error
    for place in _counted(content, read):
        raise InputError(f"{place}: true and false are no numbers", where=path)
    return read


def _counted(written: Any, read: Any) -> Iterator[str]:
    """Yield the places where true or false is written and was read as 1 or 0.

    Pydantic's own strict mode would refuse 1 for 1.0 too, and lists for tuples.
    """
    if isinstance(written, dict):
        for key, value in written.items():
            inner = read.get(key) if isinstance(read, dict) else getattr(read, key, None)
            yield from _counted_inside(str(key), value, inner)
    elif isinstance(written, list) and isinstance(read, list | tuple):
        for number, (value, inner) in enumerate(zip(written, read, strict=False)):
            yield from _counted_inside(str(number), value, inner)


def _counted_inside(place: str, written: Any, read: Any) -> Iterator[str]:
    if isinstance(written, bool):
        if isinstance(read, int | float) and not isinstance(read, bool):
            yield place
    elif isinstance(written, dict | list) and read is not None and read is not written:
        yield from (f"{place}.{inner}" for inner in _counted(written, read))


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
    got = "" if isinstance(error["input"], dict | list) else f", got {_shown(error['input'])}"
    return f"{place}: {message}{got}" if place else message


def _follows(one: Any) -> bool:
    """Say whether a list is called too short only because what is in it is wrong."""
    return one["type"] == "too_short" and any(one["input"])


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}…"


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
