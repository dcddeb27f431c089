"""One side of a comparison: a model file, or the folder of a stage that says something of one."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from tsas_cli.identification.model import Model
from tsas_cli.identification.model_file import IN_MEMORY, model_of, read_model
from tsas_cli.physics.response import Dynamics
from tsas_cli.recordings.dataset import Dataset, read_dataset
from tsas_cli.recordings.manifest import MANIFEST_FILE, parse, read_toml
from tsas_cli.recordings.storage import recorded_location
from tsas_cli.records.base import DatasetSource, OfDataset
from tsas_cli.records.calibration import MODEL_FILE, CalibrationFile
from tsas_cli.records.diagnosis import EXTENDED_MODEL, DiagnosisFile, HeldOut, NamedCause
from tsas_cli.records.simulation import SimulationFile
from tsas_cli.support.errors import InputError
from tsas_cli.support.files import read_json, sha256_of

Kind = Literal["model", "calibration", "diagnosis", "simulation"]
STAGES: tuple[type[OfDataset], ...] = (CalibrationFile, DiagnosisFile, SimulationFile)


@dataclass(frozen=True)
class Side:
    """What is compared, as far as it is there.

    `recordings` holds the checksum of each recording that was read, by run id; None where a model
    does not say what it was fitted to. `dataset` is None where it is no longer there as it was
    read, and `gone` then says why. A simulation does not hold its model.
    """

    path: Path
    kind: Kind
    files: dict[str, str]
    model: Model | None = None
    dynamics: Dynamics = "slip"
    source: DatasetSource | None = None
    dataset: Dataset | None = None
    gone: str = ""
    recordings: dict[str, str] | None = None
    verdict: str = ""
    reason: str = ""
    named: tuple[NamedCause, ...] = ()
    held_out: dict[str, HeldOut] = field(default_factory=dict)
    not_converged: str = ""

    @property
    def model_file(self) -> Path | None:
        """The file of the model, None of a simulation or a model in memory."""
        folder = self.path.parent if self.kind == "model" else self.path
        return next((folder / file for file in self.files if file.endswith(".toml")), None)

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
    model = read_model(path)
    said = read_toml(path).get("dataset", {})
    source = parse(DatasetSource, said, path) if "hashes" in said else None
    dataset, gone = (None, "") if source is None else _dataset(source, source, path.parent)
    return Side(
        path,
        "model",
        {path.name: sha256_of(path)},
        model,
        _dynamics_of(model),
        source,
        dataset,
        gone,
        None if source is None else _recordings(source, source.chosen, dataset),
    )


def _of_stage(path: Path, kind: type[OfDataset]) -> Side:
    file = path / kind.FILE
    stage = parse(kind, read_json(file), file)
    files = {kind.FILE: sha256_of(file)}
    dataset, gone = _dataset(stage.dataset, stage, path)
    read = _recordings(stage.dataset, stage.chosen, dataset)
    if isinstance(stage, SimulationFile):
        return Side(
            path, "simulation", files, None, stage.dynamics, stage.dataset, dataset, gone, read
        )
    name = EXTENDED_MODEL if isinstance(stage, DiagnosisFile) else MODEL_FILE
    model = read_model(path / name)
    files[name] = sha256_of(path / name)
    if isinstance(stage, DiagnosisFile):
        return Side(
            path, "diagnosis", files, model, "slip", stage.dataset, dataset, gone, read,
            stage.verdict, stage.reason, stage.named, stage.channels,
        )  # fmt: skip
    assert isinstance(stage, CalibrationFile)  # noqa: S101  the only other kind
    return Side(
        path, "calibration", files, model, stage.dynamics, stage.dataset, dataset, gone, read,
        not_converged="" if stage.fit.converged else stage.fit.message,
    )  # fmt: skip


def _dataset(
    source: DatasetSource, read: DatasetSource | OfDataset, home: Path
) -> tuple[Dataset | None, str]:
    """Return the dataset as it was read, with the runs that were; or None, and why."""
    try:
        folder = recorded_location(home, source.folder)
        if not source.folder or not (folder / MANIFEST_FILE).is_file():
            return None, f"the dataset {source.name} is no longer at {folder}"
        dataset = read_dataset(folder)
    except InputError as error:
        return None, error.line()
    then = {file: digest.lower() for file, digest in source.hashes.items()}
    if then != {file: digest.lower() for file, digest in dataset.hashes().items()}:
        return None, f"the dataset {folder} has changed since it was read"
    dataset = dataset.under(**read.conditions)
    return (dataset if read.chosen is None else dataset.only(read.chosen)), ""


def _recordings(
    source: DatasetSource, chosen: tuple[str, ...] | None, dataset: Dataset | None
) -> dict[str, str]:
    """Return the checksum of each recording that was read, by the id of its run.

    Without the dataset the ids are those that the files are named after.
    """
    if dataset is not None:
        return {run.id: run.sha256.lower() for run in dataset.runs}
    named = {
        Path(f).stem: digest.lower() for f, digest in source.hashes.items() if f != MANIFEST_FILE
    }
    return {run: digest for run, digest in named.items() if chosen is None or run in chosen}
