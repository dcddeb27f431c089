"""The tendon of a run, followed again with the models that the stages wrote down."""

from pathlib import Path
from typing import cast

from tsas_cli.identification.model import FILE, read_model
from tsas_cli.identification.prepared import drive_of, prepare, seconds_into
from tsas_cli.physics.ends import Drive
from tsas_cli.physics.response import Dynamics
from tsas_cli.recordings.columns import nominal_name
from tsas_cli.recordings.dataset import Dataset, read_recording
from tsas_cli.reporting.stage_files import Diagnosis, Simulation, StageFile
from tsas_cli.reporting.stream.seen import X_IN, SeenRun
from tsas_cli.reporting.tendon.followed import (
    EXTENDED,
    NOMINAL,
    SIMULATED,
    Followed,
    Which,
    follow,
)

F_IN, F_OUT = "f_in_N", "f_out_N"


def tendons_of(run: SeenRun) -> dict[Which, Followed]:
    """Return the run followed with both models of a diagnosis, else with the simulated one.

    None where neither stage took the run, or wrote no model.

    Raises
    ------
    InputError
        A file cannot be read, or is not what it was.
    """
    diagnosis, simulation = run.inputs.get(Diagnosis), run.inputs.get(Simulation)
    if diagnosis is not None:
        shown = (NOMINAL, EXTENDED) if diagnosis.named else (NOMINAL,)
        return _followed(run, Diagnosis, shown)
    if simulation is not None:
        dynamics = cast("Dynamics", simulation.dynamics)
        return _followed(run, Simulation, (SIMULATED,), dynamics, simulation.nodes)
    return {}


def _followed(
    run: SeenRun,
    stage: type[StageFile],
    shown: tuple[Which, ...],
    dynamics: Dynamics = "slip",
    nodes: int | None = None,
) -> dict[Which, Followed]:
    files = {which: run.inputs.folders[stage] / _file(which) for which in shown}
    there = run.inputs.answered(run.id, stage)
    if not there or not all(path.is_file() for path in files.values()):
        return {}
    models = {which: read_model(path) for which, path in files.items()}
    columns = [c for name in (F_IN, F_OUT) for c in (name, nominal_name(name)) if c in there]
    answers = [run.inputs.answer(run.id, run.file.rows, name, stage) for name in columns]
    drive = _drive(run, stage)
    return follow(run.file.run, run.time_s, drive, models, answers, dynamics, nodes)


def _file(which: Which) -> str:
    from tsas_cli.diagnosis.diagnose_stage import EXTENDED as EXTENDED_FILE
    from tsas_cli.diagnosis.diagnose_stage import NOMINAL as NOMINAL_FILE

    return {NOMINAL: NOMINAL_FILE, EXTENDED: EXTENDED_FILE, SIMULATED: FILE}[which]


def _drive(run: SeenRun, stage: type[StageFile]) -> Drive:
    """Return what drives the run, as the stage has conditioned it, where it has written it down."""
    dataset = cast("Dataset", run.inputs.dataset)
    started, told = dataset.manifest.session_start, run.file.run
    if told.load != "spring" or X_IN not in run.file.names:
        return prepare(read_recording(Path(dataset.folder), told), started).drive
    return drive_of(
        told,
        run.time_s,
        run.inputs.answer(run.id, run.file.rows, X_IN, stage),
        by_force=False,
        load_values=None,
        f_in_N=run.measured(F_IN) if F_IN in run.file.names else None,
        session_s=seconds_into(started, told.started),
    )
