"""What models predict of held-out runs: the errors, and the loops beside the measured ones."""

from collections.abc import Container, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import cycle

import numpy as np

from tsas_cli.comparing.predict import tables
from tsas_cli.recordings.columns import name_by
from tsas_cli.recordings.recording import Recording
from tsas_cli.records.prediction import PredictionFile
from tsas_cli.reporting.colours import MODELS
from tsas_cli.reporting.content import MOST_RUNS, Picture, Section, pictures_by_run, table_of
from tsas_cli.reporting.drawing import picture, shared_points
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.names import TENSIONS, X_IN, in_words
from tsas_cli.reporting.numbers import plain
from tsas_cli.reporting.simulation import channels_of, draw_comparison
from tsas_cli.reporting.sources import Source

_POINTS = 30_000  # of all curves


def section(inputs: Inputs) -> Section | None:
    """Return the section of the predictions, one group per run, None without them."""
    prediction = inputs.get(PredictionFile)
    if prediction is None:
        return None
    recordings = {one.run.id: one for one in inputs.recordings}
    shown = _order(prediction, recordings)
    folder = inputs.folders[PredictionFile]
    models = [
        Source(f"model {it.name}", role, folder, partial(name_by, model=it.name))
        for it, role in zip(prediction.models, cycle((*MODELS[1:], MODELS[0])), strict=False)
    ]
    curves = len(TENSIONS) * min(len(shown), MOST_RUNS) * (1 + 2 * len(models))
    points = shared_points(curves, _POINTS)
    groups, left = pictures_by_run(
        len(shown),
        (
            (run, _pictures(inputs, recordings[run], models, number, points))
            for number, run in enumerate(shown)
        ),
    )
    return Section(
        "prediction",
        "Predicted, not fitted",
        (" ".join(prediction.notes[:1]),),
        points=(*prediction.findings, *prediction.notes[1:]),
        tables=tuple(table_of(*table) for table in tables(prediction)),
        groups=groups,
        closing=left,
    )


def _order(prediction: PredictionFile, known: Container[str]) -> list[str]:
    """Return the known runs: first the held-out one whose predictions differ most."""
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
    inputs: Inputs, recording: Recording, models: Sequence[Source], number: int, points: int
) -> Iterator[Picture]:
    """Yield the loop of each tension over x_in, and below it the residual of each model."""
    x = models[0].driven(recording) if models else None
    for it in channels_of(inputs, recording, models):
        if it.channel not in TENSIONS or x is None or not np.isfinite(x + it.measured).any():
            continue
        names = {model: model.label.removeprefix("model ") for model in it.by_model}
        errors = ", ".join(f"{n} {plain(it.rmse(m), 3)} {it.unit}" for m, n in names.items())
        over = f"{in_words(it.channel)} over {in_words(X_IN)}"
        yield picture(
            partial(draw_comparison, it=replace(it, x=x), points=points),
            key=f"prediction-{number}-{it.channel}",
            alt=f"Run {it.run}: {over}, measured and predicted, and below measured minus "
            f"predicted. RMSE: {errors}.",
            caption=f"{over.capitalize()}. RMSE: {errors}.",
            height_in=4.6,
        )
