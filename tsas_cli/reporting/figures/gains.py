"""One bar for each channel: the error before and after, and what noise and the best model leave."""

from collections.abc import Mapping
from typing import Any

from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.stage_files import HeldOut


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
        _bar(axes, channel.rmse_before, thick=0.8, role="before", alpha=0.45, label=first)
        if named:
            _bar(axes, channel.rmse_after, thick=0.4, role="after", label="with what is named")
        _mark(axes, channel.best_obtainable, linestyle=(0, (2, 1.5)), label="best obtainable")
        _mark(axes, channel.noise_floor, linestyle="-", label="noise floor")
        axes.set(ylim=(-0.55, 0.55), yticks=[], xlim=(0, None))
        axes.set_ylabel(
            f"{name.rsplit('_', 1)[0]} [{channel.unit}]", rotation=0, ha="right", va="center"
        )
        axes.spines["left"].set_visible(False)
    handles, labels = rows[0].get_legend_handles_labels()
    figure.legend(
        handles, labels, loc="outside upper left", ncols=2, handlelength=1.6, columnspacing=1.2
    )


def _bar(
    axes: Any, value: float | None, *, thick: float, role: str, label: str, alpha: float = 1.0
) -> None:
    if value is not None:
        axes.barh(0.0, value, thick, color=STAND_IN[role], alpha=alpha, label=label)


def _mark(axes: Any, value: float | None, **style: Any) -> None:
    if value is not None:
        axes.plot([value, value], [-0.5, 0.5], color=STAND_IN["ink"], linewidth=1.6, **style)
