"""Runs on their way into a viewer while they are computed, each as soon as it is there."""

import math
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import pyarrow as pa

from tsas_cli.identification.model import Model
from tsas_cli.identification.model_file import write_model
from tsas_cli.recordings.dataset import Dataset, read_dataset
from tsas_cli.recordings.recording import Recording
from tsas_cli.recordings.writing import write_dataset, write_result
from tsas_cli.records.base import ModelFile
from tsas_cli.records.calibration import MODEL_FILE
from tsas_cli.records.simulation import SimulationFile
from tsas_cli.records.tracking import TrackingFile
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.stream.recorder import Recorder, to_viewer
from tsas_cli.reporting.stream.seen import SeenRun
from tsas_cli.reporting.stream.stream import Stream, stream_of
from tsas_cli.support.errors import InputError
from tsas_cli.tracking.recorded import manifest
from tsas_cli.tracking.settings import Settings

PAUSE_S = 2.0  # between two layouts, which grow with the runs: they may not crowd out the runs


@dataclass
class LiveStream:
    """Shows runs as the stage's own files would be shown; what is laid out grows with them.

    `failure` is why it has shown nothing since.
    """

    recorder: Recorder
    folder: Path
    runs: list[SeenRun] = field(default_factory=list)
    latest: Stream | None = None
    laid_out_at: float = -math.inf
    failure: InputError | None = None

    def simulated(
        self, dataset: Dataset, stage: SimulationFile, predicted: Recording, model: Model
    ) -> None:
        """Show a simulated run beside its recording; `stage` says of the runs so far."""
        (self.folder / "runs").mkdir(exist_ok=True)
        write_result(self.folder / "runs", predicted)
        fitted = stage.dataset.content()
        write_model(self.folder / MODEL_FILE, model, version=stage.version, dataset=fitted)
        self._show(Inputs(dataset.only([predicted.run.id]), ((stage, self.folder),)))

    def tracked(self, stage: TrackingFile, run: str, table: pa.Table) -> None:
        """Show a run of the closed loop; `stage` says of the runs so far."""
        stated = stage.settings.model_dump(by_alias=True, exclude=set(ModelFile.model_fields))
        folder = self.folder / run
        folder.mkdir()
        write_dataset(folder, manifest((run,), Settings.model_validate(stated)), {run: table})
        self._show(Inputs(read_dataset(folder), ((stage, folder),)))

    def lay_out(self) -> None:
        """Give every run so far its place in the viewer."""
        if self.latest is not None and self.failure is None:
            self.recorder.lay_out(self.latest.layout)
            self.laid_out_at, self.latest = time.monotonic(), None

    def _show(self, inputs: Inputs) -> None:
        """Show what is new; a viewer that has gone costs the stage nothing but what it shows."""
        if self.failure is not None:
            return
        try:
            new = stream_of(inputs)
            self.runs += new.runs
            self.latest = replace(new, runs=tuple(self.runs))
            if time.monotonic() > self.laid_out_at + PAUSE_S:
                self.lay_out()
            new.record(self.recorder)
            self.recorder.settle()
        except InputError as error:
            self.failure = error


@contextmanager
def live_stream(address: str, name: str) -> Iterator[LiveStream]:
    """Yield a stream into the viewer at `address`; see `to_viewer`.

    InputError: the viewer does not take it.
    """
    with TemporaryDirectory(prefix="tsas-live-") as folder, to_viewer(address, name) as recorder:
        stream = LiveStream(recorder, Path(folder))
        yield stream
        stream.lay_out()
