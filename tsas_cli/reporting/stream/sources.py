"""Where a simulated channel comes from: which stage wrote it, its column, and how it is shown."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from tsas_cli.recordings.columns import nominal_name
from tsas_cli.records.base import StageFile
from tsas_cli.records.diagnosis import Diagnosis
from tsas_cli.records.drive import Drive
from tsas_cli.records.simulation import Simulation
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.which import EXTENDED, NOMINAL, SIMULATED, Which

TENDON = frozenset({"f_in_N", "f_out_N", "x_out_mm"})
DRIVE = frozenset({"x_in_mm"})
CONDITIONED = Which("model_input", "conditioned", "simulated")
NOMINAL_DRIVE = Which("model", "nominal drive", "before")
IDENTIFIED_DRIVE = Which("model_identified", "identified drive", "after")


@dataclass(frozen=True)
class Source:
    """What a stage says of some columns, by `which` model; its key ends the entities.

    What comes later in the alphabet is drawn over what comes before. `cleaned` where it is the
    measurement itself, cleaned before it drove a model, and no answer.
    """

    which: Which
    stage: type[StageFile]
    columns: frozenset[str]
    named: Callable[[str], str] = str
    cleaned: bool = False

    @property
    def key(self) -> str:
        """What its entities end with."""
        return self.which.key

    @property
    def label(self) -> str:
        """What a legend calls it."""
        return self.which.label

    @property
    def role(self) -> str:
        """The role of its colour."""
        return self.which.role


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
