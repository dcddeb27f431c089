"""The simulation over the measurement, channel by channel, with the residual under it."""

from functools import partial

import numpy as np

from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.recordings.dataset import Recording
from tsas_cli.reporting.content import Group, Picture, Section, Table
from tsas_cli.reporting.drawing import picture
from tsas_cli.reporting.figures.comparison import draw_comparison
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.numbers import ABSENT, plain
from tsas_cli.reporting.stage_files import Channel, SimulatedRun, Simulation

_TITLE = "Simulation and measurement"


def section(inputs: Inputs) -> Section:
    """Return the section of the simulation, one group per run."""
    simulation = inputs.get(Simulation)
    if simulation is None:
        text = "No simulation was given: add a folder written by `tsas simulate`."
        return Section("simulation", _TITLE, (text,))
    intro = (
        f"The model ({simulation.dynamics}) is driven with the measured input.",
        "Residual: measured minus simulated. Noise alone leaves 95 % between the dashed lines.",
    )
    groups = tuple(
        Group(f"Run {recording.run.id}", _pictures(inputs, recording, number, run))
        for number, recording in enumerate(inputs.dataset)
        if (run := simulation.runs.get(recording.run.id))
    )
    return Section("simulation", _TITLE, intro, tables=(_table(simulation),), groups=groups)


def _table(simulation: Simulation) -> Table:
    rows = tuple(
        (
            run_id,
            name,
            plain(channel.rmse, 3),
            plain(channel.noise, 3),
            _ratio(channel),
            _unit(name, channel),
            str(run.unconverged_samples),
        )
        for run_id, run in simulation.runs.items()
        for name, channel in run.channels.items()
    )
    header = ("run", "channel", "RMSE", "noise", "RMSE / noise", "unit", "samples not converged")
    caption = "How far the simulation is from the measurement"
    return Table(caption, header, rows, numeric=frozenset({2, 3, 4, 6}))


def _ratio(channel: Channel) -> str:
    if channel.rmse is None or not channel.noise:
        return ABSENT
    return plain(channel.rmse / channel.noise, 3)


def _unit(name: str, channel: Channel) -> str:
    return channel.unit or (BY_NAME[name].unit if name in BY_NAME else ABSENT)


def _pictures(
    inputs: Inputs, recording: Recording, number: int, run: SimulatedRun
) -> tuple[Picture, ...]:
    pictures = []
    for name, channel in run.channels.items():
        measured = recording.get(name)
        if measured is None:
            continue
        simulated = inputs.simulated(recording, name)
        if not np.isfinite(measured - simulated).any():
            continue
        unit, what = _unit(name, channel), BY_NAME[name].meaning.split(",")[0]
        pictures.append(
            picture(
                partial(
                    draw_comparison,
                    time_s=recording.time_s,
                    measured=measured,
                    simulated=simulated,
                    noise=channel.noise,
                    labels=(f"{name.rsplit('_', 1)[0]} [{unit}]", unit),
                ),
                key=f"simulation-{number}-{name}",
                alt=f"Run {recording.run.id}, {what}, measured and simulated along the time, and "
                f"the residual: RMSE {plain(channel.rmse, 3)} {unit}, noise "
                f"{plain(channel.noise, 3)} {unit}.",
                caption=f"{what.capitalize()}: RMSE {plain(channel.rmse, 3)} {unit}, "
                f"noise {plain(channel.noise, 3)} {unit}.",
                height_in=4.0,
            )
        )
    return tuple(pictures)
