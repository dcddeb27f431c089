"""The track stage: controllers on conditions over seeds, their runs and scores in a folder.

The folder is a dataset too: what was recorded can be calibrated and diagnosed.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Literal

import pyarrow as pa

from tsas_cli.controllers import CONTROLLERS
from tsas_cli.drive.file import IdentifiedDrive
from tsas_cli.identification.model import Model
from tsas_cli.identification.model_file import model_of, source_of
from tsas_cli.recordings.dataset import read_from
from tsas_cli.recordings.recording import Recording, recording_of
from tsas_cli.recordings.writing import write_dataset
from tsas_cli.records import tracking as records
from tsas_cli.records.drive import DRIVE_FILE
from tsas_cli.records.result import Result, Table, notes
from tsas_cli.records.tracking import TrackingFile
from tsas_cli.stages.given import Named, at_least, listed, path_of
from tsas_cli.support.errors import InputError, nearest
from tsas_cli.support.files import folder_if
from tsas_cli.support.limits import SEEDS
from tsas_cli.support.steps import NO_PROGRESS, Steps
from tsas_cli.tracking.conditions import Condition, disturbed, printed_rmse, proximal_spring
from tsas_cli.tracking.recorded import (
    conditions,
    dynamic_notes,
    manifest,
    run_notes,
    stated_model,
    table_of,
)
from tsas_cli.tracking.references import reference as reference_of
from tsas_cli.tracking.settings import Settings, known_drive, printed_gains, read_settings
from tsas_cli.tracking.track import Known, Plant, Tracked, over_seeds, plan, run_loop
from tsas_cli.verifying.claims import change_notes

COMPARED_SEEDS = 10


@dataclass(frozen=True, repr=False, eq=False)
class TrackingResult(Result):
    """How well the wanted force is followed; `result["pid-undisturbed"]` is a run.

    `runs` holds, by `controller-condition`, the recording of the first seed: columns of shape (m,),
    among them `f_out_ref_N` (wanted), `f_out_true_N`, `f_out_N` (with noise), `x_in_mm` and
    `motor_speed_rpm` (docs/tracking.md).
    """

    record: TrackingFile  # what `tracking.json` holds
    runs: Mapping[str, Recording]

    def __getitem__(self, run: str) -> Recording:
        """Return a run."""
        return recording_of(self.runs, run)

    def tables(self) -> list[Table]:
        """Return the scores of each controller and condition."""
        return [(self.titled("tracking"), *self.record.scores(records.Spread.text))]

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
        One or several names of `tsas_cli.controllers.CONTROLLERS`, such as `pid`, or `all`;
        docs/tracking.md says what each does.
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
    changes = _conditions(disturb, compare=compare)
    names = CONTROLLERS if compare else _known_controllers(listed(controllers))
    many = COMPARED_SEEDS if compare else 1
    if seeds is not None:
        many = at_least(1, seeds, "seeds", most=SEEDS)
    numbers = range(at_least(0, first_seed, "first_seed"), first_seed + many)
    given, path = path_of(settings, Mapping), path_of(out)
    models = path_of(model, Model), path_of(plant, Model), path_of(drive, IdentifiedDrive)
    read = printed_gains(read_settings(given)) if as_printed else read_settings(given)
    known, real = what_is_known(read, *models)
    followed = Path(str(reference))  # a shape is the name of no file
    wanted = reference_of(str(reference), read.reference, read.step_s)
    drive_path = plan(wanted, known, read)
    made = partial(
        TrackingFile,
        model=source_of(models[0], path),
        plant=source_of(models[1] or models[0], path),
        drive=source_of(models[2], path, DRIVE_FILE, without="kinematics"),
        settings=read.model_dump(mode="json", by_alias=True)
        | ({} if given is None else source_of(given, path)),
        reference=read_from(followed, path or Path())
        if followed.is_file()
        else {"shape": str(reference)},
        dynamics=dynamics,
        gains="as printed" if as_printed else "default",
        seeds=(numbers[0], numbers[-1]),
        conditions={condition.name: condition.changes for condition in changes},
    )
    follow = partial(run_loop, wanted, drive_path, known, dynamics=dynamics, relay=as_printed)
    results, tables = list[records.TrackedResult](), dict[str, pa.Table]()
    inputs = (*models, given, followed)
    with folder_if(path, stage="track", inputs=inputs, force=force) as folder:
        step.ahead(len(names) * len(changes) * many)
        for condition in changes:
            acted_on = condition.of(real)
            for name in names:
                runs = []
                for seed in numbers:
                    runs.append(follow(acted_on, name, read, seed=seed))
                    step()
                printed = None
                if models == (None, None, None):
                    printed = printed_rmse(name, condition, str(reference), read)
                result = _result_of(runs, name, condition.name, printed)
                table = table_of(runs[0], drive_path, acted_on.rig, name, numbers[0], read)
                tables[result.run] = table
                results.append(result)
                each(made(results=results), result.run, table)
        said = [*change_notes(models), *run_notes(drive_path, known, real, results)]
        if dynamics == "lugre":
            said += dynamic_notes(drive_path, real, changes, read.step_s)
        record = made(results=results, notes=said)
        if folder is not None:
            write_dataset(folder, manifest(tables, read), tables)
            record.write(folder)
    recordings = {
        run: Recording(conditions(run, read), {n: table[n].to_numpy() for n in table.column_names})
        for run, table in tables.items()
    }
    return TrackingResult(record.content(), path, record, recordings)


def _conditions(disturb: str | Sequence[str], *, compare: bool) -> list[Condition]:
    """Return the conditions of the plant to track under."""
    asked = [disturbed(listed(disturb))] if disturb else []
    if compare:
        return [Condition("undisturbed"), *(asked or [proximal_spring()])]
    return asked or [Condition("undisturbed")]


def _result_of(
    runs: Sequence[Tracked], controller: str, condition: str, printed_rmse_N: float | None
) -> records.TrackedResult:
    """Return what the runs over all seeds say of a controller under a condition."""
    return records.TrackedResult(
        controller=controller,
        condition=condition,
        run=f"{controller}-{condition}",
        scores=over_seeds([run.score for run in runs]),
        printed_rmse_N=printed_rmse_N,
        relay=any(run.is_relay for run in runs),
        unsettled_steps=sum(run.unsettled for run in runs),
    )


def _known_controllers(named: Sequence[str]) -> Sequence[str]:
    """Return the controllers by name, each once, or all; an unknown one is an InputError."""
    if not named:
        raise InputError("no controller is named", expected=f"some of {', '.join(CONTROLLERS)}")
    if named == ["all"]:
        return CONTROLLERS
    for name in named:
        if name not in CONTROLLERS:
            raise InputError(f"unknown controller {name}", remedy=nearest(name, CONTROLLERS))
    return list(dict.fromkeys(named))


def what_is_known(
    settings: Settings,
    model: Model | Path | None = None,
    plant: Model | Path | None = None,
    drive: IdentifiedDrive | Path | None = None,
) -> tuple[Known, Plant]:
    """Return what the controller knows of rig and drive, and the plant that it acts on.

    InputError: a model file is wrong, or has two tendons.
    """
    run, stated = conditions("track", settings), stated_model(settings)
    known = stated if model is None else model_of(model).over(stated)
    real = known if plant is None else model_of(plant).over(stated)
    for which in (known, real):
        if which.rig(run).effects.antagonist.preload_N != 0.0:
            raise InputError(
                "antagonist is in the model, and plant and controllers have one tendon",
                remedy="leave out the antagonist's lines of the model file",
            )
    actuator = known_drive(drive, settings.drive)
    return Known(known.rig(run), actuator), Plant(real.rig(run), settings.drive.actuator())
