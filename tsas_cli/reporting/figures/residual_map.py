"""The error's mean and scatter over one signal, before and after, channel below channel."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from tsas_cli.records.diagnosis import Bin
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.phases import label_of

NAMES = ("before", "after")  # of the two series of a panel
_MOST_LABELS = 8


@dataclass(frozen=True)
class Panel:
    """One channel over one signal: its bins before, and after where there is an after."""

    channel: str
    signal: str
    before: tuple[Bin, ...]
    after: tuple[Bin, ...] = ()


def height_in(panels: Sequence[Panel]) -> float:
    """Return the height in inches that these panels need below each other."""
    return 0.9 + 1.25 * len(panels)


def draw_residual_map(
    figure: Any, panels: Sequence[Panel], *, label: str, names: tuple[str, str] = NAMES
) -> None:
    """Draw panels that share the axis of one signal, whose name is `label`.

    The error is in units of noise; `names` are those of the two series.
    """
    rows = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
    by_label = all(b.low == b.high for panel in panels for b in panel.before)
    for axes, panel in zip(rows, panels, strict=True):
        axes.axhspan(-1.0, 1.0, color=STAND_IN["muted"], alpha=0.3, linewidth=0, label="± noise")
        for level, width in ((-1.0, 0.5), (0.0, 1.0), (1.0, 0.5)):
            axes.axhline(level, color=STAND_IN["muted"], linewidth=width)
        places = _places(panel.before, by_label=by_label)
        spread = 0.12 if by_label else 0.12 * (places[-1] - places[0]) / max(len(places) - 1, 1)
        joined = "none" if by_label else "-"
        series = zip((panel.before, panel.after), NAMES, names, (-1, 1), strict=True)
        for bins, role, name, side in series:
            if bins:
                shift = side * spread * bool(panel.after)
                word = name if panel.after else "nominal model"
                style = {"color": STAND_IN[role], "label": word, "linestyle": joined}
                _series(axes, bins, shift=shift, by_label=by_label, **style)
        axes.set_ylabel(f"{panel.channel.rsplit('_', 1)[0]} / noise")
        axes.margins(x=0.04)
    if by_label:
        _name_bins(rows[-1], panels[0].before)
    rows[-1].set_xlabel(label)
    figure.align_ylabels()
    handles, labels = rows[0].get_legend_handles_labels()
    figure.legend(
        handles, labels, loc="outside upper left", ncols=3, handlelength=1.6, columnspacing=1.2
    )


def _series(axes: Any, bins: Sequence[Bin], *, shift: float, by_label: bool, **style: Any) -> None:
    axes.errorbar(
        [place + shift for place in _places(bins, by_label=by_label)],
        [b.mean for b in bins],
        yerr=[b.sd for b in bins],
        marker="o",
        markersize=4,
        elinewidth=0.9,
        **style,
    )


def _places(bins: Sequence[Bin], *, by_label: bool) -> list[float]:
    """Return where the bins stand: in a row, or in the middle of their values."""
    if by_label:
        return [float(number) for number in range(len(bins))]
    return [((b.low or 0.0) + (b.high or 0.0)) / 2 for b in bins]


def _name_bins(axes: Any, bins: Sequence[Bin]) -> None:
    """Write the bins' labels, every second or third where they are many."""
    step = -(-len(bins) // _MOST_LABELS)
    places = range(0, len(bins), step)
    labels = [label_of(bins[place].label).replace(" ", "\n") for place in places]
    axes.set_xticks(list(places), labels)
    axes.set_xlim(-0.5, len(bins) - 0.5)
