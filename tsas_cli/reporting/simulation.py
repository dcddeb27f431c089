"""The simulation over the measurement, channel by channel, with the residual under it."""

from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any

import numpy as np

from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.recordings.recording import Recording
from tsas_cli.records.simulation import SimulatedChannel, SimulationFile
from tsas_cli.reporting.channels import in_words
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.content import Group, Picture, Section, Table, missing
from tsas_cli.reporting.drawing import picture
from tsas_cli.reporting.figures import legend, line, noise_bounds
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.numbers import ABSENT, plain, spanned
from tsas_cli.support.arrays import Floats

_TITLE = "Simulation and measurement"


def section(inputs: Inputs) -> Section:
    """Return the section of the simulation, one group per run."""
    simulation = inputs.get(SimulationFile)
    if simulation is None:
        return missing("simulation", _TITLE, what="simulation", stage="simulate")
    intro: tuple[str, ...] = (
        f"The model ({simulation.dynamics}) is driven with the measured input.",
        "Residual: measured minus simulated. Noise alone leaves 95 % between the dashed lines.",
    )
    methods = {c.method for run in simulation.runs.values() for c in run.conditioning.values()}
    intro += tuple(f"Inputs are cleaned first: {method}." for method in sorted(methods))
    channels = {run_id: run.channels for run_id, run in simulation.runs.items()}
    groups = tuple(
        Group(f"Run {recording.run.id}", pictures)
        for number, recording in enumerate(inputs.recordings)
        if (pictures := tuple(_pictures(inputs, recording, channels, number)))
    )
    return Section(
        "simulation",
        _TITLE,
        intro,
        tables=(_table(simulation), _inputs(simulation)),
        groups=groups,
        points=simulation.notes,
    )


def _table(simulation: SimulationFile) -> Table:
    rows = tuple(
        (
            run_id,
            name,
            plain(channel.rmse, 3),
            plain(channel.noise, 3),
            _ratio(channel),
            _unit(name, channel),
            str(run.slack_samples),
            str(run.unconverged_samples),
        )
        for run_id, run in simulation.runs.items()
        for name, channel in run.channels.items()
    )
    header = (
        "run",
        "channel",
        "RMSE",
        "noise",
        "RMSE / noise",
        "unit",
        "samples with slack",
        "not converged",
    )
    caption = "How far the simulation is from the measurement"
    return Table(caption, header, rows, numeric=frozenset({2, 3, 4, 6, 7}))


def _inputs(simulation: SimulationFile) -> Table:
    """Return how each run's inputs were cleaned, where it starts and what solved it."""
    rows = tuple(
        (
            run_id,
            column,
            plain(c.window_s, 3),
            plain(c.noise, 3),
            c.unit,
            str(c.reversals),
            run.start,
            run.solver,
        )
        for run_id, run in simulation.runs.items()
        for column, c in run.conditioning.items()
    )
    header = (
        "run",
        "input",
        "window [s]",
        "noise",
        "unit",
        "reversals",
        "start",
        "solver",
    )
    caption = "How the measured inputs were made ready, and what solved the model"
    return Table(caption, header, rows, numeric=frozenset({2, 3, 5}))


def _ratio(channel: SimulatedChannel) -> str:
    if channel.rmse is None or not channel.noise:
        return ABSENT
    return plain(channel.rmse / channel.noise, 3)


def _unit(name: str, channel: SimulatedChannel) -> str:
    return channel.unit or (BY_NAME[name].unit if name in BY_NAME else ABSENT)


def _residual_in_words(
    time_s: Floats, residual: Floats, channel: SimulatedChannel, unit: str
) -> str:
    """Return the residual's span, where it is largest, and its ratio to the noise level."""
    there = np.isfinite(residual)
    at = float(time_s[np.nanargmax(np.abs(residual))])
    said = f"residual {spanned(residual)} {unit}, largest at {plain(at, 3)} s"
    if not channel.noise:
        return said
    inside = float(np.mean(np.abs(residual[there]) <= 2 * channel.noise))
    return f"{said}, {100.0 * inside:.0f} % of it within twice the noise"


def _pictures(
    inputs: Inputs,
    recording: Recording,
    channels: Mapping[str, Mapping[str, SimulatedChannel]],
    number: int,
) -> Iterator[Picture]:
    for name, channel in channels.get(recording.run.id, {}).items():
        measured = recording.get(name)
        if measured is None:
            continue
        simulated = inputs.series(recording.run.id, recording.time_s.size, name, SimulationFile)
        if not np.isfinite(measured - simulated).any():
            continue
        unit, what = _unit(name, channel), in_words(name)
        lasts = plain(float(np.ptp(recording.time_s)), 3)
        distance = f"RMSE {plain(channel.rmse, 3)} {unit}, noise {plain(channel.noise, 3)} {unit}."
        yield picture(
            partial(
                draw_comparison,
                time_s=recording.time_s,
                measured=measured,
                simulated=simulated,
                noise=channel.noise,
                labels=(f"{name.rsplit('_', 1)[0]} [{unit}]", f"residual [{unit}]"),
            ),
            key=f"simulation-{number}-{name}",
            alt=f"Run {recording.run.id}, {what} over {lasts} s: "
            f"measured {spanned(measured)}, simulated {spanned(simulated)} {unit}; "
            f"{_residual_in_words(recording.time_s, measured - simulated, channel, unit)}. "
            f"{distance}",
            caption=f"{what.capitalize()}: {distance}",
            height_in=4.0,
        )


def draw_comparison(
    figure: Any,
    *,
    time_s: Floats,
    measured: Floats,
    simulated: Floats,
    noise: float | None,
    labels: tuple[str, str],
) -> None:
    """Draw one channel of one run.

    Parameters
    ----------
    figure
        The matplotlib figure to draw on.
    time_s, measured, simulated
        Time [s], and the channel in its unit, shape (n,), NaN where there is none.
    noise
        Standard deviation of the channel's noise in its unit, None where it is not known.
    labels
        What stands at the axis of the channel, and at that of the residual.
    """
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    line(upper, time_s, measured, color=STAND_IN["measured"], linewidth=2.6, label="measured")
    line(upper, time_s, simulated, color=STAND_IN["simulated"], linewidth=1.1, label="simulated")
    upper.set_ylabel(labels[0])
    line(lower, time_s, measured - simulated, color=STAND_IN["muted"], linewidth=0.7)
    noise_bounds(lower, noise)
    lower.set(xlabel="time [s]", ylabel=labels[1])
    figure.align_ylabels()
    legend(figure, ncols=3)
