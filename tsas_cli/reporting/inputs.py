"""What the page is made from: the dataset, and what the stages wrote about it."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar, cast

from tsas_cli.identification.prepared import CHANNELS
from tsas_cli.numerics.noise import noise_of, recorded
from tsas_cli.recordings.dataset import Dataset, read_dataset
from tsas_cli.recordings.manifest import MANIFEST_FILE
from tsas_cli.recordings.quality import check_dataset
from tsas_cli.recordings.recording import Recording
from tsas_cli.recordings.storage import Location
from tsas_cli.recordings.validation import parse
from tsas_cli.recordings.writing import check_rows, columns_of, names_of, result_file
from tsas_cli.records.base import OfDataset, StageFile
from tsas_cli.records.calibration import CalibrationFile
from tsas_cli.records.check import CheckFile
from tsas_cli.records.closing import ClosingFile
from tsas_cli.records.diagnosis import DiagnosisFile, HeldOut
from tsas_cli.records.drive import DriveFile
from tsas_cli.records.prediction import PredictionFile
from tsas_cli.records.simulation import SimulationFile
from tsas_cli.records.tracking import TrackingFile
from tsas_cli.reporting.names import quantity_of
from tsas_cli.support.arrays import Floats
from tsas_cli.support.errors import InputError, printable
from tsas_cli.support.files import in_subfolders, read_json

STAGES: tuple[type[StageFile], ...] = (  # in the order of their commands
    ClosingFile,
    TrackingFile,
    CheckFile,
    CalibrationFile,
    SimulationFile,
    DiagnosisFile,
    DriveFile,
    PredictionFile,
)
Stage = TypeVar("Stage", bound=StageFile)


@dataclass(frozen=True)
class Inputs:
    """The dataset, and what was given: each stage's file, and its folder.

    Without a dataset there is only what `tsas close-loop` wrote, which has one for each case.
    """

    dataset: Dataset | None
    given: tuple[tuple[StageFile, Path], ...]

    @property
    def folders(self) -> dict[type[StageFile], Path]:
        """The folder of each kind of stage, of the first simulation."""
        return {type(stage): folder for stage, folder in reversed(self.given)}

    @property
    def simulations(self) -> dict[str, tuple[SimulationFile, Path]]:
        """Each simulation with its folder, by the folder's name, its path where two share one."""
        every = [(one, path) for one, path in self.given if isinstance(one, SimulationFile)]
        names = [folder.name for _, folder in every]
        return {
            name if names.count(name) == 1 else str(folder): (record, folder)
            for name, (record, folder) in zip(names, every, strict=True)
        }

    @cached_property
    def check(self) -> CheckFile:
        """What the checks say of the dataset; they are run here where no folder holds them."""
        if given := self.get(CheckFile):
            return given
        dataset = cast("Dataset", self.dataset)
        return CheckFile(**dataset.header(Path()), **vars(check_dataset(dataset)))

    @property
    def recordings(self) -> Iterable[Recording]:
        """The dataset's recordings, none without one."""
        return () if self.dataset is None else self.dataset

    def get(self, kind: type[Stage]) -> Stage | None:
        """Return what a stage wrote, or None where it was not given."""
        return next((stage for stage, _ in self.given if isinstance(stage, kind)), None)

    @property
    def held_out(self) -> dict[str, HeldOut]:
        """The residuals of the diagnosis's channels, over the noise level of the whole page."""
        diagnosis = self.get(DiagnosisFile)
        return {
            name: held.model_copy(update={"noise_floor": self.noise.get(name) or held.noise_floor})
            for name, held in (diagnosis.channels if diagnosis else {}).items()
        }

    @cached_property
    def noise(self) -> dict[str, float]:
        """The noise level of each channel over all runs, in its unit, where it is known."""
        squares: dict[str, list[tuple[float, int]]] = {}
        for recording in self.recordings:
            for name in CHANNELS:
                values = recording.get(name)
                if values is None:
                    continue
                level = noise_of(recorded(values), recording.time_s).sd
                if level > 0.0:
                    squares.setdefault(name, []).append((level**2, values.size))
        return {
            name: math.sqrt(sum(square * n for square, n in levels) / sum(n for _, n in levels))
            for name, levels in squares.items()
        }

    def concerns(self, parameter: str) -> bool:
        """Return whether some run has the parameter's channel, or it belongs to none."""
        name = parameter.rpartition(".")[2]
        channel = next((c for c in CHANNELS if name.startswith(f"{quantity_of(c)}_")), None)
        return channel is None or channel in self._columns

    @cached_property
    def _columns(self) -> frozenset[str]:
        return frozenset(name for one in self.recordings for name in one.columns)


