"""Which model's predictions are in which columns of which folder."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from tsas_cli.identification.prepared import CHANNELS
from tsas_cli.recordings.columns import nominal_name
from tsas_cli.recordings.recording import Recording
from tsas_cli.records.calibration import MODEL_FILE
from tsas_cli.records.diagnosis import EXTENDED_MODEL, NOMINAL_MODEL, DiagnosisFile
from tsas_cli.records.simulation import SimulationFile
from tsas_cli.reporting.inputs import Inputs, series_of, written_in
from tsas_cli.reporting.names import X_IN
from tsas_cli.support.arrays import Floats
from tsas_cli.support.files import sha256_of

_ROLES = ("simulated", "dead-band-up", "alike", "rest")


@dataclass(frozen=True)
class Source:
    """What a stage says of some columns: its name on the page, its colour's role, its folder.

    `named` gives the name of a column in the files there; `model` is the file of its model. `key`
    is its name in the paths of a stream, where what comes later in the alphabet is drawn over what
    comes before. `cleaned` is the measurement itself, cleaned before it drove a model.
    """

    label: str
    role: str
    folder: Path
    named: Callable[[str], str] = str
    key: str = ""
    model: str = ""
    columns: frozenset[str] = frozenset(CHANNELS)
    cleaned: bool = False

    def driven(self, recording: Recording) -> Floats | None:
        """Return x_in of a run as it drives the model [mm], shape (n,); None if not written."""
        return self._written(recording, X_IN)

    def predicted(self, recording: Recording, column: str) -> Floats | None:
        """Return a channel of a run as predicted, shape (n,); None if not written.

        InputError: the file cannot be read, or does not belong to this recording.
        """
        return self._written(recording, self.named(column))

    def _written(self, recording: Recording, name: str) -> Floats | None:
        run = recording.run.id
        if name not in written_in(self.folder, run):
            return None
        return series_of(self.folder, run, recording.time_s.size, name)


def diagnosed_models(inputs: Inputs) -> tuple[Source, ...]:
    """Return the nominal model of a diagnosis, and the extended one where there is one."""
    diagnosis = inputs.get(DiagnosisFile)
    if diagnosis is None:
        return ()
    folder = inputs.folders[DiagnosisFile]
    nominal = Source("nominal model", "before", folder, nominal_name, "model", NOMINAL_MODEL)
    extended = Source("extended model", "after", folder, key="model_extended", model=EXTENDED_MODEL)
    return (nominal, extended) if diagnosis.extended else (nominal,)


def simulation_of(inputs: Inputs) -> tuple[Source, ...]:
    """Return the model of a simulation, none without one."""
    folder, key = inputs.folders.get(SimulationFile), "simulated"
    return () if folder is None else (Source(key, key, folder, key=key, model=MODEL_FILE),)


def simulated_models(inputs: Inputs) -> tuple[Source, ...]:
    """Return the diagnosis's models and those of the simulations, but none twice."""
    found = list(diagnosed_models(inputs))
    extended = found[0].folder / EXTENDED_MODEL if found else None
    digest = sha256_of(extended) if extended is not None and extended.is_file() else None
    for number, (name, (record, folder)) in enumerate(inputs.simulations.items()):
        if digest is None or record.model.sha256 != digest:
            found.append(Source(name, _ROLES[number % len(_ROLES)], folder))
    return tuple(found)
