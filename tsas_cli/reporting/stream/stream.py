"""What a person looks at, from what the stages wrote: into one file, or to a viewer."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import rerun as rr
from rerun.blueprint import Blueprint

from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.stream.channels import record_channels, record_tracking
from tsas_cli.reporting.stream.events import record_faults, record_phases
from tsas_cli.reporting.stream.layout import OVERVIEW, layout_of
from tsas_cli.reporting.stream.opened import to_file
from tsas_cli.reporting.stream.overview import overview
from tsas_cli.reporting.stream.recorder import Recorder
from tsas_cli.reporting.stream.seen import SeenRun, seen_runs
from tsas_cli.reporting.stream.tendon import record_tendon

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
    stages = [kind.FILE.removesuffix(".json") for kind in inputs.folders]
    return Stream(", ".join([dataset, *stages]), overview(inputs), tuple(seen_runs(inputs)))


def write_stream(inputs: Inputs, path: Path, *, step: Callable[[], None] = lambda: None) -> None:
    """Write what there is to see into a file for the Rerun viewer; `step` is called after each run.

    Raises
    ------
    InputError
        A file cannot be read, or `path` exists.
    """
    stream = stream_of(inputs)
    with to_file(path, stream.name, stream.layout) as recorder:
        stream.record(recorder, step)
