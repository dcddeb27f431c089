"""What models predict of recordings: errors by channel, and which runs lie in a model's range.

Below it is what `tsas predict` writes and prints of that: tables and sentences.
"""

import math
from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from string import ascii_uppercase
from typing import TypeVar

import numpy as np

from tsas_cli.comparing.predictions import ComparedRun, Predictions, ratio_of
from tsas_cli.comparing.sides import Side, read_side
from tsas_cli.identification.fitted_to import FittedTo, departures, fitted_to, not_stated
from tsas_cli.identification.model import Model
from tsas_cli.identification.model_file import IN_MEMORY, read_fitted_to, source_of
from tsas_cli.identification.prepared import CHANNELS
from tsas_cli.identification.repeatability import repeatability
from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.records.base import number_text, span_text
from tsas_cli.records.prediction import (
    PredictedChannel,
    PredictingModel,
    PredictionFile,
    RangeOfRun,
)
from tsas_cli.records.result import Table
from tsas_cli.support.errors import InputError
from tsas_cli.support.steps import NO_PROGRESS, Steps
from tsas_cli.support.wording import count_of, listed

Said = TypeVar("Said", bound=Hashable)
ALIKE = 1.01  # ratio of RMSE up to which two models predict alike


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
                share_percent=ratio_of(rmse, span / 100.0),
                normalised_residual=ratio_of(rmse, noise),
                ratio=ratio_of(rmse, base),
                noise=noise,
                repeatability=repeated.get(channel),
                seen=models[name].has_seen(run.run.sha256.lower()),
            )


def _range(run: str, model: str, here: FittedTo, fitted: FittedTo | None) -> RangeOfRun:
    if fitted is None:
        return RangeOfRun(run=run, model=model, verdict="unknown")
    outside = departures(here, fitted)
    return RangeOfRun(
        run=run,
        model=model,
        verdict="outside" if outside else "inside",
        outside=outside,
        not_stated=not_stated(here, fitted),
    )


def models_of(it: Predicted, out: Path | None) -> tuple[PredictingModel, ...]:
    """Return the models as `predict.json` in `out` holds them."""
    return tuple(
        PredictingModel(
            **source_of(side.model_file or IN_MEMORY, out),
            name=name,
            kind=side.kind,
            dynamics=side.dynamics,
            path=side.path.as_posix(),
            recordings=side.recordings,
        )
        for name, side in it.models.items()
    )


def tables(record: PredictionFile, title: str = "predictions") -> list[Table]:
    """Return what is printed: the models, the errors, and the ranges that runs leave."""
    models = []
    for one in record.models:
        known = one.recordings
        count = "unknown" if known is None else count_of(len(known), "recording")
        models.append((one.name, one.kind, one.path, count, one.dynamics))
    errors = [
        (
            row.run,
            row.channel,
            row.model,
            number_text(row.rmse, ".4g"),
            row.unit,
            number_text(row.share_percent, ".2f"),
            number_text(row.normalised_residual),
            number_text(row.ratio),
            number_text(row.repeatability, ".2g") or "unknown",
            {True: "yes", False: "", None: "unknown"}[row.seen],
        )
        for row in record.channels
    ]
    alike: dict[tuple[str, str, str], list[str]] = {}  # the models of which the same is to be said
    for row in (row for row in record.ranges if row.verdict != "inside"):
        what = "; ".join(one.text() for one in row.outside)
        alike.setdefault((row.run, row.verdict, what), []).append(row.model)
    ranges = [(run, ", ".join(of), verdict, what) for (run, verdict, what), of in alike.items()]
    header = ("run", "channel", "model", "RMSE", "unit", "% of range", "normalised residual")
    ranges_header = ("run", "model", "range", "by")
    return [
        ("models", ("model", "kind", "path", "fitted to", "dynamics"), models),
        (title, (*header, "RMSE / A", "repeatability", "in the fit"), errors),
        *([("ranges that the models were fitted to", ranges_header, ranges)] if ranges else []),
    ]


