"""Every channel over time: measured, what the models answer, and what is left between them.

A column of a file is read once, recorded, and forgotten.
"""

import numpy as np
import numpy.typing as npt

from tsas_cli.reporting.colours import dark
from tsas_cli.reporting.stream.portraits import Portrait
from tsas_cli.reporting.stream.recorder import Entity, Recorder
from tsas_cli.reporting.stream.seen import MEASURED, RESIDUAL, WANTED, SeenRun

Floats = npt.NDArray[np.float64]
_ROLES = {MEASURED: "measured", WANTED: "ink"}
_WIDTHS = {MEASURED: 2.5, WANTED: 1.5}  # what is measured shows under what covers it


def series_of(run: SeenRun) -> dict[str, list[Entity]]:
    """Return the entities of all series, by the column that they are shown with."""
    found: dict[str, list[Entity]] = {}
    for channel in run.channels:
        keys = (channel.key, *(source.which.key for source in channel.sources))
        found.setdefault(channel.quantity, []).extend(
            run.entity(channel.quantity, key) for key in keys
        )
    return found


def residuals_of(run: SeenRun) -> dict[str, list[Entity]]:
    """Return the entities of the residuals by column."""
    found = {
        channel.column: [
            run.entity(channel.column, RESIDUAL, source.which.key)
            for source in channel.sources
            if not source.cleaned
        ]
        for channel in run.channels
    }
    return {column: entities for column, entities in found.items() if entities}


def record_channels(recorder: Recorder, run: SeenRun) -> None:
    """Record the channels of one run, its residuals and its loops; of series all samples.

    Raises
    ------
    InputError
        A file cannot be read, or does not belong to the run.
    """
    for channel in run.channels:
        measured = run.measured(channel.column)
        entity = run.entity(channel.quantity, channel.key)
        recorder.line(entity, channel.key, dark(_ROLES[channel.key]), width=_WIDTHS[channel.key])
        recorder.scalars(entity, run.times, measured)
        portrait = None
        if channel in run.loops:
            portrait = Portrait(run, channel, run.x_in_mm, measured)
            portrait.record(recorder)
        for source in channel.sources:
            values, which = run.series(channel.column, source), source.which
            series = {run.entity(channel.column, which.key): values}
            if not source.cleaned:
                series[run.entity(channel.column, RESIDUAL, which.key)] = measured - values
            for entity, values in series.items():
                recorder.line(entity, which.label, dark(which.role))
                recorder.scalars(entity, run.times, values)
            if portrait is not None:
                portrait.record_prediction(recorder, source, values)
        recorder.settle()
