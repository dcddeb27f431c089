"""What `predict.json` holds (docs/formats.md)."""

from typing import ClassVar, Literal

from tsas_cli.records.base import ModelFile, Number, OfDataset, Record


class PredictingModel(ModelFile):
    """A model by its letter: its file, what it was read from, and the recordings of its fit."""

    name: str
    kind: str
    dynamics: str
    path: str
    recordings: dict[str, str] | None = None


class PredictedChannel(Record):
    """How far one model is from one channel of one run, in the channel's unit.

    `share_percent` is the RMSE over the span of the measured channel, `normalised_residual` over
    its noise level, `ratio` over the RMSE of the first model. `seen` says whether the model was
    fitted to the run, None where that is not known.
    """

    run: str
    channel: str
    model: str
    unit: str
    rmse: Number
    share_percent: Number
    normalised_residual: Number
    ratio: Number
    noise: Number
    repeatability: Number
    seen: bool | None


class QuantityOutside(Record):
    """A quantity that leaves the range that a model was fitted to: [low, high], or words."""

    quantity: str
    here: tuple[float, float] | tuple[str, ...]
    fitted: tuple[float, float] | tuple[str, ...]

    def text(self) -> str:
        """Return it for a printed table."""
        return f"{self.quantity} {_shown(self.here)}, fitted to {_shown(self.fitted)}"


class RangeOfRun(Record):
    """Whether a run lies in the range that a model was fitted to.

    `unknown` where the model does not say its range; `not_stated` is what of the run it lacks.
    """

    run: str
    model: str
    verdict: Literal["inside", "outside", "unknown"]
    outside: tuple[QuantityOutside, ...] = ()
    not_stated: tuple[str, ...] = ()


class PredictionFile(OfDataset):
    """The content of `predict.json`; its series are in `runs/ID.parquet`."""

    FILE: ClassVar[str] = "predict.json"
    stage: Literal["predict"] = "predict"
    models: tuple[PredictingModel, ...]
    own_values_fitted: bool
    channels: tuple[PredictedChannel, ...]
    ranges: tuple[RangeOfRun, ...]
    findings: tuple[str, ...]
    notes: tuple[str, ...]


def _shown(values: tuple[float, float] | tuple[str, ...]) -> str:
    texts = dict.fromkeys(v if isinstance(v, str) else f"{v:.4g}" for v in values)
    words = any(isinstance(v, str) for v in values)
    return (", " if words else " to ").join(texts)
