"""The track stage: controllers on conditions over seeds, their runs and scores in a folder.

The folder is a dataset too: what was recorded can be calibrated and diagnosed.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pyarrow as pa

from tsas_cli.controllers import CONTROLLERS
from tsas_cli.controllers.path import DrivePath
from tsas_cli.drive.file import IdentifiedDrive
from tsas_cli.identification.model import Model, model_of, source_of
from tsas_cli.recordings.dataset import read_from
from tsas_cli.recordings.recording import Recording, recording_of
from tsas_cli.recordings.writing import write_dataset
from tsas_cli.records import tracking as records
from tsas_cli.records.base import number_text
from tsas_cli.records.drive import DRIVE_FILE
from tsas_cli.records.result import Result, Table, notes
from tsas_cli.records.tracking import TrackingFile
from tsas_cli.stages.given import Named, at_least, listed, number_of_seeds, one_of, path_of
from tsas_cli.support.errors import InputError, nearest
from tsas_cli.support.files import folder_if
from tsas_cli.support.steps import NO_PROGRESS, Steps
from tsas_cli.tracking.conditions import Condition, disturbed, proximal_spring
from tsas_cli.tracking.drives import known_drive
from tsas_cli.tracking.dynamic_notes import dynamic_notes
from tsas_cli.tracking.recorded import conditions, manifest, stated_model, table_of
from tsas_cli.tracking.references import reference as reference_of
from tsas_cli.tracking.scores import over_seeds
from tsas_cli.tracking.settings import Settings, printed_gains, read_settings
from tsas_cli.tracking.table_5 import printed_rmse
from tsas_cli.tracking.track import (
    Known,
    Plant,
    TendonDynamics,
    Tracked,
    feedforward,
    plan,
    run_loop,
)

DYNAMICS: tuple[TendonDynamics, ...] = ("slip", "lugre")
COMPARED_SEEDS = 10

COLUMNS = (
    ("RMSE [N]", "rmse_N"),
    ("lowest [N]", "lowest_error_N"),
    ("highest [N]", "highest_error_N"),
    ("effort [rpm]", "effort_rpm"),
    ("chatter [rpm/s]", "chatter_rpm_per_s"),
    ("outside 2 % [%]", "outside_percent"),
)
OFTEN_PERCENT = 5.0  # of the time at the motor's limit, from which it is said


@dataclass(frozen=True)
class Call:
    """What the stage is asked for; see `tsas track --help`."""

    model: Model | Path | None = None
    plant: Model | Path | None = None
    drive: IdentifiedDrive | Path | None = None
    settings: Path | Mapping[str, Any] | None = None
    controllers: tuple[str, ...] = ("adaptive-sliding-mode",)
    conditions: tuple[Condition, ...] = (Condition("undisturbed"),)
    reference: str = "sine"
    as_printed: bool = False
    dynamics: TendonDynamics = "slip"
    seeds: int = 1
    first_seed: int = 1

    def inputs(self) -> tuple[object, ...]:
        """Return what the stage reads; a reference's shape is the name of no file."""
        return self.model, self.plant, self.drive, self.settings, Path(self.reference)


@dataclass(frozen=True, repr=False, eq=False)
class TrackingResult(Result):
    """How well the wanted force is followed; `result["pid-undisturbed"]` is a run.

    Parameters
    ----------
    record
        What `tracking.json` holds.
    runs
        By `controller-condition` the recording of the first seed: columns of shape (m,), among
        them `f_out_ref_N` (wanted), `f_out_true_N`, `f_out_N` (with noise), `x_in_mm` and
        `motor_speed_rpm` (docs/tracking.md).
    """

    record: TrackingFile
    runs: Mapping[str, Recording]

    def __getitem__(self, run: str) -> Recording:
        """Return a run."""
        return recording_of(self.runs, run)

    def tables(self) -> list[Table]:
        """Return the scores, one row for each controller and condition."""
        return [_table(self.record.results, self.titled("tracking"))]

    def sentences(self) -> list[str]:
        """Return what of the runs is not to be trusted or not to be reached, and why."""
        return notes(self.record.notes)


