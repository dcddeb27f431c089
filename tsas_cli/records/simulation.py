"""What `simulation.json` holds, as far as it is read (docs/formats.md)."""

from typing import ClassVar, Literal

from tsas_cli.physics.response import Dynamics
from tsas_cli.records.base import ModelFile, OfDataset, Record, Segment


class Channel(Record):
    """How far a simulated channel is from the measured one, and how noisy that is."""

    rmse: float | None
    noise: float | None
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
    start: str = ""
    conditioning: dict[str, Conditioning] = {}
    slack_samples: int = 0
    unconverged_samples: int = 0
    channels: dict[str, Channel]


class Simulation(OfDataset):
    """The content of `simulation.json`; its series are in `runs/ID.parquet`."""

    FILE: ClassVar[str] = "simulation.json"
    stage: Literal["simulate"]
    version: str
    model: ModelFile
    dynamics: Dynamics
    nodes: int | None = None
    own_values_fitted: bool = False
    notes: tuple[str, ...] = ()
    runs: dict[str, SimulatedRun]
    segments: dict[str, tuple[Segment, ...]] = {}
