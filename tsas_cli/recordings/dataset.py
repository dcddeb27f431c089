"""A dataset on disk: one Parquet file per run, and a manifest (format 1)."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from hashlib import sha256
from pathlib import Path
from typing import Any

from tsas_cli.recordings.manifest import MANIFEST_FILE, Manifest, Run, read_manifest
from tsas_cli.recordings.recording import Recording
from tsas_cli.recordings.run_files import read_recording
from tsas_cli.recordings.storage import Location, location_text
from tsas_cli.recordings.validation import parse
from tsas_cli.support.errors import InputError, nearest
from tsas_cli.support.files import sha256_of

CONDITIONS = ("sheath_length_mm", "total_bend_rad", "preload_N")


@dataclass(frozen=True, repr=False)
class Dataset:
    """A dataset's folder and manifest; recordings are read on access.

    `dataset["a"]` reads run a; a loop over the dataset reads one run after the other.

    Parameters
    ----------
    folder
        A local folder, or an address on object storage.
    manifest
        The content of `dataset.toml`.
    chosen
        The ids of the selected runs; None for all.
    conditions
        Conditions of every run that replace the manifest's, by key.
    """

    folder: Location
    manifest: Manifest
    chosen: tuple[str, ...] | None = None
    conditions: Mapping[str, float] = field(default_factory=dict)

    @property
    def runs(self) -> list[Run]:
        """The selected runs, in the order of the manifest."""
        return [r for r in self.manifest.run if self.chosen is None or r.id in self.chosen]

    def only(self, ids: Iterable[str]) -> "Dataset":
        """Return the dataset restricted to these runs.

        InputError: there is no such run, or none is chosen.
        """
        known = [run.id for run in self.manifest.run]
        chosen, where = tuple(ids), self.folder / MANIFEST_FILE
        if not chosen:
            raise InputError("no run is chosen", where=where, expected="a run")
        for name in chosen:
            if name not in known:
                hint = nearest(str(name), known)
                raise InputError(f"there is no run {name!r}", where=where, remedy=hint)
        return replace(self, chosen=chosen)

    def under(self, **conditions: float) -> "Dataset":
        """Return the dataset with these conditions set for every run.

        InputError: there is no such condition, or a value is not allowed.
        """
        for name in conditions:
            if name not in CONDITIONS:
                raise InputError(f"unknown condition {name}", remedy=nearest(name, CONDITIONS))
        where = self.folder / MANIFEST_FILE
        runs = [
            parse(Run, run.model_dump(exclude_unset=True) | conditions, where)
            for run in self.manifest.run
        ]
        manifest = self.manifest.model_copy(update={"run": tuple(runs)})
        return replace(self, manifest=manifest, conditions={**self.conditions, **conditions})

    def __repr__(self) -> str:
        """Return one line with the name, the folder and the selected runs."""
        return (
            f"dataset {self.manifest.name} in {self.folder}: {', '.join(r.id for r in self.runs)}"
        )

    def __getitem__(self, run: str) -> Recording:
        """Return the recording of a run.

        InputError: there is no such run, or its file is wrong (`read_recording`).
        """
        entry = self.only([run]).runs[0]
        return read_recording(self.folder, entry).read_only()

    def __iter__(self) -> Iterator[Recording]:
        """Iterate over the recordings, in the order of the manifest."""
        return (read_recording(self.folder, run).read_only() for run in self.runs)

    def header(self, folder: Path | None) -> dict[str, Any]:
        """Return what the JSON that a stage writes into `folder` says of the dataset, by key.

        The dataset's path is relative to `folder`, or to the current folder; an address is not.
        """
        path = location_text(folder or Path(), self.folder)
        return {
            "dataset": {"name": self.manifest.name, "folder": path, "hashes": self.hashes()},
            "chosen": None if self.chosen is None else [run.id for run in self.runs],
            "conditions": dict(self.conditions),
        }

    def hashes(self) -> dict[str, str]:
        """Return the checksum of the manifest and of each run's file, by path in the dataset."""
        manifest = (self.folder / MANIFEST_FILE).read_bytes()
        return {MANIFEST_FILE: sha256(manifest).hexdigest()} | {
            r.file: r.sha256 for r in self.manifest.run
        }


def read_from(path: Path, home: Path) -> dict[str, str]:
    """Return the record that `home` keeps of an input file: name, folder, checksum."""
    return {
        "file": path.name,
        "folder": location_text(home, path.parent),
        "sha256": sha256_of(path),
    }


def read_dataset(folder: Location) -> Dataset:
    """Return a dataset in a local folder, or at an address.

    InputError: the folder holds no manifest, or one that format 1 does not allow.
    """
    return Dataset(folder, read_manifest(folder))
