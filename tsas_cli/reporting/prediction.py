"""What models predict of runs that no fit has seen: the errors, and the loops over the measured."""

from collections.abc import Container, Iterator, Mapping
from functools import partial
from typing import Any

import numpy as np

from tsas_cli.comparing.predict import tables
from tsas_cli.recordings.columns import name_by
from tsas_cli.recordings.recording import Recording
from tsas_cli.records.prediction import PredictedChannel, PredictionFile
from tsas_cli.records.result import Table as Printed
from tsas_cli.reporting.colours import MODELS, STAND_IN
from tsas_cli.reporting.content import Group, Picture, Section, Table
from tsas_cli.reporting.drawing import (
    POINTS,
    kept_samples,
    legend,
    noise_bounds,
    picture,
    shared_points,
)
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.names import at_axis, in_words
from tsas_cli.reporting.numbers import plain
from tsas_cli.support.arrays import Floats

_X = "x_in_mm"
_WORDS = {"RMSE / noise": "normalised residual"}
_MOST_RUNS = 10
_POINTS = 30_000  # of all curves
_LINES = ("-", "--", ":")  # after as many models as there are colours


def section(inputs: Inputs) -> Section | None:
    """Return the section of the predictions, one group per run, None without them."""
    prediction = inputs.get(PredictionFile)
    if prediction is None:
        return None
    recordings = {one.run.id: one for one in inputs.recordings}
    shown = _order(prediction, recordings)
    curves = 2 * min(len(shown), _MOST_RUNS) * (1 + 2 * len(prediction.models))
    points = shared_points(curves, _POINTS)
    groups = tuple(
        Group(f"Run {run}", pictures)
        for number, run in enumerate(shown[:_MOST_RUNS])
        if (pictures := tuple(_pictures(inputs, prediction, recordings[run], number, points)))
    )
    left = len(shown) - _MOST_RUNS
    return Section(
        "prediction",
        "Predicted, not fitted",
        (" ".join(prediction.notes[:1]),),
        points=(*prediction.findings, *prediction.notes[1:]),
        tables=tuple(map(_printed, tables(prediction))),
        groups=groups,
        closing=(f"{left} more runs are in the table.",) if left > 0 else (),
    )


def _printed(table: Printed) -> Table:
    caption, header, rows = table
    return Table.printed((caption, [_WORDS.get(name, name) for name in header], rows))


def _order(prediction: PredictionFile, known: Container[str]) -> list[str]:
    """Return the known runs: first the one, new to every model, whose predictions differ most."""
    runs = [run for run in dict.fromkeys(row.run for row in prediction.channels) if run in known]
    seen = {row.run for row in prediction.channels if row.seen}
    ratios = {
        (max(row.ratio, 1.0 / row.ratio), row.run)
        for row in prediction.channels
        if row.ratio and row.channel == "f_in_N" and row.run in known and row.run not in seen
    }
    first = [run for _, run in sorted(ratios)[-1:]]
    return list(dict.fromkeys([*first, *runs]))


def _pictures(
    inputs: Inputs,
    prediction: PredictionFile,
    recording: Recording,
    number: int,
    points: int,
) -> Iterator[Picture]:
    run = recording.run.id
    rows = [row for row in prediction.channels if row.run == run]
    there = inputs.written_columns(run, PredictionFile)
    for channel in ("f_in_N", "f_out_N") if _X in there else ():
        measured = recording.get(channel)
        models = {
            row.model: inputs.series(run, recording.time_s.size, name, PredictionFile)
            for row in rows
            if row.channel == channel and (name := name_by(channel, row.model)) in there
        }
        if measured is None or not models:
            continue
        x = inputs.series(run, recording.time_s.size, _X, PredictionFile)
        if np.isfinite(x + measured).any():
            shown = [row for row in rows if row.channel == channel]
            yield _picture(shown, number, x, measured, models, points)


def _picture(
    rows: list[PredictedChannel],
    number: int,
    x: Floats,
    measured: Floats,
    models: Mapping[str, Floats],
    points: int,
) -> Picture:
    channel, unit = rows[0].channel, rows[0].unit
    said = ", ".join(f"{row.model} {plain(row.rmse, 3)} {unit}" for row in rows)
    return picture(
        partial(
            draw_predictions,
            x=x,
            measured=measured,
            models=models,
            noise=rows[0].noise,
            labels=(at_axis(_X), at_axis(channel), f"residual [{unit}]"),
            points=points,
        ),
        key=f"prediction-{number}-{channel}",
        alt=f"Run {rows[0].run}: {in_words(channel)} over {in_words(_X)}, measured and predicted, "
        f"and below measured minus predicted. RMSE: {said}.",
        caption=f"{in_words(channel).capitalize()} over {in_words(_X)}. RMSE: {said}.",
        height_in=4.6,
    )


def draw_predictions(
    figure: Any,
    *,
    x: Floats,
    measured: Floats,
    models: Mapping[str, Floats],
    noise: float | None,
    labels: tuple[str, str, str],
    points: int = POINTS,
) -> None:
    """Draw the loop of one run, and under it what each model leaves.

    `x` [mm], `measured` and those of the models have shape (n,); `labels` are the names of the axes
    with units: of x, the channel and its residual.
    """
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    kept = kept_samples(x, measured, points=points)
    upper.plot(x[kept], measured[kept], color=STAND_IN["measured"], linewidth=2.2, label="measured")
    for number, (name, values) in enumerate(models.items()):
        turn, colour = divmod(number, len(MODELS))
        style = {
            "color": STAND_IN[(*MODELS[1:], MODELS[0])[colour]],
            "linestyle": _LINES[turn % len(_LINES)],
            "linewidth": 1.0,
        }
        kept = kept_samples(x, values, points=points)
        upper.plot(x[kept], values[kept], label=f"model {name}", **style)
        kept = kept_samples(x, measured - values, points=points)
        lower.plot(x[kept], (measured - values)[kept], **style)
    noise_bounds(lower, noise)
    upper.set_ylabel(labels[1])
    lower.set(xlabel=labels[0], ylabel=labels[2])
    figure.align_ylabels()
    legend(figure, ncols=4)
