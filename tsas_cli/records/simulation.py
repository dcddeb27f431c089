"""What `simulation.json` holds (docs/formats.md)."""

from collections.abc import Iterable
from typing import ClassVar, Literal, Self

from tsas_cli.physics.response import Dynamics
from tsas_cli.records.base import ModelFile, Number, OfDataset, PhaseSegment, Record


class SimulatedChannel(Record):
    """How far a simulated channel is from the measured one, and how noisy that is."""

    rmse: Number
    noise: Number
    samples: int | None = None
    unit: str | None = None


class Conditioning(Record):
    """How a measured input was cleaned before it drove the model."""

    method: str
    window_s: float
    noise: float
    unit: str
    reversals: int


class SimulatedRun(Record):
    """What `tsas simulate` says about one run."""

    solver: str = ""
    conditioning: dict[str, Conditioning] = {}
    start: str = ""
    samples: int | None = None
    slack_samples: int = 0
    unconverged_samples: int = 0
    notes: tuple[str, ...] = ()
    channels: dict[str, SimulatedChannel]


class SimulationFile(OfDataset):
    """The content of `simulation.json`; its series are in `runs/ID.parquet`."""

    FILE: ClassVar[str] = "simulation.json"
    stage: Literal["simulate"] = "simulate"
    model: ModelFile
    dynamics: Dynamics
    nodes: int | None = None
    own_values_fitted: bool = False
    runs: dict[str, SimulatedRun]
    segments: dict[str, tuple[PhaseSegment, ...]] = {}
    notes: tuple[str, ...] = ()

    def with_run(self, run: str, found: SimulatedRun, segments: Iterable[PhaseSegment]) -> Self:
        """Return it with one run more."""
        runs, phases = self.runs | {run: found}, self.segments | {run: tuple(segments)}
        return self.model_copy(update={"runs": runs, "segments": phases})
