"""What a run holds over time: channels, what models answer, what is left, phases, faults.

A column of a file is read once, recorded, and forgotten.
"""

from collections.abc import Sequence

import numpy as np
import rerun as rr

from tsas_cli.recordings.quality.finding import Finding
from tsas_cli.records.base import PhaseSegment
from tsas_cli.records.check import CheckFile
from tsas_cli.reporting.colours import dark, role_of_controller
from tsas_cli.reporting.phases import BY_KEY, PHASES
from tsas_cli.reporting.stream.loops import LoopPlane
from tsas_cli.reporting.stream.recorder import Entity, Recorder
from tsas_cli.reporting.stream.seen import MEASURED, RESIDUAL, WANTED, SeenRun
from tsas_cli.reporting.tracking import runs as tracked

_LEVELS = {"error": "ERROR", "warning": "WARN"}
FORCE, ERROR, SPEED = "f_out_N", "tracking_error_N", "motor_speed_rpm"
STATES = {  # that a controller keeps: the axis of each column
    "error_sum_mm_s": "sum of the error ∫e dt [mm s]",
    "sliding_distance_mm_per_s2": "sliding variable s [mm/s²]",
    "phi1_rpm_s3_per_mm": "estimate φ̂1 [rpm s³/mm]",
    "phi2_rpm_s_per_mm": "estimate φ̂2 [rpm s/mm]",
    "phi3_rpm_s2_per_mm": "estimate φ̂3 [rpm s²/mm]",
    "error_estimate_mm": "estimated error [mm]",
    "disturbance_rpm": "estimated disturbance d [rpm]",
}
_ROLES = {MEASURED: "measured", WANTED: "ink"}
_WIDTHS = {MEASURED: 2.5, WANTED: 1.5}  # what is measured shows under what covers it


def series_of(run: SeenRun) -> dict[str, list[Entity]]:
    """Return the entities of all series, by the column that they are shown with."""
    found: dict[str, list[Entity]] = {}
    for channel in run.channels:
        keys = (channel.key, *(source.key for source in channel.sources))
        found.setdefault(channel.quantity, []).extend(
            run.entity(channel.quantity, key) for key in keys
        )
    if run.tracked is not None:
        found[FORCE].append(run.entity(FORCE, "true"))
    return found


def residuals_of(run: SeenRun) -> dict[str, list[Entity]]:
    """Return the entities of the residuals by column."""
    found = {
        channel.column: [
            run.entity(channel.column, RESIDUAL, source.key)
            for source in channel.sources
            if not source.cleaned
        ]
        for channel in run.channels
    }
    return {column: entities for column, entities in found.items() if entities}


def record_channels(recorder: Recorder, run: SeenRun) -> None:
    """Record the channels of one run, its residuals and its loops; of series all samples."""
    controller = None if run.tracked is None else run.tracked.controller
    for channel in run.channels:
        measured, name, colour = run.measured(channel.column), channel.key, _ROLES[channel.key]
        if controller and channel.column == SPEED:  # which a controller asks for
            name, colour = controller, role_of_controller(controller)
        entity, width = run.entity(channel.quantity, channel.key), _WIDTHS[channel.key]
        recorder.series(entity, run.times, measured, name, dark(colour), width=width)
        loop = LoopPlane.of(recorder, run, channel, measured) if channel in run.loops else None
        for number, source in enumerate(channel.sources):
            values = run.predicted(channel.column, source)
            series = {run.entity(channel.column, source.key): values}
            if not source.cleaned:
                residual = run.entity(channel.column, RESIDUAL, source.key)
                series[residual] = measured - values
            for entity, samples in series.items():
                recorder.series(entity, run.times, samples, source.label, dark(source.role))
            if loop is not None:
                loop.record(source.key, values, dark(source.role), order=2.0 + number)
        recorder.settle()


def record_tracking(recorder: Recorder, run: SeenRun) -> None:
    """Record what a tracked run holds beside its sensors; nothing for any other run."""
    if run.tracked is None:
        return
    name = run.tracked.controller
    wanted, true = run.file.read(tracked.WANTED), run.file.read(tracked.TRUE)
    kept = {run.entity(FORCE, "true"): true, run.entity(ERROR): wanted - true}
    kept |= {run.entity(state): run.file.read(state) for state in STATES if state in run.file.names}
    for entity, values in kept.items():
        recorder.series(entity, run.times, values, name, dark(role_of_controller(name)))


def faults_of(run: SeenRun) -> list[Finding]:
    """Return what a check found in a run."""
    check = run.inputs.get(CheckFile)
    return [] if check is None else [f for f in check.findings if f.run == run.id]


def record_faults(recorder: Recorder, run: SeenRun) -> None:
    """Record the faults of a run; one of the whole run stands at its start."""
    if faults := faults_of(run):
        start_s = float(run.time_s[0])
        at_s = [start_s if f.first_s is None else f.first_s for f in faults]
        said = rr.TextLog.columns(
            text=[
                f"{at:.3f} s: {f.code}: {f.sentence}" for at, f in zip(at_s, faults, strict=True)
            ],
            level=[_LEVELS.get(fault.severity, "INFO") for fault in faults],
        )
        recorder.columns(run.entity("faults"), run.at(np.array(at_s)), said)


def record_phases(recorder: Recorder, run: SeenRun) -> None:
    """Record when each phase begins, and where the last one ends; nothing without segments."""
    if not run.segments:
        return
    look = rr.StateConfiguration(
        values=[phase.key for phase in PHASES],
        labels=[phase.label for phase in PHASES],
        colors=[dark(phase.colour) for phase in PHASES],
    )
    starts, keys = _changes(run.segments)
    recorder.static(run.entity("phase"), look)
    states = rr.StateChange.columns(state=keys)
    recorder.columns(run.entity("phase"), run.at(np.array(starts)), states)


def _changes(segments: Sequence[PhaseSegment]) -> tuple[list[float], list[str]]:
    """Return when which phase begins [s]; a stretch in none begins with an empty name."""
    starts: list[float] = []
    keys: list[str] = []
    for segment, after in zip(segments, (*segments[1:], None), strict=True):
        starts.append(segment.start_s)
        keys.append(segment.phase if segment.phase in BY_KEY else "unknown")
        if after is None or after.start_s > segment.end_s:
            starts.append(segment.end_s)
            keys.append("")
    return starts, keys
