"""The phases of a run as coloured spans, in the report's colours."""

from collections.abc import Sequence

import numpy as np

from tsas_cli.records.base import Segment
from tsas_cli.reporting.phases import BY_KEY, PHASES
from tsas_cli.reporting.stream.palette import colour
from tsas_cli.reporting.stream.recorder import Recorder
from tsas_cli.reporting.stream.recorder.paths import Entity
from tsas_cli.reporting.stream.seen import SeenRun

ENDS = ""  # a state that ends the last one


def phases_of(run: SeenRun) -> Entity:
    """Return the entity of a run's phases."""
    return run.entity("phase")


def record_phases(recorder: Recorder, run: SeenRun) -> None:
    """Record when each phase begins, and where the last one ends; nothing without segments."""
    if not run.segments:
        return
    starts, keys = changes(run.segments)
    recorder.states(
        phases_of(run),
        run.clock.times(np.array(starts)),
        keys,
        colours={phase.key: colour(phase.colour) for phase in PHASES},
        labels={phase.key: phase.label for phase in PHASES},
    )


def changes(segments: Sequence[Segment]) -> tuple[list[float], list[str]]:
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
