"""The identify-harmonic-drive stage: `drive.toml`, `drive.json` and the simulated x_in."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from tsas_cli import __version__
from tsas_cli.diagnosis import drive_json
from tsas_cli.diagnosis.drive_diagnosis import DriveDiagnosis, diagnose_drive
from tsas_cli.diagnosis.drive_search import DriveSearch
from tsas_cli.diagnosis.drive_tables import tables
from tsas_cli.diagnosis.drive_words import (
    cannot_tell,
    equation_of,
    inverse_of,
    name_of,
)
from tsas_cli.files import folder_if, write_json
from tsas_cli.identification.drive_estimates import (
    DataSheet,
    drive_sheet,
    estimates_of,
)
from tsas_cli.identification.drive_file import FILE, UNITS, IdentifiedDrive, drive_of, write_drive
from tsas_cli.identification.drive_fit import DriveBench, Terms
from tsas_cli.identification.drive_runs import drive_runs
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.frequency_response import frequency_response
from tsas_cli.numerics.linear_response import Hold
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.quality.copies.counted import counted_once
from tsas_cli.recordings.recording import Recording, recording_of
from tsas_cli.recordings.writing import write_runs
from tsas_cli.result import Result, Table, notes
from tsas_cli.steps import SILENT, Steps

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, repr=False, eq=False)
class DriveResult(Result):
    """An identified drive, what the nominal drive equation lacks, and the simulated runs.

    Parameters
    ----------
    estimates
        Every parameter by name: fitted, derived, or given by the data sheet.
    diagnosis
        The verdict on the nominal drive equation, with causes and gains on held-out data.
    runs
        By id the simulated runs: columns of shape (n,) as in the recording, `x_in_mm` and that of
        the nominal drive, `x_in_nominal_mm` [mm].
    """

    estimates: Mapping[str, Estimate]
    diagnosis: DriveDiagnosis
    runs: Mapping[str, Recording]

    @property
    def drive(self) -> IdentifiedDrive:
        """The drive as `drive.toml` holds it, for the controllers of `track`."""
        known = self.estimates.items()
        return drive_of({n: e.value for n, e in known if math.isfinite(e.value)})

    def __getitem__(self, run: str) -> Recording:
        """Return a simulated run."""
        return recording_of(self.runs, run)

    def tables(self) -> list[Table]:
        """Return structures, parameters, errors and causes."""
        return tables(self.summary, self.titled(self.summary["structure"]["equation"], FILE))

    def sentences(self) -> list[str]:
        """Return the verdict, the inverse, what to measure next, and what cannot be told."""
        found = self.summary["diagnosis"]
        return [
            found["reason"],
            self.summary["inverse"],
            f"Next: {found['next_experiment']}",
            *notes(self.summary["cannot_tell"]),
        ]


def identify_drive(
    dataset: Dataset,
    out: Path | None,
    hold: Hold = "first",
    *,
    force: bool = False,
    step: Steps = SILENT,
) -> DriveResult:
    """Identify and diagnose a drive.

    `drive.toml`, `drive.json` and `runs/ID.parquet` are written into a new folder if there is one.

    Raises
    ------
    InputError
        A recording does not serve (`drive_runs`), or `out` exists and `force` is not set.
    """
    with folder_if(out, force=force) as folder:
        step.ahead(2)
        once = counted_once(dataset)
        runs = drive_runs(once.dataset, hold, once.copied)
        step()
        seen, sheet = frequency_response(runs), drive_sheet(dataset.manifest)
        search = DriveSearch(DriveBench(runs, seen, sheet.stated_frequency), step)
        final = search.run()
        trial, folds = search.trial(final), search.folds
        blocks = [folds.block[folds.run == k] for k in range(len(runs))]
        counted = [np.unique(block, return_inverse=True)[1] for block in blocks]
        fitted = estimates_of(trial, counted, sheet, by_run=folds.by_run)
        found = diagnose_drive(search, final, fitted)
        by_fit, by_nominal = _simulated(search, final), _simulated(search, found.nominal)
        known = fitted | _given(sheet)
        summary = once.dataset.header("identify-harmonic-drive", out) | {
            "hold": hold,
            "structure": {"name": name_of(final), "equation": equation_of(final)},
            "structures": drive_json.structures(search, final),
            "parameters": [e.as_json() for e in known.values()],
            "kinematics": drive_json.kinematics(sheet, fitted),
            "inverse": inverse_of(trial.values),
            "frequency_response": drive_json.response(seen, trial.values),
            "poles": drive_json.pole_rows(trial.values, seen),
            "runs": drive_json.run_rows(search, by_fit, by_nominal),
            "fit": {
                "converged": trial.solution.converged,
                "message": trial.solution.message,
                "evaluations": trial.solution.evaluations,
            },
            "diagnosis": drive_json.diagnosis(search, found),
        }
        summary["cannot_tell"] = [*once.notes, *cannot_tell(summary, sheet, final, known)]
        step()
        simulated = _recordings(once.dataset.runs, search, by_fit, by_nominal)
        if folder is not None:
            write_json(folder / "drive.json", summary)
            structure, of = {"name": name_of(final), "hold": hold}, summary["dataset"]
            write_drive(folder / FILE, known, structure, version=__version__, dataset=of)
            write_runs(folder / "runs", simulated)
    return DriveResult(summary, out, known, found, simulated)


def _given(sheet: DataSheet) -> dict[str, Estimate]:
    stated = {
        "turntable_radius_mm": sheet.turntable_radius_mm,
        "gear_ratio": sheet.gear_ratio,
        "inertia_N_mm_s2": sheet.inertia_N_mm_s2,
    }
    return {
        name: Estimate(name, value, UNITS[name], "data sheet")
        for name, value in stated.items()
        if value is not None
    }


def _simulated(search: DriveSearch, terms: Terms) -> list[Floats]:
    """Return x_in of every run by a set of terms."""
    values = search.trial(terms).values
    return [search.bench.simulated(r, values) for r in range(len(search.bench.runs))]


def _recordings(
    entries: list[Run], search: DriveSearch, fitted: list[Floats], nominal: list[Floats]
) -> dict[str, Recording]:
    """Return the simulated runs."""
    simulated = {}
    each = zip(entries, search.bench.runs, fitted, nominal, strict=True)
    for entry, run, by_fit, by_nominal in each:
        columns = {"time_s": run.time_s, "x_in_mm": by_fit, "x_in_nominal_mm": by_nominal}
        simulated[entry.id] = Recording(entry, columns)
    return simulated
