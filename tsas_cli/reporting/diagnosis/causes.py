"""Each effect that gains: what it is, its equation, its parameters, its rivals, its gain.

A stand-in says what it does not prove.
"""

from collections.abc import Iterable, Iterator, Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from tsas_cli.records.base import Value
from tsas_cli.records.diagnosis import DescribedLaw, DiagnosisFile, NamedCause
from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.content import Section, anchor
from tsas_cli.reporting.drawing import picture
from tsas_cli.reporting.inputs import Inputs
from tsas_cli.reporting.names import EFFECT, heading_of, sentence_of, title_of, within
from tsas_cli.reporting.numbers import ABSENT, plain, value_and_interval, with_interval
from tsas_cli.support.wording import listed

Numbers = tuple[float, ...]

NOTHING = 0.01  # of the larger curve of a law: a smaller one is not drawn
WIDEST_BAND = 1.5  # spans of a curve to either side, that are drawn of its band


def parts(causes: Iterable[NamedCause], inputs: Inputs, reason: str = "") -> Iterator[Section]:
    """Yield one part for each named cause or stand-in, without failures that `reason` says."""
    for cause in causes:
        law = EFFECT[cause.effect].equation if cause.effect in EFFECT else ""
        equation = cause.equation or law
        failed = [f"It {failure}." for failure in cause.failed if failure not in reason]
        differs = f"Its law differs from this {cause.law_differs}." if cause.law_differs else ""
        rivals = (
            "In these recordings it is indistinguishable from "
            f"{within(title_of(rival))} (`{rival}`). {sentence_of(rival)}"
            for rival in cause.rivals
        )
        yield Section(
            anchor("diagnosis", cause.effect),
            f"Not proven: {within(heading_of(cause))}" if cause.failed else heading_of(cause),
            tuple(filter(None, (sentence_of(cause.effect), *failed, differs))),
            equations=tuple(equation.split(",  ")) if equation else (),
            points=tuple(_parameter_points(cause.parameters, inputs)),
            closing=(*rivals, *_gain(cause)),
            folded=bool(cause.failed),
        )


def _parameter_points(parameters: Mapping[str, Value], inputs: Inputs) -> Iterator[str]:
    """Yield each parameter with its interval, unit and whether it is at its bound."""
    for name, p in parameters.items():
        if inputs.concerns(name):
            value, interval = value_and_interval(p)
            text = f"`{name}` {value} {p.unit or ''}".removesuffix(" 1").rstrip()
            text += "" if interval == ABSENT else f", 95 % interval {interval}"
            yield f"{text}, at its bound" if p.at_bound else text


def _gain(cause: NamedCause) -> Iterator[str]:
    if cause.gain_percent is None:
        return
    low, high = cause.gain_interval_percent or (None, None)
    gain, interval = with_interval(cause.gain_percent, low, high)
    if interval == ABSENT:
        gain, sure = plain(cause.gain_percent, 3), ""
    else:
        sure = f" (95 % interval {interval} %)"
    yield f"On held-out data it lowers the normalised residual by {gain} %{sure}."


def law_parts(diagnosis: DiagnosisFile, inputs: Inputs) -> Iterator[Section]:
    """Yield a part for each law, and its parameters, folded."""
    for law in diagnosis.laws:
        said = [law.sentence]
        if law is diagnosis.laws[0]:
            said.append("It describes what no proven cause explains; it is no cause.")
        if law.rivals:
            said.append(f"Just as well do: {listed(law.rivals)}.")
        where = "; ".join(curve.where for curve in _curves(law))
        caption = f"{where[:1].upper()}{where[1:]}. Bands: 95 % intervals, cut at the frame."
        drawn = picture(partial(_draw_law, law=law), key=law.law, alt=law.sentence, caption=caption)
        yield Section(
            anchor("diagnosis", law.law),
            law.title,
            tuple(said),
            equations=(law.equation,),
            pictures=(drawn,) if where else (),
        )
        yield Section(
            anchor("parameters", law.law),
            f"Parameters: {within(law.title)}",
            points=tuple(_parameter_points(law.parameters, inputs)),
            folded=True,
        )


class _Curve(NamedTuple):
    """A curve of a law: where it holds, its axis and marker, its points, shape (n,)."""

    where: str
    label: str
    marker: str
    x: Numbers
    y: Numbers
    margin: Numbers


def _curves(law: DescribedLaw) -> list[_Curve]:
    """Return what a law does after a reversal and along the stroke, without what does nothing."""
    reversal = law.travel_mm, law.after_reversal, law.after_reversal_margin
    stroke = law.place_mm, law.along_stroke, law.along_stroke_margin
    after, along = "after a reversal, at the mean tension", "along the stroke"
    both = (
        _Curve(after, "travel since reversal [mm]", "", *reversal),
        _Curve(along, "displacement [mm]", "o", *stroke),
    )
    spans = [float(np.ptp(curve.y)) if curve.y else 0.0 for curve in both]
    return [c for c, span in zip(both, spans, strict=True) if span > NOTHING * max(spans)]


def _draw_law(figure: Any, law: DescribedLaw) -> None:
    """Draw the curves of a law beside each other; one alone takes half the width."""
    for axes, curve in zip(figure.subplots(1, 2), [*_curves(law), None, None], strict=False):
        axes.set_visible(curve is not None)
        if curve is not None:
            axes.set(xlabel=curve.label, ylabel=law.what)
            _with_band(axes, curve.x, curve.y, curve.margin, curve.marker)


def _with_band(axes: Any, x: Numbers, y: Numbers, margin: Numbers, marker: str) -> None:
    """Draw a curve with its 95 % interval, cut where it would hide the curve; older files: none."""
    axes.plot(x, y, color=STAND_IN["after"], marker=marker, markersize=3.0)
    axes.set_xlim(min(x), max(x))
    if margin:
        low, high = np.subtract(y, margin), np.add(y, margin)
        axes.fill_between(x, low, high, color=STAND_IN["after"], alpha=0.2, linewidth=0.0)
        around = WIDEST_BAND * np.ptp(y)
        axes.set_ylim(max(min(low), min(y) - around), min(max(high), max(y) + around))
