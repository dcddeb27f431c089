"""Where a simulated channel comes from: which model and stage, its column, how it is shown."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from tsas_cli.recordings.columns import nominal_name
from tsas_cli.records.base import StageFile
from tsas_cli.records.diagnosis import Diagnosis
from tsas_cli.records.drive import Drive
from tsas_cli.records.simulation import Simulation
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
class Source:
    """What a stage says of some columns, by `which` model, whose key ends the entities.

    What comes later in the alphabet is drawn over what comes before. `cleaned` where it is the
    measurement itself, cleaned before it drove a model, and no answer.
    """

    which: Which
    stage: type[StageFile]
    columns: frozenset[str]
    named: Callable[[str], str] = str
    cleaned: bool = False


def sources(inputs: Inputs) -> Iterator[Source]:
    """Yield the sources that were given; where nothing is named, both models are one."""
    simulation, diagnosis = inputs.get(Simulation), inputs.get(Diagnosis)
    if simulation is not None:
        yield Source(SIMULATED, Simulation, TENDON)
    if diagnosis is not None:
        yield Source(NOMINAL, Diagnosis, TENDON, nominal_name)
        if diagnosis.named:
            yield Source(EXTENDED, Diagnosis, TENDON)
    if simulation is not None or diagnosis is not None:
        stage = Diagnosis if simulation is None else Simulation
        yield Source(CONDITIONED, stage, DRIVE, cleaned=True)
    if inputs.get(Drive) is not None:
        yield Source(NOMINAL_DRIVE, Drive, DRIVE, nominal_name)
        yield Source(IDENTIFIED_DRIVE, Drive, DRIVE)
