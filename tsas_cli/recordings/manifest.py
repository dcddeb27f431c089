"""The manifest `dataset.toml` of a dataset, format 1: its content and validation."""

import re
import tomllib
import unicodedata
from collections import Counter
from collections.abc import Iterable, Iterator
from datetime import date, datetime
from functools import partial
from pathlib import Path, PurePosixPath
from typing import Annotated, Any, Literal, Self, TypeVar

import tomlkit
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationError,
    field_validator,
    model_validator,
)

from tsas_cli.recordings.session import Session
from tsas_cli.recordings.storage import Address, Location, check_inside
from tsas_cli.support import limits, plausible
from tsas_cli.support.errors import InputError, nearest
from tsas_cli.support.files import Raw, in_subfolders, parsed
from tsas_cli.support.replacing import sealed

MANIFEST_FILE = "dataset.toml"
Load = Literal["spring", "force", "displacement"]
T = TypeVar("T", bound=BaseModel)
_MOST_ERRORS = 5  # listed of one file; further ones are counted
_VALUE_LENGTH = 80  # characters of an invalid value in a message
_PATH_LENGTH = 1000  # characters of a path in the dataset
_DEVICES = {"con", "prn", "aux", "nul", *(f"{d}{n}" for d in ("com", "lpt") for n in range(10))}


def _as_date(value: object) -> object:
    """Return a date, or text that begins with an ISO 8601 date; refuse Pydantic's epoch seconds."""
    if isinstance(value, str):
        value = re.sub(r"^(\d{4})(\d\d)(\d\d)(?!\d)", r"\1-\2-\3", value)
        if re.match(r"\d{4}-\d\d-\d\d", value):
            return value
    elif isinstance(value, date):
        return value
    raise ValueError("is no date such as 2026-03-02 or 2026-03-02T09:30:00Z")


def check_run_name(name: str) -> str:
    """Return an id; refuse one that is no valid file name.

    ValueError: it is empty, not printable, too long, or a Windows device; it has a slash, or a
    blank at either end.
    """
    unusable = name in {"", ".", ".."} or {"/", "\\"} & set(name) or not name.isprintable()
    if unusable or len(f"{name}.parquet".encode()) > 255 or name != name.strip():
        raise ValueError(
            "must be usable as a file name (no slash, no control character, no blank at its ends, "
            "not too long)"
        )
    if name.partition(".")[0].lower() in _DEVICES:
        raise ValueError("is a device on Windows, not a file name")
    return name


def colliding_names(names: Iterable[str]) -> tuple[str, str] | None:
    """Return two ids that name one file since only case or Unicode form differs; or None."""
    known: dict[str, str] = {}
    for name in names:
        other = known.setdefault(unicodedata.normalize("NFC", name).casefold(), name)
        if other != name:
            return other, name
    return None


RunId = Annotated[str, AfterValidator(check_run_name)]


class _ManifestTable(BaseModel):
    # A dataset made with any tool must work: unknown keys are kept, and `tsas check` names them
    # with the nearest known one.
    model_config = ConfigDict(frozen=True, extra="allow", allow_inf_nan=False)

    @model_validator(mode="after")
    def _has_few_unknown_keys(self) -> Self:
        unknown = len(self.model_extra or {})
        if unknown > limits.UNKNOWN_KEYS:
            raise ValueError(f"{unknown} keys are unknown, at most {limits.UNKNOWN_KEYS} are kept")
        return self

    def unknown_keys(self) -> dict[str, str]:
        """Return each key that format 1 does not define, with a hint for it."""
        known = type(self).model_fields
        return {key: nearest(key, known) for key in self.model_extra or {}}


class RigSheet(_ManifestTable):
    """Data sheet of the rig; every key is optional and carries its unit."""

    tendon_diameter_mm: plausible.Diameter | None = None
    tendon_modulus_GPa: plausible.Modulus | None = None
    friction_coefficient: plausible.Friction | None = None
    load_stiffness_N_per_mm: plausible.Stiffness | None = None
    turntable_radius_mm: plausible.Radius | None = None
    gear_ratio: plausible.GearRatio | None = None
    inertia_N_mm_s2: plausible.Inertia | None = None
    proximal_length_mm: plausible.FreeLength | None = None
    distal_length_mm: plausible.FreeLength | None = None
    antagonist_preload_N: plausible.Preload | None = None
    antagonist_friction_ratio: plausible.FrictionRatio | None = None
    antagonist_f_in_share: plausible.Share | None = None


class Run(_ManifestTable):
    """One run: its file with checksum, and the conditions under which it was recorded."""

    id: RunId
    file: str
    sha256: str = Field(pattern=r"^[0-9a-fA-F]{64}$")
    started: Annotated[datetime, BeforeValidator(_as_date)] | None = None
    sheath_length_mm: plausible.Length | None = None
    total_bend_rad: plausible.Bend | None = None
    preload_N: plausible.Preload | None = None
    load: Load = "spring"

    @field_validator("file")
    @classmethod
    def _stays_inside(cls, file: str) -> str:
        path = PurePosixPath(file.replace("\\", "/"))
        drive = any(":" in part for part in path.parts[:1])
        if path.is_absolute() or ".." in path.parts or drive:
            raise ValueError("must stay inside the dataset's folder (no '..', no absolute path)")
        if len(file) > _PATH_LENGTH or any(len(part.encode()) > 255 for part in path.parts):
            raise ValueError("is too long for a file's name")
        return str(path)


