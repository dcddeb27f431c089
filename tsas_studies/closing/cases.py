"""From diagnosis to tracking, to see whether the better model tracks better.

A plant differs from what the controller knows by a hidden effect. It is recorded while it tracks
with the model of the data sheet, calibrated and diagnosed from these recordings alone, and then
tracks a reference with four models in inverse and feedforward: the data sheet's, the calibrated
one, the extended one, and the plant's own, which is the limit.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import pyarrow as pa

from tsas_cli.controllers import CONTROLLERS
from tsas_cli.identification.model_file import read_model
from tsas_cli.physics.rig import Rig, with_values
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.recordings.writing import write_dataset
from tsas_cli.records.calibration import MODEL_FILE
from tsas_cli.records.closing import ClosedCase, Models, Named, Row
from tsas_cli.records.diagnosis import EXTENDED_MODEL, DiagnosisFile
from tsas_cli.records.drive import DriveDiagnosis
from tsas_cli.records.tracking import Scores
from tsas_cli.stages.calibrate import calibrate
from tsas_cli.stages.diagnose import diagnose
from tsas_cli.stages.identify_harmonic_drive import identify_harmonic_drive
from tsas_cli.tracking.recorded import conditions, manifest, stated_rig, table_of
from tsas_cli.tracking.references import reference
from tsas_cli.tracking.settings import Settings
from tsas_cli.tracking.track import Known, Plant, over_seeds, plan, run_loop
from tsas_studies.closing.drive import known_drives, record_drive

STEPS = 7  # pieces of work of a case
MODELS = ("data sheet", "calibrated", "extended", "true")
RECORDER = "disturbance-observer"
RECORDED_EVERY = 5  # samples of the loop
MOTIONS = {  # shape, mean [N], amplitude [N], angular frequency [rad/s]; 25 s each
    "slow": ("ramps", 43.0, 18.0, 0.5),
    "middle": ("sine", 38.0, 12.0, 1.0),
    "fast": ("two-frequency", 46.0, 14.0, 1.5),
}


@dataclass(frozen=True)
class HiddenCase:
    """A hidden difference of the plant: its name for the table, and the quantities it changes.

    The drive's case changes none: its plant is as ever, and what is known of it is less.
    """

    name: str
    title: str
    hidden: dict[str, float]


CASES = (
    HiddenCase(
        "free_tendon",
        "tendon outside the sheath",
        {"free_tendon.proximal_length_mm": 150.0, "free_tendon.distal_length_mm": 60.0},
    ),
    HiddenCase("friction_drift", "wear during the run", {"friction_drift.rate_per_s": 0.01}),
    HiddenCase("load_friction", "a guide that rubs", {"load_friction.after_sensor_N": 1.0}),
    HiddenCase("backlash", "backlash", {"backlash.play_mm": 0.15}),
    HiddenCase("bend", "a bend that changed after calibration", {"total_bend_rad": 4.0}),
    HiddenCase("drive", "a gear that winds up", {}),
)


def close(
    case: HiddenCase,
    settings: Settings,
    folder: Path,
    seeds: Sequence[int],
    step: Callable[[], None] = lambda: None,
) -> ClosedCase:
    """Record, diagnose and track one case; what the stages write goes into a folder.

    The controllers know the drive, so that what the tendon's model lacks stands alone. `step` is
    called after each piece of work.
    """
    sheet = stated_rig(settings)
    plant = Plant(with_values(sheet, case.hidden), settings.drive.actuator())
    find = _find_drive if case.name == "drive" else _find_tendon
    found, models = find(plant, sheet, settings, folder, step)
    wanted = reference("sine", settings.reference, settings.step_s)
    scores: dict[str, dict[str, Scores]] = {name: {} for name in CONTROLLERS}
    for model, known in zip(MODELS, models, strict=True):
        path = plan(wanted, known, settings)
        for name in CONTROLLERS:
            runs = [
                run_loop(wanted, path, known, plant, name, settings, seed=seed) for seed in seeds
            ]
            scores[name][model] = over_seeds([one.score for one in runs])
        step()
    drive = settings.drive  # of which kinematics do not know
    unknown = {
        "drive_stiffness_N_per_mm": drive.drive_stiffness_N_per_mm,
        "motor_lag_s": drive.motor_lag_s,
    }
    return ClosedCase(
        case=case.name,
        title=case.title,
        hidden=case.hidden or unknown,
        verdict=found.verdict,
        reason=found.reason,
        named=[Named(effect=cause.effect, rivals=cause.rivals) for cause in found.named],
        controllers=[_row(name, by_model) for name, by_model in scores.items()],
    )


def _row(controller: str, by_model: Mapping[str, Scores]) -> Row:
    models = Models.model_validate({name: scores.content() for name, scores in by_model.items()})
    over = models.extended.rmse_N.mean / models.true.rmse_N.mean
    return Row(controller=controller, models=models, over_limit=over)


def _find_tendon(
    plant: Plant, sheet: Rig, settings: Settings, folder: Path, step: Callable[[], None]
) -> tuple[DiagnosisFile, tuple[Known, ...]]:
    """Record, calibrate and diagnose; return the diagnosis and what is known by each model."""
    drive, run = plant.actuator, conditions("track", settings)
    record(plant, Known(sheet, drive), settings, folder / "dataset")
    step()
    dataset = read_dataset(folder / "dataset")
    calibrate(dataset, out=folder / "calibrate")
    step()
    found = diagnose(dataset, model=folder / "calibrate", out=folder / "diagnose").record
    step()
    calibrated = read_model(folder / "calibrate" / MODEL_FILE).rig(run)
    extended = read_model(folder / "diagnose" / EXTENDED_MODEL).rig(run)
    return found, tuple(Known(rig, drive) for rig in (sheet, calibrated, extended, plant.rig))


def _find_drive(
    plant: Plant, sheet: Rig, settings: Settings, folder: Path, step: Callable[[], None]
) -> tuple[DriveDiagnosis, tuple[Known, ...]]:
    """Record and identify the drive; return its diagnosis and what is known by each model."""
    del plant  # its drive is the settings'
    record_drive(settings, folder / "dataset")
    step()
    identified = folder / "identify"
    found = identify_harmonic_drive(folder / "dataset", out=identified, speed="commanded").record
    step()
    drives = known_drives(identified, settings)
    step()
    return found.diagnosis, tuple(Known(sheet, drive) for drive in drives)


def record(plant: Plant, known: Known, settings: Settings, folder: Path) -> None:
    """Track some motions and write what the sensors read as a dataset."""
    tables = {}
    for seed, (name, (shape, mean, amplitude, frequency)) in enumerate(MOTIONS.items(), start=101):
        form = settings.reference.model_copy(
            update={
                "mean_N": mean,
                "amplitude_N": amplitude,
                "angular_frequency_rad_per_s": frequency,
            }
        )
        wanted = reference(shape, form, settings.step_s)
        path = plan(wanted, known, settings)
        run = run_loop(wanted, path, known, plant, RECORDER, settings, seed=seed)
        whole = table_of(run, path, plant.rig, RECORDER, seed, settings)
        tables[name] = whole.take(pa.array(range(0, whole.num_rows, RECORDED_EVERY)))
    folder.mkdir(parents=True)
    write_dataset(folder, manifest(tables, settings), tables)