def series_of(folder: Path, run: str, rows: int, column: str) -> Floats:
    """Return a column of a run with `rows` samples from a stage's folder, NaN for gaps.

    InputError: the file cannot be read, or does not belong to this recording.
    """
    path = result_file(folder, run)
    values = columns_of(path, (column,))[column]
    check_rows(path, len(values), rows)
    return values


def written_in(folder: Path, run: str) -> frozenset[str]:
    """Return the columns that a stage's folder has of a run, none without the run.

    InputError: the file cannot be read.
    """
    path = result_file(folder, run)
    return frozenset(names_of(path) if path.is_file() else ())


def read_inputs(folders: Sequence[Location], *, several: bool = False) -> Inputs:
    """Recognise each folder by the files in it, read all, and find the dataset.

    `several` simulations may be given, else one.

    InputError: a folder is of no known kind, a kind is a duplicate, no dataset can be found, a
    stage has read other recordings than the dataset holds, or tracked runs are not in it.
    """
    by_file = _by_file(folders, several=several)
    given = tuple(
        (read_stage(kind, folder), folder)
        for kind in STAGES
        for folder in cast("list[Path]", by_file.get(kind.FILE, []))
    )
    named = (
        stage.dataset.found(folder / stage.FILE) if isinstance(stage, OfDataset) else folder
        for stage, folder in given
        if not isinstance(stage, ClosingFile)
    )
    folder = by_file[MANIFEST_FILE][0] if MANIFEST_FILE in by_file else next(named, None)
    if folder is None:
        return Inputs(None, given)
    dataset = read_dataset(folder).under(**_conditions(given))
    for stage, path in given:
        if isinstance(stage, OfDataset):
            stage.dataset.check(dataset, path / stage.FILE)
        elif isinstance(stage, TrackingFile) and dataset.folder.resolve() != path.resolve():
            raise InputError(
                f"its runs are not in the dataset {dataset.folder}",
                where=path / stage.FILE,
                expected=f"{MANIFEST_FILE} in the same folder",
                remedy="give this folder alone, or write it again with `tsas track`",
            )
    return Inputs(dataset, given)


def read_stage(kind: type[Stage], folder: Path) -> Stage:
    """Read what a stage has written; control characters in its texts are made visible.

    InputError: the file cannot be read, or does not say what such a file says.
    """
    path = folder / kind.FILE
    content = read_json(path)
    visible = _visible(content) if isinstance(content, dict) else content
    return parse(kind, visible, path)


def _visible(content: Any) -> Any:
    """Make texts and keys printable, but the dataset's paths, by which files are looked up."""
    if isinstance(content, str):
        return printable(content)
    if isinstance(content, list):
        return [_visible(value) for value in content]
    if isinstance(content, dict):
        return {
            printable(key): value if key == "dataset" else _visible(value)
            for key, value in content.items()
        }
    return content


def _by_file(folders: Sequence[Location], *, several: bool) -> dict[str, list[Location]]:
    known = (MANIFEST_FILE, *(kind.FILE for kind in STAGES))
    found: dict[str, list[Location]] = {}
    for folder in folders:
        # Stages write to local folders.
        looked_for = known if isinstance(folder, Path) else (MANIFEST_FILE,)
        files = [file for file in looked_for if (folder / file).is_file()]
        if not files:
            missing = isinstance(folder, Path) and not folder.exists()
            raise InputError(
                "does not exist" if missing else "neither a dataset nor what a stage wrote",
                where=folder,
                expected=f"a folder with one of {', '.join(looked_for)}",
                remedy=in_subfolders(folder, looked_for),
            )
        for file in files:
            before = found.setdefault(file, [])
            again = several and file == SimulationFile.FILE and folder not in before
            if before and not again:
                raise InputError(
                    f"a second folder with {file}, after {before[0]}",
                    where=folder,
                    expected="one folder of each kind"
                    + (f", and several with {SimulationFile.FILE}" if several else ""),
                    remedy="write a page for each",
                )
            before.append(folder)
    return found


def _conditions(given: Sequence[tuple[StageFile, Path]]) -> dict[str, float]:
    """Return the conditions that replace the manifest's; the stages have to agree."""
    stated = [(s.conditions, path / s.FILE) for s, path in given if isinstance(s, OfDataset)]
    for conditions, path in stated:
        if conditions != stated[0][0]:
            raise InputError(
                f"was given other conditions of the runs than {stated[0][1]}",
                where=path,
                remedy="write a page for each",
            )
    return stated[0][0] if stated else {}
