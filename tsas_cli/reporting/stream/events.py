"""What happens in a run: its phases, and the faults that a check has found."""

from collections.abc import Sequence

import numpy as np
import rerun as rr

from tsas_cli.recordings.quality.finding import Finding
from tsas_cli.records.base import PhaseSegment
from tsas_cli.records.check import CheckFile
from tsas_cli.reporting.colours import dark
from tsas_cli.reporting.phases import BY_KEY, PHASES
from tsas_cli.reporting.stream.recorder import Recorder
from tsas_cli.reporting.stream.seen import SeenRun

_LEVELS = {"error": "ERROR", "warning": "WARN"}


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
