"""Each model's simulation and the measurement by channel, and the residuals below.

The models are those of a diagnosis, and each simulation by its name.
"""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from tsas_cli.identification.prepared import CHANNELS
from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.recordings.recording import Recording
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.content import (
    MOST_RUNS,
    Picture,
    Section,
    Table,
    missing,
    pictures_by_run,
    table_by_column,
    table_of,
)
from tsas_cli.reporting.drawing import kept_samples, legend, noise_bounds, picture, shared_points
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.names import X_IN, at_axis, in_words, quantity_of
from tsas_cli.reporting.numbers import over, plain, spanned
from tsas_cli.reporting.sources import Source, simulated_models
from tsas_cli.support.arrays import Floats

_LINES = ("-", "--", ":")
_TITLE = "Simulation and measurement"
_POINTS = 50_000  # of all curves


@dataclass(frozen=True, eq=False)
class ShownChannel:
    """One channel of one run: time [s], measured and by model, shape (n,) each, and the noise.

    It is drawn over `x`, x_in as it drives the models [mm], over time without it.
    """

    run: str
    channel: str
    noise: float | None
    time_s: Floats
    measured: Floats
    by_model: Mapping[Source, Floats]
    x: Floats | None = None

    @property
    def unit(self) -> str:
        """The channel's unit."""
        return BY_NAME[self.channel].unit

    def rmse(self, model: Source) -> float | None:
        """Return the RMS of a model's residual, None without the model."""
        return rms(self.measured - self.by_model[model]) if model in self.by_model else None


def section(inputs: Inputs) -> Section:
    """Return the section of the simulations, one group per run."""
    models = simulated_models(inputs)
    if not models or inputs.dataset is None:
        return missing("simulation", _TITLE, what="simulation", stage="simulate")
    compared = [c for one in inputs.recordings for c in channels_of(inputs, one, models)]
    runs = list(dict.fromkeys(one.run for one in compared))
    shown = [one for one in compared if one.run in runs[:MOST_RUNS]]
    points = shared_points(sum(1 + 2 * len(one.by_model) for one in shown), _POINTS)
    groups, left = pictures_by_run(
        len(runs),
        (
            (run, [_picture(one, number, points) for one in shown if one.run == run])
            for number, run in enumerate(runs)
        ),
    )
    given = [record for record, _ in inputs.simulations.values()]
    return Section(
        "simulation",
        _TITLE,
        (*_intro(inputs), *left),
        tables=(_table(compared, models), *_inputs(inputs)),
        groups=groups,
        points=tuple(dict.fromkeys(note for record in given for note in record.notes)),
    )


def _intro(inputs: Inputs) -> Iterator[str]:
    yield (
        "Each model is driven with the measured input. Residual: measured minus simulated. Noise "
        "alone leaves 95 % between the dashed lines."
    )
    for name, (record, _) in inputs.simulations.items():
        yield f"`{name}` is the {record.dynamics} model of `{record.model.file}`."
    runs = [run for record, _ in inputs.simulations.values() for run in record.runs.values()]
    methods = {c.method for run in runs for c in run.conditioning.values()}
    yield from (f"Inputs are cleaned first: {method}." for method in sorted(methods))


def channels_of(
    inputs: Inputs, recording: Recording, models: Sequence[Source]
) -> Iterator[ShownChannel]:
    """Yield the channels of a run that are measured and predicted by a model."""
    for channel in CHANNELS:
        measured = recording.get(channel)
        if measured is None:
            continue
        predicted = {model: model.predicted(recording, channel) for model in models}
        by_model = {
            model: values
            for model, values in predicted.items()
            if values is not None and np.isfinite(measured - values).any()
        }
        if by_model:
            noise = inputs.noise.get(channel)
            run, time_s = recording.run.id, recording.time_s
            yield ShownChannel(run, channel, noise, time_s, measured, by_model)


