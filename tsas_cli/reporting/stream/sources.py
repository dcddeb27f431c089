"""Where a simulated channel comes from: which stage wrote it, its column, and how it is shown."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from tsas_cli.recordings.columns import nominal_name
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.stage_files.base import StageFile
from tsas_cli.stage_files.diagnosis import Diagnosis
from tsas_cli.stage_files.drive import Drive
from tsas_cli.stage_files.simulation import Simulation

TENDON = frozenset({"f_in_N", "f_out_N", "x_out_mm"})
DRIVE = frozenset({"x_in_mm"})


@dataclass(frozen=True)
class Source:
    """What a stage says of some columns: `key` ends its entities, `role` is that of its colour.

    What comes later in the alphabet is drawn over what comes before. `cleaned` where it is the
    measurement itself, cleaned before it drove a model, and no answer.
    """

    key: str
    label: str
    role: str
    stage: type[StageFile]
    columns: frozenset[str]
    named: Callable[[str], str] = str
    cleaned: bool = False


def sources(inputs: Inputs) -> Iterator[Source]:
    """Yield the sources that were given; where nothing is named, both models are one."""
    simulation, diagnosis = inputs.get(Simulation), inputs.get(Diagnosis)
    if simulation is not None:
        yield Source("simulated", "simulated", "simulated", Simulation, TENDON)
    if diagnosis is not None:
        yield Source("model", "nominal model", "before", Diagnosis, TENDON, nominal_name)
        if diagnosis.named:
            yield Source("model_extended", "extended model", "after", Diagnosis, TENDON)
    if simulation is not None or diagnosis is not None:
        stage = Diagnosis if simulation is None else Simulation
        yield Source("model_input", "conditioned", "simulated", stage, DRIVE, cleaned=True)
    if inputs.get(Drive) is not None:
        yield Source("model", "nominal drive", "before", Drive, DRIVE, nominal_name)
        yield Source("model_identified", "identified drive", "after", Drive, DRIVE)
