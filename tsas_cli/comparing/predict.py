"""What models predict of recordings: errors by channel, and which runs lie in a model's range."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from string import ascii_uppercase

import numpy as np

from tsas_cli.comparing.predictions import ComparedRun, Predictions
from tsas_cli.comparing.sides import Side, read_side
from tsas_cli.identification.fitted_to import FittedTo, departures, fitted_to, not_stated
from tsas_cli.identification.model import Model
from tsas_cli.identification.model_file import read_fitted_to
from tsas_cli.identification.prepared import CHANNELS
from tsas_cli.identification.repeatability import repeatability
from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.records.prediction import PredictedChannel, QuantityOutside, RangeOfRun
from tsas_cli.support.errors import InputError
from tsas_cli.support.steps import NO_PROGRESS, Steps


@dataclass(frozen=True)
class Predicted:
    """What each model, by its letter, predicts of each run, and how far that is from measured."""

    models: dict[str, Side]
    runs: dict[str, list[ComparedRun]]
    channels: tuple[PredictedChannel, ...]
    ranges: tuple[RangeOfRun, ...]
    own_fitted: bool


def read_models(given: Sequence[Path | Model]) -> dict[str, Side]:
    """Read model files, or folders of `tsas calibrate` or `diagnose`, and give each a letter.

    InputError: there is none, one is no model, or there are more than letters.
    """
    if not 0 < len(given) <= len(ascii_uppercase):
        raise InputError(f"{len(given)} models", expected=f"1 to {len(ascii_uppercase)}")
    models = dict(zip(ascii_uppercase, map(read_side, given), strict=False))
    for side in models.values():
        if side.model is None:
            raise InputError(
                "a simulation does not hold its model",
                where=side.path,
                expected="a model file, or a folder that `tsas calibrate` or `diagnose` wrote",
                remedy="give the model that it was made with",
            )
    return models


def predict(
    models: dict[str, Side], dataset: Dataset, *, fit_own: bool, step: Steps = NO_PROGRESS
) -> Predicted:
    """Return what models, from `read_models`, predict of the runs of a dataset.

    With `fit_own` each run's own preload and zeros are fitted to it first. `step` is called after
    each simulation.
    """
    predictions = Predictions(step)
    runs = {n: predictions.of(side, dataset, fit_own=fit_own) for n, side in models.items()}
    prepared = [one.run for one in next(iter(runs.values()))]
    here = [fitted_to(dataset.manifest.rig, [run]) for run in prepared]
    repeats = repeatability(prepared, here)
    known = {
        name: None if (file := side.model_file) is None else read_fitted_to(file)
        for name, side in models.items()
    }
    return Predicted(
        models,
        runs,
        tuple(
            row
            for k, repeated in enumerate(repeats)
            for row in _channels(models, {n: of[k] for n, of in runs.items()}, repeated)
        ),
        tuple(
            _range(run.run.id, name, there, fitted)
            for run, there in zip(prepared, here, strict=True)
            for name, fitted in known.items()
        ),
        fit_own,
    )


def _channels(
    models: Mapping[str, Side],
    compared: Mapping[str, ComparedRun],
    repeated: Mapping[str, float | None],
) -> Iterator[PredictedChannel]:
    """Yield the errors of each channel of one run, model by model."""
    first, *_ = compared.values()
    run = first.run
    for channel in (name for name in CHANNELS if name in run.measured):
        measured = run.measured[channel]
        span = float(np.nanmax(measured) - np.nanmin(measured))
        noise, base = first.noise(channel), first.rmse(channel)
        for name, one in compared.items():
            rmse = one.rmse(channel)
            yield PredictedChannel(
                run=run.run.id,
                channel=channel,
                model=name,
                unit=BY_NAME[channel].unit,
                rmse=rmse,
                share_percent=_ratio(rmse, span / 100.0),
                normalised_residual=_ratio(rmse, noise),
                ratio=_ratio(rmse, base),
                noise=noise,
                repeatability=repeated.get(channel),
                seen=models[name].has_seen(run.run.sha256.lower()),
            )


def _ratio(value: float | None, of: float | None) -> float | None:
    return value / of if value is not None and of else None


def _range(run: str, model: str, here: FittedTo, fitted: FittedTo | None) -> RangeOfRun:
    if fitted is None:
        return RangeOfRun(run=run, model=model, verdict="unknown")
    outside = [QuantityOutside(**vars(one)) for one in departures(here, fitted)]
    return RangeOfRun(
        run=run,
        model=model,
        verdict="outside" if outside else "inside",
        outside=outside,
        not_stated=not_stated(here, fitted),
    )