def _table(compared: Sequence[ShownChannel], models: Sequence[Source]) -> Table:
    """Return the residuals in the channel's unit, and over its noise level."""
    rows = []
    for one in compared:
        sizes = [one.rmse(model) for model in models]
        normalised = (over(size, one.noise) for size in sizes)
        noise = plain(one.noise, 3)
        found = (*(plain(size, 3) for size in sizes), noise, one.unit, *normalised)
        rows.append((one.run, one.channel, *found))
    names = [model.label for model in models]
    header = ("run", "channel", *names, "noise level", "unit", *(f"{n}, normalised" for n in names))
    return table_of("RMS of the residual", header, rows)


def _inputs(inputs: Inputs) -> Iterator[Table]:
    """Yield for each run how its inputs were cleaned, its initial state and its solver."""
    rows = [
        {
            "simulation": name,
            "run": run_id,
            "input": column,
            "window [s]": plain(c.window_s, 3),
            "noise level": plain(c.noise, 3),
            "unit": c.unit,
            "reversals": str(c.reversals),
            "start": run.start,
            "solver": run.solver,
            "samples with slack": str(run.slack_samples),
            "not converged": str(run.unconverged_samples),
        }
        for name, (record, _) in inputs.simulations.items()
        for run_id, run in record.runs.items()
        for column, c in run.conditioning.items()
    ]
    if rows:
        caption = "How the measured inputs were made ready, and what solved the model"
        yield table_by_column(caption, rows)


def _picture(it: ShownChannel, number: int, points: int) -> Picture:
    what, unit = in_words(it.channel), it.unit
    sizes = ", ".join(f"{model.label} {plain(it.rmse(model), 3)}" for model in it.by_model)
    errors = f"RMS of the residual: {sizes}, noise level {plain(it.noise, 3)} {unit}."
    spans = "; ".join(
        f"{model.label} {spanned(values)}, residual {spanned(it.measured - values)}"
        for model, values in it.by_model.items()
    )
    lasts = plain(float(np.ptp(it.time_s)), 3)
    return picture(
        partial(draw_comparison, it=it, points=points),
        key=f"simulation-{number}-{it.channel}",
        alt=f"Run {it.run}, {what} over {lasts} s: measured {spanned(it.measured)} {unit}; "
        f"{spans} {unit}. {errors}",
        caption=f"{what.capitalize()}. {errors}",
        height_in=4.0,
    )


def draw_comparison(figure: Any, *, it: ShownChannel, points: int) -> None:
    """Draw one channel of one run, and under it the residual of each model.

    `points` is about how many are drawn of each curve. A second model of a colour is dashed.
    """
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    by_x = () if it.x is None else (it.x,)
    at, label = (it.time_s, "time [s]") if it.x is None else (it.x, at_axis(X_IN))

    def draw(axes: Any, values: Floats, **style: Any) -> None:
        kept = kept_samples(*by_x, values, points=points)
        axes.plot(at[kept], values[kept], **style)

    draw(upper, it.measured, color=STAND_IN["measured"], linewidth=2.6, label="measured")
    drawn = Counter[str]()
    for model, values in it.by_model.items():
        style = {"color": STAND_IN[model.role], "linestyle": _LINES[drawn[model.role] % 3]}
        draw(upper, values, linewidth=1.1, label=model.label, **style)
        draw(lower, it.measured - values, linewidth=0.7, **style)
        drawn[model.role] += 1
    upper.set_ylabel(f"{quantity_of(it.channel)} [{it.unit}]")
    noise_bounds(lower, it.noise)
    lower.set(xlabel=label, ylabel=f"residual [{it.unit}]")
    figure.align_ylabels()
    legend(figure, upper, ncols=3 if len(it.by_model) < 3 else 2)


def rms(residual: Floats) -> float:
    """Return the root mean square of a residual without its gaps, NaN where there is no sample."""
    finite = residual[np.isfinite(residual)]
    return float(np.sqrt(np.mean(finite**2))) if finite.size else float("nan")
