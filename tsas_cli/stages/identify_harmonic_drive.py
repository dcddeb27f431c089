"""The identify-harmonic-drive stage: `drive.toml`, `drive.json` and the simulated x_in."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Literal

from tsas_cli.drive import json as drive_json
from tsas_cli.drive.diagnosis import diagnose_drive
from tsas_cli.drive.estimates import drive_sheet, estimates_of
from tsas_cli.drive.file import UNITS, IdentifiedDrive, drive_of, write_drive
from tsas_cli.drive.fit import DriveBench, Terms
from tsas_cli.drive.json import tables
from tsas_cli.drive.runs import drive_runs, frequency_response
from tsas_cli.drive.search import DriveSearch, find_terms
from tsas_cli.drive.sentences import cannot_tell, equation_of, inverse_of, name_of
from tsas_cli.identification.estimate import Estimate
from tsas_cli.numerics.linear_response import Hold
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.quality.copies.deduplicated import without_duplicates
from tsas_cli.recordings.recording import Recording, recording_of
from tsas_cli.recordings.writing import write_runs
from tsas_cli.records.base import Fit, parameters_of
from tsas_cli.records.drive import DRIVE_FILE, DriveDiagnosis, DriveFile, Structure
from tsas_cli.records.result import Result, Table, notes
from tsas_cli.stages.given import Named, dataset_of, path_of
from tsas_cli.support.arrays import Floats
from tsas_cli.support.files import folder_if
from tsas_cli.support.steps import NO_PROGRESS, Steps

HOLDS: dict[str, Hold] = {"measured": "first", "commanded": "zero"}
STAGE = "identify-harmonic-drive"
_OF_SHEET = ("turntable_radius_mm", "gear_ratio", "inertia_N_mm_s2")


@dataclass(frozen=True, repr=False, eq=False)
class DriveResult(Result):
    """An identified drive, what the nominal drive equation lacks, and the simulated runs.

    `runs` holds them by id: columns of shape (n,) as in the recording, `x_in_mm` and that of the
    nominal drive, `x_in_nominal_mm` [mm].
    """

    record: DriveFile  # what `drive.json` holds
    estimates: Mapping[str, Estimate]  # fitted, derived, or of the data sheet
    runs: Mapping[str, Recording]

    @property
    def diagnosis(self) -> DriveDiagnosis:
        """The verdict on the nominal drive equation, with causes and gains on held-out data."""
        return self.record.diagnosis

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
        title = self.titled(self.record.structure.equation, DRIVE_FILE)
        return list(tables(self.record, title))

    def sentences(self) -> list[str]:
        """Return the verdict, the inverse, what to measure next, and what is not identifiable."""
        return [
            self.diagnosis.reason,
            self.record.inverse,
            f"Next: {self.diagnosis.next_experiment}",
            *notes(self.record.cannot_tell),
        ]


def identify_harmonic_drive(
    dataset: Dataset | Named,
    *,
    out: Named | None = None,
    speed: Literal["measured", "commanded"] = "measured",
    runs: Iterable[str] | None = None,
    force: bool = False,
    step: Steps = NO_PROGRESS,
) -> DriveResult:
    """Fit the drive from motor speed [rpm] to x_in [mm], diagnose it, and give its feedforward.

    Parameters
    ----------
    dataset
        A dataset, or its folder, with `x_in_mm` and `motor_speed_rpm` or `motor_angle_rad`, whose
        central differences are the speed then.
    out
        Where to write `drive.toml`, `drive.json` and `runs/ID.parquet`; None writes nothing.
    speed
        What `motor_speed_rpm` holds. `measured`: linear between samples; `commanded`: kept until
        the next one.
    runs
        The ids of the runs that are taken; all without it.
    force
        Replace the folder if it is there.
    step
        Called for every structure; the number of them grows with the findings.

    Returns
    -------
    DriveResult
        `.estimates` by name, with units and 95 % intervals; `.drive` for `track`; `.diagnosis`;
        `result["chirp"].columns` holds the simulated `x_in_mm` and `x_in_nominal_mm`, shape (n,).

    Raises
    ------
    InputError
        A recording does not serve, or `out` exists and `force` is not set.
    """
    hold, data, path = HOLDS[speed], dataset_of(dataset, runs), path_of(out)
    with folder_if(path, stage=STAGE, inputs=[data.folder], force=force) as folder:
        step.ahead(2)
        counted = without_duplicates(data)
        prepared = drive_runs(counted.dataset, hold, counted.copied)
        step()
        seen, sheet = frequency_response(prepared), drive_sheet(data.manifest)
        search = DriveSearch(DriveBench(prepared, seen, sheet.stated_frequency), step)
        final = find_terms(search)
        trial, folds = search.trial(final), search.folds
        blocks = folds.blocks_of_runs(len(prepared))
        fitted = estimates_of(trial, blocks, sheet, by_run=folds.by_run)
        nominal, found = diagnose_drive(search, final, fitted)
        by_fit, by_nominal = _simulated(search, final), _simulated(search, nominal)
        known = dict(fitted)
        for name in _OF_SHEET:
            if (stated := getattr(sheet, name)) is not None:
                known[name] = Estimate(name, stated, UNITS[name], "data sheet")
        record = DriveFile(
            **counted.dataset.header(path),
            hold=hold,
            structure=Structure(name=name_of(final), equation=equation_of(final)),
            structures=drive_json.structure_rows(search, final),
            parameters=parameters_of(known.values()),
            kinematics=drive_json.kinematics(sheet, fitted),
            inverse=inverse_of(trial.values),
            frequency_response=drive_json.response(seen, trial.values),
            poles=drive_json.pole_rows(trial.values, seen),
            runs=drive_json.run_rows(search, by_fit, by_nominal),
            fit=Fit.model_validate(trial.solution, from_attributes=True),
            diagnosis=found,
        )
        notes = (*counted.notes, *cannot_tell(record, sheet, final, known.values()))
        record = record.model_copy(update={"cannot_tell": notes})
        step()
        each = zip(counted.dataset.runs, search.bench.runs, by_fit, by_nominal, strict=True)
        simulated = {
            entry.id: Recording(
                entry, {"time_s": run.time_s, "x_in_mm": fit, "x_in_nominal_mm": of_nominal}
            )
            for entry, run, fit, of_nominal in each
        }
        if folder is not None:
            record.write(folder)
            structure, of = {"name": name_of(final), "hold": hold}, record.dataset.content()
            write_drive(folder / DRIVE_FILE, known, structure, version=record.version, dataset=of)
            write_runs(folder / "runs", simulated)
    return DriveResult(record.content(), path, record, known, simulated)


def _simulated(search: DriveSearch, terms: Terms) -> list[Floats]:
    """Return x_in of every run by a set of terms."""
    values = search.trial(terms).values
    return [search.bench.simulated(r, values) for r in range(len(search.bench.runs))]
