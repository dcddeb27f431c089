"""What a person looks at, from what the stages wrote: into one file, or to a viewer."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.stream import texts
from tsas_cli.reporting.stream.channels import record_channels
from tsas_cli.reporting.stream.events import record_own_events
from tsas_cli.reporting.stream.phases import record_phases
from tsas_cli.reporting.stream.recorder import Recorder, to_file
from tsas_cli.reporting.stream.recorder.layout import Part
from tsas_cli.reporting.stream.seen import SeenRun, seen_runs
from tsas_cli.reporting.stream.tabs import DIAGNOSIS, OVERVIEW, layout_of
from tsas_cli.reporting.stream.tendon.content import record_tendon
from tsas_cli.reporting.stream.tracking import record_tracking

FILE = "stream.rrd"
CONTENT: tuple[Callable[[Recorder, SeenRun], None], ...] = (
    record_channels,
    record_tracking,
    record_phases,
    record_own_events,
)


def write_stream(
    inputs: Inputs, path: Path, *, force: bool = False, step: Callable[[], None] = lambda: None
) -> None:
    """Write what there is to see into a file for the Rerun viewer; `step` is called after each run.

    Raises
    ------
    InputError
        A file cannot be read, or `path` exists and `force` is not set.
    """
    with to_file(path, name_of(inputs), force=force) as recorder:
        record(recorder, inputs, step)


def record(recorder: Recorder, inputs: Inputs, step: Callable[[], None] = lambda: None) -> None:
    """Record the layout, the texts and every run.

    Raises
    ------
    InputError
        A file cannot be read.
    """
    runs = tuple(seen_runs(inputs))
    told = texts.diagnosis(inputs)
    tendons: dict[str, Part] = {}
    recorder.lay_out(layout_of(runs, tendons, diagnosed=told is not None))
    recorder.markdown(OVERVIEW, texts.overview(inputs))
    if told is not None:
        recorder.markdown(DIAGNOSIS, told)
    for run in runs:
        read = replace(run)  # a copy, so that what it has read goes with it
        for content in CONTENT:
            content(recorder, read)
        tendon = record_tendon(recorder, read)
        if tendon is not None:
            tendons[run.id] = tendon
        step()
    if tendons:
        recorder.lay_out(layout_of(runs, tendons, diagnosed=told is not None))


def name_of(inputs: Inputs) -> str:
    """Return what the viewer calls it: the dataset, and the stages that say something of it."""
    dataset = "tsas" if inputs.dataset is None else inputs.dataset.manifest.name
    stages = [kind.FILE.removesuffix(".json") for kind in inputs.folders]
    return " · ".join([dataset, *stages])
