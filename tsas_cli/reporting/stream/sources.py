"""Where a simulated channel comes from: which model and stage, its column, how it is shown."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from tsas_cli.recordings.columns import nominal_name
from tsas_cli.records.base import StageFile
from tsas_cli.records.diagnosis import DiagnosisFile
from tsas_cli.records.drive import DriveFile
from tsas_cli.records.simulation import SimulationFile
from tsas_cli.reporting.inputs import Inputs

TENDON = frozenset({"f_in_N", "f_out_N", "x_out_mm"})
DRIVE = frozenset({"x_in_mm"})


@dataclass(frozen=True)
class Which:
    """Which model a picture is of: its name in paths, its name in words, its colour's role."""

    key: str
    label: str
    role: str


SIMULATED = Which("simulated", "simulated", "simulated")
NOMINAL = Which("model", "nominal model", "before")
EXTENDED = Which("model_extended", "extended model", "after")
CONDITIONED = Which("model_input", "conditioned", "simulated")
NOMINAL_DRIVE = Which("model", "nominal drive", "before")
IDENTIFIED_DRIVE = Which("model_identified", "identified drive", "after")


@dataclass(frozen=True)
class StreamSource:
    """What a stage says of some columns, by `which` model, whose key ends the entities.

    What comes later in the alphabet is drawn over what comes before. `cleaned` where it is the
    measurement itself, cleaned before it drove a model, and no answer.
    """

    which: Which
    stage: type[StageFile]
    columns: frozenset[str]
    named: Callable[[str], str] = str
    cleaned: bool = False


def sources(inputs: Inputs) -> Iterator[StreamSource]:
    """Yield the sources that were given; where nothing is named, both models are one."""
    simulation, diagnosis = inputs.get(SimulationFile), inputs.get(DiagnosisFile)
    if simulation is not None:
        yield StreamSource(SIMULATED, SimulationFile, TENDON)
    if diagnosis is not None:
        yield StreamSource(NOMINAL, DiagnosisFile, TENDON, nominal_name)
        if diagnosis.named:
            yield StreamSource(EXTENDED, DiagnosisFile, TENDON)
    if simulation is not None or diagnosis is not None:
        stage = DiagnosisFile if simulation is None else SimulationFile
        yield StreamSource(CONDITIONED, stage, DRIVE, cleaned=True)
    if inputs.get(DriveFile) is not None:
        yield StreamSource(NOMINAL_DRIVE, DriveFile, DRIVE, nominal_name)
        yield StreamSource(IDENTIFIED_DRIVE, DriveFile, DRIVE)