def findings(it: Predicted) -> Iterator[str]:
    """Yield which model predicts best, what is no prediction, and what lies outside a range."""
    seen = {(row.run, row.model) for row in it.channels if row.seen}
    runs = list(dict.fromkeys(row.run for row in it.channels))
    new = [run for run in runs if not any(run == known for known, _ in seen)]
    for channel in CHANNELS:
        rows = [row for row in it.channels if row.channel == channel and row.run in new]
        if any(row.rmse is not None for row in rows):
            yield _best(channel, rows)
    for known, who in _by_models(it, lambda n: listed([r for r in runs if (r, n) in seen])):
        if known:
            who += " is" if who in it.models else " are"
            yield f"{who} fitted to {known}, which is no prediction."
    if not new:
        yield "No run is new to every model."
    yield from _outside(it)


def _best(channel: str, rows: Sequence[PredictedChannel]) -> str:
    """Return which model predicts a channel best over runs that no fit has seen."""
    by_model: dict[str, list[float]] = {}
    for row in rows:
        if row.rmse is not None:
            by_model.setdefault(row.model, []).append(row.rmse)
    rmse = {name: math.sqrt(sum(v * v for v in of) / len(of)) for name, of in by_model.items()}
    least = min(rmse.values())
    best = [name for name, value in rmse.items() if value <= ALIKE * least]
    of = [row for row in rows if row.model == best[0]]
    unit, runs = rows[0].unit, count_of(len(by_model[best[0]]), "run")
    others = ", ".join(f"{n} {v:.3g} {unit}" for n, v in rmse.items() if n not in best)
    who = f"{listed(best)} predict{'s' if len(best) == 1 else ''}"
    how = " alike" if len(best) > 1 else " best" if others else ""
    said = f"{channel}: {who}{how}, RMSE {least:.3g} {unit} over {runs} that no fit has seen"
    said += f" ({others})" if others else ""
    noise = span_text(row.normalised_residual for row in of)
    repeated = span_text(row.repeatability for row in of)
    said += f"; {noise} × the noise level" if noise else ""
    return f"{said}; repeatability {f'{repeated} {unit}' if repeated else 'unknown'}."


def _outside(it: Predicted) -> Iterator[str]:
    """Yield which runs lie outside of what each model was fitted to, and by what."""
    for (verdict, said), who in _by_models(it, lambda name: _range_of(it, name)):
        if verdict == "outside":
            yield f"Outside the model's range ({who}): {said}."
        elif verdict == "inside":
            yield f"Every run lies in the model's range ({who})."
        else:
            yield f"It is not known what ranges the model was fitted to ({who})."


def _range_of(it: Predicted, model: str) -> tuple[str, str]:
    """Return whether any run lies outside a model's range, and which by what."""
    rows = [row for row in it.ranges if row.model == model]
    out = [row for row in rows if row.verdict == "outside"]
    if not out:
        return rows[0].verdict, ""
    what = dict.fromkeys(one.quantity for row in out for one in row.outside)
    return "outside", f"{listed([row.run for row in out])}, by {listed([*what])}"


def _by_models(it: Predicted, said_of: Callable[[str], Said]) -> Iterator[tuple[Said, str]]:
    """Yield each thing that is to be said of models, and their letters."""
    models: dict[Said, list[str]] = {}
    for name in it.models:
        models.setdefault(said_of(name), []).append(name)
    yield from ((said, listed(names)) for said, names in models.items())


def notes(it: Predicted) -> Iterator[str]:
    """Yield what to keep in mind."""
    yield (
        "Each run's own preload and zeros are fitted to it, and nothing else."
        if it.own_fitted
        else "Nothing is fitted to these runs."
    )
    lacking: dict[str, dict[str, None]] = {name: {} for name in it.models}
    for row in it.ranges:
        lacking[row.model] |= dict.fromkeys(row.not_stated)
    for unknown, who in _by_models(it, lambda name: listed([*lacking[name]])):
        if unknown:
            yield f"Not known of the recordings behind {who}, and not compared: {unknown}."
    for name, side in it.models.items():
        if side.recordings is None:
            yield f"{name} does not say what it was fitted to: it may have seen these runs."
        if side.not_converged:
            yield f"The fit of {name} did not converge ({side.not_converged.rstrip('.')})."
