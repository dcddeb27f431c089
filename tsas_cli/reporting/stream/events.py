"""What happens in a run: phases, the drive turns, a check finds a fault, a front comes through."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import rerun as rr

from tsas_cli.recordings.quality.finding import Finding
from tsas_cli.records.base import PhaseSegment
from tsas_cli.records.check import CheckFile
from tsas_cli.reporting.colours import dark
from tsas_cli.reporting.phases import BY_KEY, PHASES
from tsas_cli.reporting.stream.recorder import Entity, Recorder
from tsas_cli.reporting.stream.seen import X_IN, SeenRun

REVERSALS = "reversals"
ENDS = ""  # a state that ends the last one
_UP = {"contraction": True, "dead_band_up": True, "loosening": False, "dead_band_down": False}
_LEVELS = {"error": "ERROR", "warning": "WARN"}


@dataclass(frozen=True)
class Event:
    """Something that happens at one time of a run; `level` is INFO, WARN or ERROR."""

    at_s: float
    text: str
    level: str = "INFO"


def events_of(run: SeenRun) -> Entity:
    """Return the entity under which a run's events are."""
    return run.entity("events")


def happens(run: SeenRun) -> bool:
    """Say whether a run has events that are known before its samples are read."""
    return bool(reversals(run.segments) or faults_of(run))


def record_events(recorder: Recorder, run: SeenRun, kind: str, events: Sequence[Event]) -> None:
    """Record events of one kind, such as `reversals`."""
    if events:
        columns = rr.TextLog.columns(
            text=[f"{event.at_s:.3f} s: {event.text}" for event in events],
            level=[event.level for event in events],
        )
        times = run.at(np.array([event.at_s for event in events]))
        recorder.columns((*events_of(run), kind), times, columns)


def record_own_events(recorder: Recorder, run: SeenRun) -> None:
    """Record the reversals that the phases tell, and the faults that were found.

    A fault of the whole run stands at its start.
    """
    at_s = reversals(run.segments)
    words = {True: "the drive turns and pulls", False: "the drive turns and lets go"}
    turns = [Event(at, words[up]) for at, up in at_s]
    record_events(recorder, run, REVERSALS, turns)
    if at_s and X_IN in run.file.names:
        entity = run.entity(X_IN, REVERSALS)
        at = np.searchsorted(run.time_s, [s for s, _ in at_s])
        look = rr.SeriesPoints(names="the drive turns", colors=dark("ink"), marker_sizes=4.0)
        recorder.static(entity, look)
        recorder.scalars(entity, run.times.at(at), run.x_in_mm[at])
    start_s = float(run.time_s[0])
    faults = [
        Event(
            start_s if f.first_s is None else f.first_s,
            f"{f.code}: {f.sentence}",
            _LEVELS.get(f.severity, "INFO"),
        )
        for f in faults_of(run)
    ]
    record_events(recorder, run, "faults", faults)


def reversals(segments: Sequence[PhaseSegment]) -> list[tuple[float, bool]]:
    """Return when the drive turns [s], and whether it pulls from then on."""
    known = [(s.start_s, _UP[s.phase]) for s in segments if s.phase in _UP]
    return [(at, up) for (_, before), (at, up) in pairwise(known) if up != before]


def faults_of(run: SeenRun) -> list[Finding]:
    """Return what a check found in a run."""
    check = run.inputs.get(CheckFile)
    return [] if check is None else [f for f in check.findings if f.run == run.id]


def phases_of(run: SeenRun) -> Entity:
    """Return the entity of a run's phases."""
    return run.entity("phase")


def record_phases(recorder: Recorder, run: SeenRun) -> None:
    """Record when each phase begins, and where the last one ends; nothing without segments."""
    if not run.segments:
        return
    starts, keys = changes(run.segments)
    look = rr.StateConfiguration(
        values=[phase.key for phase in PHASES],
        labels=[phase.label for phase in PHASES],
        colors=[dark(phase.colour) for phase in PHASES],
    )
    recorder.static(phases_of(run), look)
    recorder.columns(phases_of(run), run.at(np.array(starts)), rr.StateChange.columns(state=keys))


def changes(segments: Sequence[PhaseSegment]) -> tuple[list[float], list[str]]:
    """Return when which phase begins [s]; a stretch in none begins with an empty name."""
    starts: list[float] = []
    keys: list[str] = []
    for segment, after in zip(segments, (*segments[1:], None), strict=True):
        starts.append(segment.start_s)
        keys.append(segment.phase if segment.phase in BY_KEY else "unknown")
        if after is None or after.start_s > segment.end_s:
            starts.append(segment.end_s)
            keys.append(ENDS)
    return starts, keys
