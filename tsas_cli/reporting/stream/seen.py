"""The channels of each run, from its files' headers, before any sample is read."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import rerun as rr

from tsas_cli.recordings.columns import BY_NAME, TIME, nominal_name
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.manifest import Run
from tsas_cli.recordings.run_files import RunColumns, open_run
from tsas_cli.records.base import OfDataset, PhaseSegment
from tsas_cli.records.calibration import CalibrationFile
from tsas_cli.records.check import CheckFile
from tsas_cli.records.diagnosis import DiagnosisFile
from tsas_cli.records.drive import DriveFile
from tsas_cli.records.simulation import SimulationFile
from tsas_cli.records.tracking import TrackedResult, TrackingFile
from tsas_cli.reporting.inputs import Inputs, series_of, written_in
from tsas_cli.reporting.names import TENSIONS, X_IN
from tsas_cli.reporting.sources import Source, diagnosed_models, simulation_of
from tsas_cli.reporting.stream.recorder import Times, times_of
from tsas_cli.support.arrays import Floats

MEASURED, WANTED, RESIDUAL = "measured", "wanted", "residual"
_BROKEN = {"unreadable", "time-order"}
_REFERENCES = {"f_out_ref_N": "f_out_N"}  # a reference is shown with its channel


@dataclass(frozen=True)
class Channel:
    """A column of a run, and what stages say of it."""

    column: str
    sources: tuple[Source, ...] = ()

    @property
    def quantity(self) -> str:
        """The column that it is shown with."""
        return _REFERENCES.get(self.column, self.column)

    @property
    def key(self) -> str:
        """Whether it is measured or wanted."""
        return WANTED if self.column in _REFERENCES else MEASURED


@dataclass(frozen=True)
class SeenRun:
    """One run: its columns, the predictions, its phases, and the controller that made it.

    Time and x_in are kept once they are read; other columns are not.
    """

    inputs: Inputs
    file: RunColumns
    channels: tuple[Channel, ...]
    segments: Sequence[PhaseSegment]
    tracked: TrackedResult | None

    @property
    def id(self) -> str:
        """The run's name."""
        return self.file.run.id

    @property
    def loops(self) -> tuple[Channel, ...]:
        """The tensions that can be shown over the displacement of the drive."""
        if X_IN not in self.file.names:
            return ()
        return tuple(channel for channel in self.channels if channel.column in TENSIONS)

    @cached_property
    def time_s(self) -> Floats:
        """Time [s], shape (n,)."""
        return self.file.read(TIME)

    @cached_property
    def times(self) -> Times:
        """The samples on the timelines."""
        return self.at(self.time_s)

    @cached_property
    def x_in_mm(self) -> Floats:
        """Displacement of the drive [mm], shape (n,), NaN for gaps."""
        return self.file.read(X_IN)

    def at(self, time_s: Floats) -> Times:
        """Return moments of the run [s] on the timelines."""
        return times_of(time_s, self.file.run.started)

    def entity(self, *parts: str) -> str:
        """Return the path of something that belongs to the run."""
        return rr.new_entity_path(["run", self.id, *parts])

    def measured(self, column: str) -> Floats:
        """Return a column of the recording, shape (n,), NaN for gaps."""
        return self.x_in_mm if column == X_IN else self.file.read(column)

    def predicted(self, column: str, source: Source) -> Floats:
        """Return what a stage says of a column, shape (n,), NaN for gaps."""
        return series_of(source.folder, self.id, self.file.rows, source.named(column))


def seen_runs(inputs: Inputs) -> Iterator[SeenRun]:
    """Yield the runs in the order of the manifest, none without a dataset."""
    if inputs.dataset is None:
        return
    given, tracking = tuple(_sources(inputs)), inputs.get(TrackingFile)
    folders = dict.fromkeys(source.folder for source in given)
    tracked = {} if tracking is None else {result.run: result for result in tracking.results}
    parted = inputs.get(CalibrationFile), inputs.get(DiagnosisFile), inputs.get(SimulationFile)
    for run in _taken(inputs, inputs.dataset):
        file = open_run(inputs.dataset.folder, run)
        written = {folder: written_in(folder, run.id) for folder in folders}
        channels = tuple(
            Channel(
                name,
                tuple(s for s in given if name in s.columns and s.named(name) in written[s.folder]),
            )
            for name in BY_NAME
            if name in file.names and name != TIME
        )
        phases = (s.segments[run.id] for s in parted if s is not None and run.id in s.segments)
        yield SeenRun(inputs, file, channels, next(phases, ()), tracked.get(run.id))


def _sources(inputs: Inputs) -> Iterator[Source]:
    """Yield the sources that were given; where nothing is found, both models are one."""
    models = (*simulation_of(inputs), *diagnosed_models(inputs))
    yield from models
    drive = frozenset({X_IN})
    for model in models[:1]:
        yield Source(
            "conditioned", "simulated", model.folder, key="model_input", columns=drive, cleaned=True
        )
    if folder := inputs.folders.get(DriveFile):
        yield Source("nominal drive", "before", folder, nominal_name, "model", columns=drive)
        yield Source("identified drive", "after", folder, key="model_identified", columns=drive)


def _taken(inputs: Inputs, dataset: Dataset) -> list[Run]:
    """Return the runs that any stage took, all where one took all or none is given.

    What the checks found to be no recording is left out: it stands among their findings.
    """
    check = inputs.get(CheckFile)
    broken = {f.run for f in check.findings if f.code in _BROKEN} if check else set()
    chosen = [stage.chosen for stage, _ in inputs.given if isinstance(stage, OfDataset)]
    taken = {name for names in chosen for name in names or ()}
    every = not chosen or None in chosen
    return [run for run in dataset.runs if (every or run.id in taken) and run.id not in broken]