def track(
    *,
    out: Named | None = None,
    model: Model | Named | None = None,
    plant: Model | Named | None = None,
    drive: IdentifiedDrive | Named | None = None,
    controllers: str | Sequence[str] = "adaptive-sliding-mode",
    compare: bool = False,
    reference: Named = "sine",
    disturb: str | Sequence[str] = (),
    as_printed: bool = False,
    dynamics: Literal["slip", "lugre"] = "slip",
    settings: Mapping[str, Any] | Named | None = None,
    seeds: int | None = None,
    first_seed: int = 1,
    force: bool = False,
    step: Steps = NO_PROGRESS,
    each: Callable[[TrackingFile, str, pa.Table], None] = lambda *_: None,
) -> TrackingResult:
    """Follow a wanted force with a controller that sees x_in alone.

    Parameters
    ----------
    out
        Where to write the runs as a dataset, and `tracking.json`; None writes nothing.
    model
        What the controller knows of the rig, or its file; the paper's rig without it.
    plant
        What the controller acts on, or its file; the same as `model` without it.
    drive
        What the controller knows of the drive, or its file; kinematics without it.
    controllers
        One or several of `pid`, `sliding-mode`, `adaptive-sliding-mode`, `disturbance-observer`,
        or `all`.
    compare
        All controllers, with and without a disturbance, over 10 seeds.
    reference
        `sine`, `two-frequency`, `steps`, `ramps`, or a Parquet file with `f_out_ref_N`.
    disturb
        Changes of the plant, `NAME=VALUE`, from S seconds on with `NAME=VALUE@S`.
    as_printed
        ks of the sliding modes per mm as the paper prints it, which makes a relay.
    dynamics
        The plant's tendon. `slip`: quasi-static; `lugre`: dynamic.
    settings
        A file with rig, drive, sensors, reference and gains, or its content (docs/tracking.md).
    seeds
        How many seeds of noise; 1 without it, 10 with `compare`.
    first_seed
        The first of them.
    force
        Replace the folder if it is there.
    step
        Called once for each run.
    each
        Called for each recording with the record so far, its name and its table.

    Returns
    -------
    TrackingResult
        `result["pid-undisturbed"].columns` holds the run of the first seed, arrays of shape (m,):
        `time_s`, `f_out_ref_N` (wanted), `f_out_true_N`, `x_in_mm`, `motor_speed_rpm`, …;
        `.record.results` holds the scores, in N and rpm.

    Raises
    ------
    InputError
        A file is wrong, a controller unknown, the reference out of reach, the loop unstable, or
        `out` exists and `force` is not set.
    """
    named = tuple(listed(controllers))
    if not named:
        raise InputError("no controller is named", expected=f"some of {', '.join(CONTROLLERS)}")
    asked = [disturbed(listed(disturb))] if disturb else []
    if compare:
        asked = [Condition("undisturbed"), *(asked or [proximal_spring()])]
    call = Call(
        model=path_of(model, Model),
        plant=path_of(plant, Model),
        drive=path_of(drive, IdentifiedDrive),
        settings=path_of(settings, Mapping),
        controllers=CONTROLLERS if compare or named == ("all",) else tuple(dict.fromkeys(named)),
        conditions=tuple(asked) or (Condition("undisturbed"),),
        reference=str(reference),
        as_printed=as_printed,
        dynamics=one_of(DYNAMICS, dynamics, "dynamics"),
        seeds=(COMPARED_SEEDS if compare else 1) if seeds is None else number_of_seeds(seeds),
        first_seed=at_least(0, first_seed, "first_seed"),
    )
    folder_path = path_of(out)
    for name in call.controllers:
        if name not in CONTROLLERS:
            raise InputError(f"unknown controller {name}", remedy=nearest(name, CONTROLLERS))
    read = read_settings(call.settings)
    if call.as_printed:
        read = printed_gains(read)
    known, real = what_is_known(call, read)
    wanted = reference_of(call.reference, read.reference, read.step_s)
    path = plan(wanted, known, read)
    results, tables = list[records.TrackedResult](), dict[str, pa.Table]()
    record_with = _record_with(call, read, folder_path)
    with folder_if(folder_path, stage="track", inputs=call.inputs(), force=force) as folder:
        step.ahead(len(call.controllers) * len(call.conditions) * call.seeds)
        for condition in call.conditions:
            acted_on = condition.of(real)
            for name in call.controllers:
                runs = []
                for one in range(call.first_seed, call.first_seed + call.seeds):
                    run = run_loop(
                        wanted,
                        path,
                        known,
                        acted_on,
                        name,
                        read,
                        one,
                        dynamics=call.dynamics,
                        relay=call.as_printed,
                    )
                    runs.append(run)
                    step()
                run_id = f"{name}-{condition.name}"
                first, number = runs[0], call.first_seed
                tables[run_id] = table_of(first, path, acted_on.rig, name, number, read)
                printed = None
                if call.model is None and call.plant is None and call.drive is None:
                    printed = printed_rmse(name, condition, call.reference, read)
                results.append(_result(run_id, name, condition, runs, printed))
                each(record_with(results=results), run_id, tables[run_id])
        said = _notes(path, known, real, results)
        if call.dynamics == "lugre":
            said += dynamic_notes(path, real, call.conditions, read.step_s)
        record = record_with(results=results, notes=said)
        if folder is not None:
            write_dataset(folder, manifest(tables, read), tables)
            record.write(folder)
    return TrackingResult(record.content(), folder_path, record, _recordings(tables, read))


