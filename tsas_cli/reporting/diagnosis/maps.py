"""Where the error was and where it is now: its mean and scatter over the strongest signals."""

import math
from collections.abc import Iterator
from functools import partial

from tsas_cli.reporting.content import Picture, Section
from tsas_cli.reporting.diagnosis.words import listed, signal_at_axis, signal_in_words
from tsas_cli.reporting.drawing import picture
from tsas_cli.reporting.figures.residual_map import Panel, draw_residual_map, height_in
from tsas_cli.reporting.numbers import plain
from tsas_cli.reporting.stage_files import Bin, Diagnosis

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
    strength: dict[str, float] = {}
    for panel in _panels(diagnosis):
        strength[panel.signal] = max(strength.get(panel.signal, 0.0), _strength(panel))
    seen = [name for name, size in strength.items() if size > _SEEN]
    if not seen:
        nothing = "Over no signal does the error stand out of the noise."
        return Section("diagnosis-maps", title, (nothing,))
    strongest = sorted(seen, key=lambda name: -strength[name])[:_SIGNALS]
    pictures = tuple(_picture(diagnosis, signal) for signal in strongest)
    return Section("diagnosis-maps", title, (_WHAT,), pictures=pictures)


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


def _picture(diagnosis: Diagnosis, signal: str) -> Picture:
    panels = [p for p in _panels(diagnosis) if p.signal == signal and _strength(p) > _SEEN]
    words = signal_in_words(signal)
    return picture(
        partial(draw_residual_map, panels=panels, label=signal_at_axis(signal)),
        key=f"diagnosis-map-{signal}",
        alt=f"Mean error over the {words}, in units of noise. {'; '.join(map(_in_words, panels))}.",
        caption=f"{listed([p.channel for p in panels])} over the {words}.",
        height_in=height_in(panels),
    )


def _in_words(panel: Panel) -> str:
    if not panel.after:
        return f"{panel.channel}: {_range(panel.before)}"
    return f"{panel.channel}: before {_range(panel.before)}, after {_range(panel.after)}"


def _range(bins: tuple[Bin, ...]) -> str:
    means = [b.mean for b in bins]
    scatter = plain(max(b.sd for b in bins), 2)
    return f"{plain(min(means), 2)} to {plain(max(means), 2)} with scatter up to {scatter}"
