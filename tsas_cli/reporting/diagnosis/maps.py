"""Where the error was and where it is now: its mean and scatter over the strongest signals."""

import math
from collections.abc import Iterator, Sequence
from functools import partial

from tsas_cli.records.diagnosis import Bin, Diagnosis
from tsas_cli.reporting.content import Picture, Section
from tsas_cli.reporting.diagnosis.words import listed, signal_at_axis, signal_in_words
from tsas_cli.reporting.drawing import picture
from tsas_cli.reporting.figures.residual_map import NAMES, Panel, draw_residual_map, height_in
from tsas_cli.reporting.numbers import plain

_SEEN = 0.5  # in units of noise
_SIGNALS = 4
_WHAT = (
    "Measured minus simulated in units of what noise explains: the mean in each bin, and bars of "
    "one standard deviation. Noise alone has its mean at zero and bars as long as the band."
)


def part(diagnosis: Diagnosis) -> Section | None:
    """Return the part, None where the errors were not looked at."""
    maps = diagnosis.residual_map
    if not maps.before:
        return None
    title = "Where the error was, and where it is now" if diagnosis.named else "Where the error is"
    shown = pictures(list(_panels(diagnosis)), key="diagnosis-map")
    if not shown:
        nothing = "Over no signal does the error stand out of the noise."
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


def _panels(diagnosis: Diagnosis) -> Iterator[Panel]:
    after = diagnosis.residual_map.after if diagnosis.named else {}
    for channel, signals in diagnosis.residual_map.before.items():
        for signal, bins in signals.items():
            if bins:
                yield Panel(channel, signal, bins, after.get(channel, {}).get(signal, ()))


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
    words = signal_in_words(signal)
    said = "; ".join(_in_words(panel, names) for panel in seen)
    return picture(
        partial(draw_residual_map, panels=seen, label=signal_at_axis(signal), names=names),
        key=f"{key}-{signal}",
        alt=f"Mean error over the {words}, in units of noise. {said}.",
        caption=f"{listed([p.channel for p in seen])} over the {words}.",
        height_in=height_in(seen),
    )


def _in_words(panel: Panel, names: tuple[str, str]) -> str:
    if not panel.after:
        return f"{panel.channel}: {_range(panel.before)}"
    both = zip(names, (panel.before, panel.after), strict=True)
    return f"{panel.channel}: {', '.join(f'{name} {_range(bins)}' for name, bins in both)}"


def _range(bins: tuple[Bin, ...]) -> str:
    means = [b.mean for b in bins]
    scatter = plain(max(b.sd for b in bins), 2)
    return f"{plain(min(means), 2)} to {plain(max(means), 2)} with scatter up to {scatter}"
