"""A run over the drive's displacement, measured and by models, drawn with matplotlib."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from tsas_cli.identification.comparison import compare
from tsas_cli.identification.model import Model
from tsas_cli.identification.prepared import Prepared
from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.reporting.colours import schemes
from tsas_cli.support.errors import InputError, nearest

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_COLOURS = ("before", "after")


def plot_loop(run: Prepared, models: Mapping[str, Model], channel: str) -> "tuple[Axes, Axes]":
    """Draw a channel over x_in, and the residual of each model below; return the two axes.

    InputError: the run has no such channel.
    """
    from matplotlib import pyplot as plt

    measured = run.measured.get(channel)
    if measured is None:
        remedy = nearest(channel, list(run.measured))
        raise InputError(f"run {run.run.id} has no measured {channel}", remedy=remedy)
    light, _ = schemes()
    figure, (loop, below) = plt.subplots(2, sharex=True, height_ratios=(3, 1), layout="constrained")
    style: dict[str, Any] = {"linewidth": 1.0}
    for number, (name, model) in enumerate(models.items()):
        found = compare(run, model)
        x_in = found.response.x_in_mm
        if number == 0:
            loop.plot(x_in, measured, label="measured", color=light["measured"], **style)
        colour = light[_COLOURS[number]]
        loop.plot(x_in, found.channels[channel], label=name, color=colour, **style)
        below.plot(x_in, measured - found.channels[channel], color=colour, **style)
    unit = BY_NAME[channel].unit
    short = channel.rpartition("_")[0]
    loop.set(title=f"Run {run.run.id}", ylabel=f"{short} [{unit}]")
    below.set(xlabel="x_in [mm]", ylabel=f"residual [{unit}]")
    loop.legend()
    figure.align_ylabels()
    return loop, below
