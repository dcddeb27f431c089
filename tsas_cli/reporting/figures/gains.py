"""Bars for each channel: the error before and after, and what noise and the best model leave."""

from collections.abc import Mapping
from typing import Any

from tsas_cli.records.diagnosis import HeldOut
from tsas_cli.reporting.colours import STAND_IN


def height_in(channels: int) -> float:
    """Return the height in inches that a plot of so many channels needs."""
    return 0.6 + 0.75 * channels


def draw_gains(figure: Any, channels: Mapping[str, HeldOut], *, named: bool) -> None:
    """Draw the channels below each other, each with an axis of its own from zero.

    Parameters
    ----------
    figure
        The matplotlib figure to draw on.
    channels
        By name, the error and its bounds in the channel's unit.
    named
        Whether a cause is named, so that there is an error after to show.
    """
    rows = figure.subplots(len(channels), 1, squeeze=False)[:, 0]
    first = "before" if named else "nominal model"
    for axes, (name, channel) in zip(rows, channels.items(), strict=True):
        _bar(axes, channel.rmse_before, at=0.2 * named, role="before", label=first)
        if named:
            _bar(axes, channel.rmse_after, at=-0.2, role="after", label="with what is named")
        _mark(axes, channel.noise_floor, linestyle="-", label="noise floor")
        _mark(axes, channel.best_obtainable, linestyle=(0, (2, 1.5)), label="best obtainable")
        axes.set(ylim=(-0.5, 0.5), yticks=[], xlim=(0, None))
        axes.set_ylabel(
            f"{name.rsplit('_', 1)[0]} [{channel.unit}]", rotation=0, ha="right", va="center"
        )
        axes.spines["left"].set_visible(False)
    handles, labels = rows[0].get_legend_handles_labels()
    figure.legend(
        handles, labels, loc="outside upper left", ncols=2, handlelength=1.6, columnspacing=1.2
    )


def _bar(axes: Any, value: float | None, *, at: float, role: str, label: str) -> None:
    if value is not None:
        axes.barh(at, value, 0.36, color=STAND_IN[role], label=label)


def _mark(axes: Any, value: float | None, **style: Any) -> None:
    if value is not None:
        axes.plot([value, value], [-0.5, 0.5], color=STAND_IN["ink"], linewidth=1.6, **style)
