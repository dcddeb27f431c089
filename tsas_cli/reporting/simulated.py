"""The models on the page: those of a diagnosis, and each simulation by its name."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tsas_cli.recordings.columns import nominal_name
from tsas_cli.recordings.recording import Recording
from tsas_cli.records.diagnosis import EXTENDED_MODEL, DiagnosisFile
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.support.arrays import Floats
from tsas_cli.support.files import sha256_of

X_IN = "x_in_mm"
NOMINAL, EXTENDED = "nominal model", "extended model"
_ROLES = ("simulated", "dead-band-up", "alike", "rest")


@dataclass(frozen=True)
class Simulated:
    """One model's predictions: its name on the page, its colour's role, and where they are."""

    label: str
    role: str
    folder: Path
    nominal: bool = False

    def driven(self, inputs: Inputs, recording: Recording) -> Floats | None:
        """Return x_in of a run as it drives the model [mm], shape (n,), None where it is not."""
        if X_IN not in inputs.written_columns(recording.run.id, self.folder):
            return None
        return inputs.series(recording.run.id, recording.time_s.size, X_IN, self.folder)

    def predicted(self, inputs: Inputs, recording: Recording, column: str) -> Floats | None:
        """Return a channel of a run as predicted, shape (n,), None where it is not.

        InputError: the file cannot be read, or does not belong to this recording.
        """
        name, run = nominal_name(column) if self.nominal else column, recording.run.id
        if name not in inputs.written_columns(run, self.folder):
            return None
        return inputs.series(run, recording.time_s.size, name, self.folder)


def diagnosed_models(inputs: Inputs) -> tuple[Simulated, ...]:
    """Return the nominal model of a diagnosis, and the extended one where there is one."""
    diagnosis = inputs.get(DiagnosisFile)
    if diagnosis is None:
        return ()
    folder = inputs.folders[DiagnosisFile]
    extended = (Simulated(EXTENDED, "after", folder),) if diagnosis.extended else ()
    return Simulated(NOMINAL, "before", folder, nominal=True), *extended


def simulated_models(inputs: Inputs) -> tuple[Simulated, ...]:
    """Return the diagnosis's models and those of the simulations, but none twice."""
    diagnosed = diagnosed_models(inputs)
    return *diagnosed, *_simulations(inputs, known=bool(diagnosed))


def _simulations(inputs: Inputs, *, known: bool) -> Iterator[Simulated]:
    extended = inputs.folders[DiagnosisFile] / EXTENDED_MODEL if known else None
    digest = sha256_of(extended) if extended is not None and extended.is_file() else None
    for number, (name, (record, folder)) in enumerate(inputs.simulations.items()):
        if digest is None or record.model.sha256 != digest:
            yield Simulated(name, _ROLES[number % len(_ROLES)], folder)


def rms(residual: Floats) -> float:
    """Return the root mean square of a residual without its gaps, NaN where there is no sample."""
    there = residual[np.isfinite(residual)]
    return float(np.sqrt(np.mean(there**2))) if there.size else float("nan")
