"""Where the residual was and is now: its mean and scatter over the strongest signals."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from tsas_cli.records.diagnosis import Bin, DiagnosisFile
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.content import Picture, Section
from tsas_cli.reporting.drawing import legend, picture, stacked
from tsas_cli.reporting.names import at_axis, in_words, label_of, quantity_of
from tsas_cli.reporting.numbers import plain
from tsas_cli.support.wording import listed

_SEEN = 0.5  # in units of noise
_SIGNALS = 4
_WHAT = (
    "The residual in units of the noise level: the mean in each bin, and bars of one standard "
    "deviation. Noise alone has its mean at zero and bars as long as the band."
)
NAMES = ("nominal model", "extended model")  # of the two series of a panel
_ROLES = ("before", "after")
_MOST_LABELS = 8


@dataclass(frozen=True)
class Panel:
    """One channel over one signal: its bins before, and after where there is an after."""

    channel: str
    signal: str
    before: tuple[Bin, ...]
    after: tuple[Bin, ...] = ()


def part(diagnosis: DiagnosisFile) -> Section | None:
    """Return the part, None where the errors were not looked at."""
    maps = diagnosis.residual_map
    if not maps.before:
        return None
    title = "Where the residual was, and is now" if diagnosis.extended else "Where the residual is"
    after = maps.after if diagnosis.extended else {}
    panels = [
        Panel(channel, signal, bins, after.get(channel, {}).get(signal, ()))
        for channel, signals in maps.before.items()
        for signal, bins in signals.items()
        if bins
    ]
    shown = pictures(panels, key="diagnosis-map")
    if not shown:
        nothing = "Over no signal does the residual stand out of the noise."
        return Section("diagnosis-maps", title, (nothing,))
    return Section("diagnosis-maps", title, (_WHAT,), pictures=shown)


def pictures(
    panels: Sequence[Panel], *, key: str, names: tuple[str, str] = NAMES
) -> tuple[Picture, ...]:
    """Return a picture for each of the signals over which the error stands out most.

    `names` are those of the two series of a panel, `key` begins each picture's own word.
    """
    strength: dict[str, float] = {}
    for panel in panels:
        strength[panel.signal] = max(strength.get(panel.signal, 0.0), _strength(panel))
    seen = [name for name, size in strength.items() if size > _SEEN]
    strongest = sorted(seen, key=lambda name: -strength[name])[:_SIGNALS]
    return tuple(
        _picture([p for p in panels if p.signal == signal], signal, key, names)
        for signal in strongest
    )


def _strength(panel: Panel) -> float:
    return max(_size(panel.before), _size(panel.after))


def _size(bins: tuple[Bin, ...]) -> float:
    """Return how far the means leave zero, and the scatter its mean, as one root mean square.

    An error of opposite sign on pull and release shows in the scatter alone.
    """
    samples = sum(b.samples for b in bins) or 1
    usual = sum(b.samples * b.sd for b in bins) / samples
    squares = sum(b.samples * (b.mean**2 + (b.sd - usual) ** 2) for b in bins)
    return math.sqrt(squares / samples)


def _picture(panels: Sequence[Panel], signal: str, key: str, names: tuple[str, str]) -> Picture:
    seen = [panel for panel in panels if _strength(panel) > _SEEN]
    words = in_words(signal)
    ranges = "; ".join(
        f"{panel.channel}: {names[0]} {_range(panel.before)}, {names[1]} {_range(panel.after)}"
        if panel.after
        else f"{panel.channel}: {_range(panel.before)}"
        for panel in seen
    )
    return picture(
        partial(draw_residual_map, panels=seen, label=at_axis(signal), names=names),
        key=f"{key}-{signal}",
        alt=f"Mean residual over the {words}, in units of noise. {ranges}.",
        caption=f"{listed([p.channel for p in seen])} over the {words}.",
        height_in=0.9 + 1.25 * len(seen),
    )


def _range(bins: tuple[Bin, ...]) -> str:
    means = [b.mean for b in bins]
    scatter = plain(max(b.sd for b in bins), 2)
    return f"{plain(min(means), 2)} to {plain(max(means), 2)} with scatter up to {scatter}"


def draw_residual_map(
    figure: Any, panels: Sequence[Panel], *, label: str, names: tuple[str, str] = NAMES
) -> None:
    """Draw panels that share the axis of one signal, whose name is `label`.

    The error is in units of noise; `names` are those of the two series.
    """
    rows = stacked(figure, len(panels), sharex=True)
    by_label = all(b.low == b.high for panel in panels for b in panel.before)
    for axes, panel in zip(rows, panels, strict=True):
        axes.axhspan(-1.0, 1.0, color=STAND_IN["muted"], alpha=0.3, linewidth=0, label="± noise")
        for level, width in ((-1.0, 0.5), (0.0, 1.0), (1.0, 0.5)):
            axes.axhline(level, color=STAND_IN["muted"], linewidth=width)
        places = _places(panel.before, by_label=by_label)
        spread = 0.12 if by_label else 0.12 * (places[-1] - places[0]) / max(len(places) - 1, 1)
        joined = "none" if by_label else "-"
        series = zip((panel.before, panel.after), _ROLES, names, (-1, 1), strict=True)
        for bins, role, name, side in series:
            if bins:
                shift = side * spread * bool(panel.after)
                at = [place + shift for place in _places(bins, by_label=by_label)]
                look = {"marker": "o", "markersize": 4, "elinewidth": 0.9, "linestyle": joined}
                means, yerr = [b.mean for b in bins], [b.sd for b in bins]
                axes.errorbar(at, means, yerr=yerr, color=STAND_IN[role], label=name, **look)
        axes.set_ylabel(f"{quantity_of(panel.channel)} / noise")
        axes.margins(x=0.04)
    if by_label:  # every second or third where they are many
        named = panels[0].before
        shown = range(0, len(named), -(-len(named) // _MOST_LABELS))
        labels = [label_of(named[place].label).replace(" ", "\n") for place in shown]
        rows[-1].set_xticks(list(shown), labels)
        rows[-1].set_xlim(-0.5, len(named) - 0.5)
    rows[-1].set_xlabel(label)
    figure.align_ylabels()
    legend(figure, rows[0], ncols=3)


def _places(bins: Sequence[Bin], *, by_label: bool) -> list[float]:
    """Return where the bins stand: in a row, or in the middle of their values."""
    if by_label:
        return [float(number) for number in range(len(bins))]
    return [((b.low or 0.0) + (b.high or 0.0)) / 2 for b in bins]
