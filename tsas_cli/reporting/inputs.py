"""What the page is made from: the dataset, and what the stages wrote about it."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq

from tsas_cli.errors import InputError
from tsas_cli.files import read_json
from tsas_cli.recordings.dataset import Dataset, Recording, read_dataset
from tsas_cli.recordings.manifest import FILE, parse
from tsas_cli.reporting.stage_files import Calibration, Check, Simulation, StageFile

Floats = npt.NDArray[np.float64]
STAGES: dict[str, tuple[str, type[StageFile]]] = {
    "check": ("check.json", Check),
    "calibration": ("calibration.json", Calibration),
    "simulation": ("simulation.json", Simulation),
}


@dataclass(frozen=True)
class Inputs:
    """The dataset, the folders by kind, and what each stage wrote, None where it was not given."""

    dataset: Dataset
    folders: Mapping[str, Path]
    check: Check | None = None
    calibration: Calibration | None = None
    simulation: Simulation | None = None

    def simulated(self, recording: Recording, column: str) -> Floats:
        """Return a simulated channel of a run, shape (n,) as the recording, NaN for gaps.

        Raises
        ------
        InputError
            The file cannot be read, or does not belong to this recording.
        """
        path = self.folders["simulation"] / "runs" / f"{recording.run.id}.parquet"
        try:
            values = pq.read_table(path, columns=[column]).column(column)
        except (pa.ArrowException, OSError, KeyError) as error:
            reason = str(error).splitlines()[0]
            raise InputError(f"cannot be read ({reason})", where=path) from error
        if len(values) != recording.time_s.size:
            raise InputError(
                f"{len(values)} rows",
                where=path,
                expected=f"{recording.time_s.size}, as the recording has",
                remedy="run `tsas simulate` again",
            )
        array: Floats = values.to_numpy()
        return array


def read_inputs(folders: Sequence[Path]) -> Inputs:
    """Recognise each folder by the files in it, read all, and find the dataset.

    Raises
    ------
    InputError
        A folder is of no known kind, a kind is there twice, no dataset can be found, or a stage
        has read other recordings than the dataset holds.
    """
    by_kind = _by_kind(folders)
    paths = {kind: by_kind[kind] / file for kind, (file, _) in STAGES.items() if kind in by_kind}
    stages = {kind: parse(STAGES[kind][1], read_json(path), path) for kind, path in paths.items()}
    if "dataset" not in by_kind:
        kind, stage = next(iter(stages.items()))
        by_kind["dataset"] = _dataset_of(stage, paths[kind])
    dataset = read_dataset(by_kind["dataset"])
    for kind, stage in stages.items():
        _check_hashes(stage, dataset, paths[kind])
    return Inputs(dataset, by_kind, **stages)


def _by_kind(folders: Sequence[Path]) -> dict[str, Path]:
    files = {"dataset": FILE} | {kind: file for kind, (file, _) in STAGES.items()}
    found: dict[str, Path] = {}
    for folder in folders:
        kinds = [kind for kind, file in files.items() if (folder / file).is_file()]
        if not kinds:
            raise InputError(
                "this is no folder that tsas has written",
                where=folder,
                expected=f"one of {', '.join(files.values())} in it",
            )
        for kind in kinds:
            if kind in found:
                raise InputError(
                    f"a second folder with {files[kind]}, after {found[kind]}",
                    where=folder,
                    expected="one folder of each kind",
                    remedy="write a page for each",
                )
            found[kind] = folder
    return found


def _dataset_of(stage: StageFile, path: Path) -> Path:
    folder = Path(os.path.normpath(path.parent / stage.dataset.folder))
    if not (folder / FILE).is_file():
        raise InputError(
            f"the dataset {stage.dataset.name} is no longer at {folder}",
            where=path,
            expected=f"a folder with {FILE}",
            remedy="give the dataset's folder to `tsas report` too",
        )
    return folder


def _check_hashes(stage: StageFile, dataset: Dataset, path: Path) -> None:
    now = dataset.hashes()
    for file in sorted(now.keys() | stage.dataset.hashes.keys()):
        if now.get(file, "").lower() != stage.dataset.hashes.get(file, "").lower():
            raise InputError(
                f"{file} of {dataset.folder} is not what this stage has read",
                where=path,
                expected=f"SHA-256 {stage.dataset.hashes.get(file, 'of no such file')}",
                remedy="run the stage again on this dataset",
            )
