"""What a person looks at, from what the stages wrote: into one file, or to a viewer."""

import re
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import rerun as rr
from rerun.blueprint import Blueprint

from tsas_cli.recordings.storage import Location
from tsas_cli.records.calibration import CalibrationFile
from tsas_cli.records.check import CheckFile
from tsas_cli.records.diagnosis import DiagnosisFile
from tsas_cli.records.simulation import SimulationFile
from tsas_cli.records.tracking import TrackingFile
from tsas_cli.reporting.glance import glance
from tsas_cli.reporting.inputs import Inputs, read_inputs
from tsas_cli.reporting.stream.channels import (
    record_channels,
    record_faults,
    record_phases,
    record_tracking,
)
from tsas_cli.reporting.stream.layout import OVERVIEW, layout_of
from tsas_cli.reporting.stream.recorder import Recorder, is_finished, to_file
from tsas_cli.reporting.stream.seen import SeenRun, seen_runs
from tsas_cli.reporting.stream.tendon import record_tendon
from tsas_cli.support.errors import InputError, printable

STREAM_FILE = "stream.rrd"
CONTENT = (record_channels, record_tracking, record_phases, record_faults, record_tendon)


@dataclass(frozen=True)
class Stream:
    """What there is to see, ready to be recorded; no sample is read yet."""

    name: str
    overview: str
    runs: tuple[SeenRun, ...]

    @property
    def layout(self) -> Blueprint:
        """What the viewer opens with."""
        return layout_of(self.runs)

    def record(self, recorder: Recorder, step: Callable[[], None] = lambda: None) -> None:
        """Record texts and runs, one run after the other; `step` is called after each."""
        text = rr.TextDocument(self.overview, media_type=rr.MediaType.MARKDOWN)
        recorder.static(OVERVIEW, text)
        for run in self.runs:
            read = replace(run)  # a copy, so that what it has read goes with it
            for content in CONTENT:
                content(recorder, read)
            step()


def stream_of(inputs: Inputs) -> Stream:
    """Return what there is to see of what the stages wrote."""
    dataset = "tsas" if inputs.dataset is None else inputs.dataset.manifest.name
    stages = dict.fromkeys(stage.FILE.removesuffix(".json") for stage, _ in inputs.given)
    return Stream(", ".join([dataset, *stages]), overview(inputs), tuple(seen_runs(inputs)))


def write_stream(inputs: Inputs, path: Path, *, step: Callable[[], None] = lambda: None) -> None:
    """Write what there is to see into a file for the Rerun viewer; `step` is called after each run.

    InputError: a file cannot be read, or `path` exists.
    """
    stream = stream_of(inputs)
    with to_file(path, stream.name, stream.layout) as recorder:
        stream.record(recorder, step)


_SPECIAL = re.compile(r"([\\`*_{}\[\]<>()#+\-!|~&$^])")


def overview(inputs: Inputs) -> str:
    """Return what the recordings are, the answer and its numbers, and what to keep in mind."""
    manifest = None if inputs.dataset is None else inputs.dataset.manifest
    title = "Recordings" if manifest is None else manifest.name
    about = "" if manifest is None else manifest.description
    lines = [f"# {plain_text(title)}", plain_text(about)]
    if first := glance(inputs):
        lines.append(f"**{plain_text(first.kind)}: {plain_text(first.verdict)}**")
        lines.append(plain_text(first.numbers))
        for fact in first.facts:
            number = " → ".join(filter(None, (fact.before, fact.value)))
            note = f" ({plain_text(fact.note)})" if fact.note else ""
            lines.append(f"- {plain_text(f'{fact.label}: {number}')}{note}")
    lines += (f"- {plain_text(point)}" for point in _points(inputs))
    return "\n\n".join(filter(None, lines))


def plain_text(text: str) -> str:
    """Return text of which no letter is read as Markdown or HTML."""
    return _SPECIAL.sub(r"\\\1", printable(text))


def _points(inputs: Inputs) -> Iterator[str]:
    if diagnosis := inputs.get(DiagnosisFile):
        yield from (diagnosis.reason, f"Next: {diagnosis.next_experiment}")
    if tracking := inputs.get(TrackingFile):
        yield from tracking.notes
    if simulation := inputs.get(SimulationFile):
        yield from simulation.notes
    if calibration := inputs.get(CalibrationFile):
        yield from calibration.cannot_tell
    if check := inputs.get(CheckFile):
        for found in check.findings:
            where = f"run {found.run}, " if found.run else ""
            yield f"{found.severity}, {where}{found.code}: {found.sentence}"


@contextmanager
def shown_stream(
    paths: Sequence[Location], step: Callable[[], None] = lambda: None
) -> Iterator[tuple[Path, list[str]]]:
    """Yield the stream's file, and sentences about it; what is made here is gone afterwards.

    A folder that holds a stream shows that; several folders make one of their own, and `step` is
    called after each run.

    InputError: a path is missing, no stream and no folder of a stage, or a file stands among
    others.
    """
    local = [path for path in paths if isinstance(path, Path)]
    for path in local:
        if not path.exists():
            raise InputError("is not there", where=path, expected="an .rrd file or a folder")
    first, *others = paths
    if isinstance(first, Path) and not others:
        stream = first / STREAM_FILE if first.is_dir() else first
        if stream.is_file():
            why = "its writer was stopped, or it is cut off; all it holds is shown"
            yield stream, [] if is_finished(stream) else [f"{stream} has no end: {why}"]
            return
    for path in local:
        if not path.is_dir():
            raise InputError(
                "is a file among others",
                where=path,
                expected="folders of stages, or one .rrd file alone",
            )
    with tempfile.TemporaryDirectory(prefix="tsas-view-") as folder:
        stream = Path(folder) / STREAM_FILE
        write_stream(read_inputs(paths), stream, step=step)
        yield stream, []
