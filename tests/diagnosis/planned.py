"""Runs that are planned on the rig of Yang 2025, Table 1, as several tests need them."""

from tsas_cli.diagnosis.amplitudes import Visibility
from tsas_cli.diagnosis.further_runs import joined_runs
from tsas_cli.diagnosis.plan import FIRST
from tsas_cli.diagnosis.rig_file import PlannedRun, RigFile
from tsas_cli.diagnosis.simulated_runs import simulated_recordings
from tsas_cli.effects import EFFECTS
from tsas_cli.effects.effect import Effect
from tsas_cli.identification.model import data_sheet
from tsas_cli.identification.prepared import Prepared, prepare
from tsas_cli.recordings.manifest import Manifest
from tsas_studies.challenge.rig.recordings import DATA_SHEET

NOISE = {"x_in_mm": 0.01, "x_out_mm": 0.01, "f_in_N": 0.1, "f_out_N": 0.1}


def run(speed_mm_per_s: float, run_id: str = "a", **changed) -> PlannedRun:
    """Return a sine of 20 mm at a highest speed, or what is changed of it."""
    usual = {
        "id": run_id,
        "sheath_length_mm": 785.4,
        "total_bend_rad": 3.1416,
        "preload_N": 25.0,
        "motion": "sine",
        "amplitude_mm": 10.0,
        "periods": 6,
    }
    return PlannedRun(**usual | {"speed_mm_per_s": speed_mm_per_s} | changed)


def rig_file(*runs: PlannedRun, **noise: float) -> RigFile:
    """Return a file of planned runs at 100 Hz."""
    return RigFile(
        format=1,
        kind="plan",
        name="bench",
        rig=DATA_SHEET,
        sensors={"rate_Hz": 100.0} | NOISE | noise,
        run=runs,
    )


def prepared(file: RigFile) -> tuple[Manifest, list[Prepared]]:
    """Return the runs of a file as if they had been recorded, and the manifest that they make."""
    sheet = {"format": 1, "name": "t", "kind": "simulated", "rig": DATA_SHEET}
    none = {"id": "none", "file": "none", "sha256": "0" * 64}
    model = data_sheet(Manifest.model_validate(sheet | {"run": [none]}))
    recordings = simulated_recordings(file.run, file.sensors, model.rig, FIRST)
    manifest = Manifest.model_validate(sheet | {"run": [r.run for r in recordings]})
    return manifest, [prepare(r, FIRST) for r in recordings]


def seen(
    *runs: PlannedRun, among: tuple[Effect, ...] = EFFECTS, **noise: float
) -> dict[str, Visibility]:
    """Return how each of some causes is seen in some runs, by its name."""
    manifest, there = prepared(rig_file(*runs, **noise))
    model = data_sheet(manifest)
    part = joined_runs(there, [], model, model).part()
    return {s.cause.name: s for s in part.seen(among, among)}
