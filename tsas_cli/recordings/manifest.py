"""The manifest `dataset.toml` of a dataset, format 1: its content and validation."""

import re
import tomllib
import unicodedata
from collections import Counter
from collections.abc import Iterable
from datetime import date, datetime
from pathlib import Path, PurePosixPath
from typing import Annotated, Literal, Self

import tomlkit
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    field_validator,
    model_validator,
)

from tsas_cli.recordings.session import Session
from tsas_cli.recordings.storage import Address, Location, check_inside
from tsas_cli.recordings.validation import parse
from tsas_cli.support import limits, plausible
from tsas_cli.support.errors import InputError, nearest
from tsas_cli.support.files import Raw, in_subfolders, parsed
from tsas_cli.support.replacing import sealed

MANIFEST_FILE = "dataset.toml"
Load = Literal["spring", "force", "displacement"]
_PATH_LENGTH = 1000  # characters of a path in the dataset
_DEVICES = {"con", "prn", "aux", "nul", *(f"{d}{n}" for d in ("com", "lpt") for n in range(10))}


YEARS = range(1900, 2200)  # of a recording


def _as_date(value: object) -> object:
    """Return a date, or text that begins with an ISO 8601 date; refuse Pydantic's epoch seconds."""
    if isinstance(value, str):
        value = re.sub(r"^(\d{4})(\d\d)(\d\d)(?!\d)", r"\1-\2-\3", value)
        if re.match(r"\d{4}-\d\d-\d\d", value) and int(value[:4]) in YEARS:
            return value
    elif isinstance(value, date) and value.year in YEARS:
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
    antagonist_preload_N: plausible.SecondPreload | None = None
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
    name: str = Field(min_length=1)
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
            why_no_dataset(folder),
            where=folder,
            expected="a dataset folder",
            remedy=inside or "make one from your files with `tsas ingest`",
        )
    check_inside(path, folder)
    return parse(Manifest, read_toml(path), path)


def why_no_dataset(folder: Location) -> str:
    """Return why a place without a manifest is no dataset."""
    if isinstance(folder, Path) and not folder.exists():
        return "does not exist"
    return "is a file" if folder.is_file() else "no dataset.toml here"


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


def write_manifest(folder: Path, manifest: Manifest) -> None:
    """Write `dataset.toml` without the keys that are not set."""
    content = manifest.model_dump(mode="python", exclude_none=True)
    content["run"] = list(content["run"])
    (folder / MANIFEST_FILE).write_text(sealed(tomlkit.dumps(content)), encoding="utf-8")