class Manifest(_ManifestTable):
    """The whole manifest."""

    format: Literal[1]
    name: str
    kind: Literal["measured", "simulated"]
    description: str = ""
    license: str | None = None
    source: str | None = None
    rig: RigSheet = RigSheet()
    run: tuple[Run, ...] = Field(min_length=1)
    ingest: dict[str, object] | None = None  # the input files and the map of `tsas ingest`

    @property
    def session(self) -> Session | None:
        """Starts of the first and the last run; None unless all runs state theirs."""
        started = [run.started for run in self.run if run.started is not None]
        zones = {at.tzinfo is None for at in started}
        known = len(started) == len(self.run) and len(zones) == 1
        return Session(min(started), max(started)) if known else None

    @property
    def session_start(self) -> datetime | None:
        """Start of the first run; None unless all runs state theirs."""
        session = self.session
        return None if session is None else session.first

    @model_validator(mode="after")
    def _ids_differ(self) -> "Manifest":
        if len(self.run) > limits.RUNS:
            raise ValueError(
                f"{len(self.run)} runs, at most {limits.RUNS} in one dataset; split it"
            )
        names = Counter(run.id for run in self.run)
        duplicates = [name for name, count in names.items() if count > 1]
        if duplicates:
            raise ValueError(f"duplicate run id {duplicates[0]!r}")
        same_file = colliding_names(names)
        if same_file:
            raise ValueError(
                f"run ids {same_file[0]!r} and {same_file[1]!r} name one file on Windows and macOS"
            )
        return self


def read_manifest(folder: Location) -> Manifest:
    """Return the validated `dataset.toml` of a folder.

    InputError: the manifest is missing, is not TOML, or violates format 1.
    """
    path = folder / MANIFEST_FILE
    if not path.is_file():
        inside = in_subfolders(folder, (MANIFEST_FILE,))
        raise InputError(
            "is a file" if folder.is_file() else "no dataset.toml here",
            where=folder,
            expected="a dataset folder",
            remedy=inside or "make one from your files with `tsas ingest`",
        )
    check_inside(path, folder)
    return parse(Manifest, read_toml(path), path)


def read_toml(path: Location) -> Raw:
    """Return the content of a TOML file.

    InputError: the file cannot be read, is not TOML, or exceeds a limit.
    """

    def load() -> Raw:
        text = (
            limits.decoded(path.read_bytes(0, limits.TOML_BYTES + 1), path, limits.TOML_BYTES)
            if isinstance(path, Address)
            else limits.text_of(path, limits.TOML_BYTES)
        )
        limits.toml(text, path)
        return tomllib.loads(text)

    content: Raw = parsed(load, "TOML", path)
    return content


def parse(model: type[T], content: Raw, path: object) -> T:
    """Return the validated content of a file; all its errors become one line.

    InputError: a key is missing, unknown or invalid.
    """
    try:
        read = model.model_validate(content, context={"file": path})
    except ValidationError as error:
        # A list is also reported as too short only because its items are invalid.
        found = [
            e
            for e in error.errors(include_url=False)
            if not (e["type"] == "too_short" and any(e["input"]))
        ]
        listed = [_sentence(e, model) for e in found[:_MOST_ERRORS]]
        more = [f"and {len(found) - _MOST_ERRORS} more"] if len(found) > _MOST_ERRORS else []
        raise InputError("; ".join(listed + more), where=path) from error
    for place in _booleans_as_numbers(content, read):
        raise InputError(f"{place}: true and false are no numbers", where=path)
    return read


def _booleans_as_numbers(written: Any, read: Any, place: str = "") -> Iterator[str]:
    """Yield the places where true or false was read as 1 or 0.

    Pydantic's strict mode would also refuse 1 for 1.0, and lists for tuples.
    """
    inside: Iterable[tuple[Any, Any, Any]] = ()
    if isinstance(written, dict):
        get = read.get if isinstance(read, dict) else partial(getattr, read)
        inside = ((key, value, get(key, None)) for key, value in written.items())
    elif isinstance(written, list) and isinstance(read, list | tuple):
        inside = ((k, *both) for k, both in enumerate(zip(written, read, strict=False)))
    elif isinstance(written, bool) and isinstance(read, int | float) and not isinstance(read, bool):
        yield place
    for key, value, inner in inside:
        if inner is not None and inner is not value:
            at = f"{place}.{key}" if place else str(key)
            yield from _booleans_as_numbers(value, inner, at)


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
    shown = repr(error["input"])
    shown = shown if len(shown) <= _VALUE_LENGTH else f"{shown[:_VALUE_LENGTH]}…"
    got = "" if isinstance(error["input"], dict | list) else f", got {shown}"
    return f"{place}: {message}{got}" if place else message


def _known(model: Any, location: tuple[Any, ...]) -> list[str]:
    """Return the keys that the model defines at the place of an error, as far as it is known."""
    for part in location[:-1]:
        field = getattr(model, "model_fields", {}).get(part)
        if field is None:
            continue
        inner = [a for a in getattr(field.annotation, "__args__", ()) if hasattr(a, "model_fields")]
        model = inner[0] if inner else field.annotation
    return list(getattr(model, "model_fields", {}))


def write_manifest(folder: Path, manifest: Manifest) -> None:
    """Write `dataset.toml` without the keys that are not set."""
    content = manifest.model_dump(mode="python", exclude_none=True)
    content["run"] = list(content["run"])
    (folder / MANIFEST_FILE).write_text(sealed(tomlkit.dumps(content)), encoding="utf-8")