def _recordings(tables: Mapping[str, pa.Table], settings: Settings) -> dict[str, Recording]:
    return {
        run: Recording(
            conditions(run, settings), {name: table[name].to_numpy() for name in table.column_names}
        )
        for run, table in tables.items()
    }


def what_is_known(call: Call, settings: Settings) -> tuple[Known, Plant]:
    """Return what the controller knows of rig and drive, and the plant that it acts on.

    Raises
    ------
    InputError
        A model file is wrong.
    """
    run = conditions("track", settings)
    stated = stated_model(settings)
    model = stated if call.model is None else model_of(call.model).over(stated)
    real = model if call.plant is None else model_of(call.plant).over(stated)
    actuator = settings.drive.actuator()
    return Known(model.rig(run), known_drive(call.drive, settings.drive)), Plant(
        real.rig(run), actuator
    )


def _result(
    run_id: str, name: str, condition: Condition, runs: list[Tracked], printed: float | None
) -> records.TrackedResult:
    return records.TrackedResult(
        controller=name,
        condition=condition.name,
        run=run_id,
        scores=over_seeds([run.score for run in runs]),
        printed_rmse_N=printed,
        relay=any(run.is_relay for run in runs),
        unsettled_steps=sum(run.unsettled for run in runs),
    )


def _record_with(call: Call, settings: Settings, out: Path | None) -> "partial[TrackingFile]":
    """Return what makes the record of a call, once there are results."""
    stated = settings.model_dump(mode="json", by_alias=True)
    if call.settings is not None:
        stated |= source_of(call.settings, out)
    wanted = Path(call.reference)
    shape = {"shape": call.reference}
    return partial(
        TrackingFile,
        model=source_of(call.model, out),
        plant=source_of(call.plant or call.model, out),
        drive=source_of(call.drive, out, DRIVE_FILE, without="kinematics"),
        settings=stated,
        reference=read_from(wanted, out or Path()) if wanted.is_file() else shape,
        dynamics=call.dynamics,
        gains="as printed" if call.as_printed else "default",
        seeds=(call.first_seed, call.first_seed + call.seeds - 1),
        conditions={
            condition.name: [
                records.ConditionChange(quantity=c.name, value=c.value, from_s=c.from_s)
                for c in condition.changes
            ]
            for condition in call.conditions
        },
    )


def _notes(
    path: DrivePath, known: Known, plant: Plant, results: Sequence[records.TrackedResult]
) -> list[str]:
    """Return what of the runs is not to be trusted or not to be reached, and why."""
    notes = []
    if path.missed:
        notes.append(f"{path.missed} samples of the wanted force are met by no place of the drive")
    limit = plant.actuator.speed_limit_rpm
    beyond = np.abs(feedforward(path, known.actuator)) > limit
    if beyond.any():
        notes.append(
            f"the reference asks for more than the motor's {limit:g} rpm in {beyond.sum()} samples,"
            f" up to {np.abs(feedforward(path, known.actuator)).max():.0f} rpm"
        )
    for result in results:
        at_limit = result.scores.at_limit_percent.mean or 0.0
        if at_limit > OFTEN_PERCENT:
            notes.append(
                f"{result.run}: the motor is at its limit for {at_limit:.0f} % of the time"
                + ("; the loop is a relay" if result.relay else "")
            )
        if result.unsettled_steps:
            notes.append(
                f"{result.run}: {result.unsettled_steps} steps of the tendon did not settle"
            )
    return notes


def _table(results: Sequence[records.TrackedResult], title: str) -> Table:
    """Return the scores; what Table 5 of the paper prints stands beside them where it applies."""
    header = ["controller", "condition", *(name for name, _ in COLUMNS)]
    rows = [
        [row.controller, row.condition, *(row.scores[key].text() for _, key in COLUMNS)]
        for row in results
    ]
    printed = [row.printed_rmse_N for row in results]
    if any(value is not None for value in printed):
        header.insert(3, "Table 5 [N]")
        for row, value in zip(rows, printed, strict=True):
            row.insert(3, number_text(value, "g"))
    return title, header, rows
