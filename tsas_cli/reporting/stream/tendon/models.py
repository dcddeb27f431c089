"""The tendon of a run, followed again with the models that the stages wrote down."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import cast

from tsas_cli.identification.model import Model, read_model
from tsas_cli.identification.prepared import drive_of, prepare, seconds_into
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.response import Dynamics
from tsas_cli.recordings.columns import nominal_name
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.run_files import read_recording
from tsas_cli.records.base import StageFile
from tsas_cli.records.calibration import MODEL_FILE
from tsas_cli.records.diagnosis import EXTENDED_MODEL, NOMINAL_MODEL, DiagnosisFile
from tsas_cli.records.simulation import SimulationFile
from tsas_cli.reporting.stream.seen import X_IN, SeenRun
from tsas_cli.reporting.stream.sources import EXTENDED, NOMINAL, SIMULATED, Which
from tsas_cli.reporting.stream.tendon.followed import TendonStates, follow

F_IN, F_OUT = "f_in_N", "f_out_N"


@dataclass(frozen=True)
class TendonModels:
    """The models that a stage followed a run with, and how."""

    stage: type[StageFile]
    models: Mapping[Which, Model]
    dynamics: Dynamics
    nodes: int | None


def models_of(run: SeenRun) -> TendonModels | None:
    """Return both models of a diagnosis, else the simulated one.

    None where neither stage took the run or wrote its models, and for the lumped model, which
    does not say what is along the tendon.

    Raises
    ------
    InputError
        A model's file cannot be read.
    """
    diagnosis, simulation = run.inputs.get(DiagnosisFile), run.inputs.get(SimulationFile)
    stage: type[StageFile] = DiagnosisFile
    dynamics, nodes = "slip", None
    if diagnosis is not None:
        files = {NOMINAL: NOMINAL_MODEL} | ({EXTENDED: EXTENDED_MODEL} if diagnosis.named else {})
    elif simulation is not None and simulation.dynamics != "static":
        stage, files = SimulationFile, {SIMULATED: MODEL_FILE}
        dynamics, nodes = simulation.dynamics, simulation.nodes
    else:
        return None
    paths = {which: run.inputs.folders[stage] / file for which, file in files.items()}
    if not run.inputs.written_columns(run.id, stage) or not all(
        p.is_file() for p in paths.values()
    ):
        return None
    models = {which: read_model(path) for which, path in paths.items()}
    return TendonModels(stage, models, cast("Dynamics", dynamics), nodes)


def tendons_of(run: SeenRun) -> dict[Which, TendonStates]:
    """Return the run followed with the models that a stage wrote; none where it wrote none.

    Raises
    ------
    InputError
        A file cannot be read, or is not what it was.
    """
    given = models_of(run)
    if given is None:
        return {}
    there, rows = run.inputs.written_columns(run.id, given.stage), run.file.rows
    columns = [c for name in (F_IN, F_OUT) for c in (name, nominal_name(name)) if c in there]
    tensions = [run.inputs.series(run.id, rows, name, given.stage) for name in columns]
    drive = _drive(run, given.stage)
    return follow(
        run.file.run, run.time_s, drive, given.models, tensions, given.dynamics, given.nodes
    )


def _drive(run: SeenRun, stage: type[StageFile]) -> DriveInput:
    """Return what drives the run, as the stage has conditioned it, where it has written it down."""
    dataset = cast("Dataset", run.inputs.dataset)
    started, entry = dataset.manifest.session_start, run.file.run
    if entry.load != "spring" or X_IN not in run.file.names:
        return prepare(read_recording(dataset.folder, entry), started).drive
    return drive_of(
        entry,
        run.time_s,
        run.inputs.series(run.id, run.file.rows, X_IN, stage),
        by_force=False,
        load_values=None,
        f_in_N=run.measured(F_IN) if F_IN in run.file.names else None,
        session_s=seconds_into(started, entry.started),
    )
