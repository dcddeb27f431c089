"""From a drawing function to inline SVG that follows the page's colours and never changes.

Below it is what several figures have in common: thinned curves over time, bounds, legends.
"""

import io
import json
import re
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
from markupsafe import Markup

from tsas_cli.reporting.colours import STAND_IN, themed
from tsas_cli.reporting.content import Picture, anchor
from tsas_cli.support.arrays import Floats, Indices
from tsas_cli.support.errors import printable

POINTS = 2400  # a bin is then narrower than a pixel of a plot of 30 rem
FEWEST = 200
CELLS = 300  # across and down a plot of half that width
WIDTH_IN = 4.6  # a phone shows this at about its own size, so that the text stays readable
_STYLE: dict[Any, Any] = {
    "svg.fonttype": "none",
    "svg.hashsalt": "tsas",
    "text.parse_math": False,
    "font.size": 10.0,
    "axes.labelsize": 10.0,
    "xtick.labelsize": 9.5,
    "ytick.labelsize": 9.5,
    "legend.fontsize": 9.5,
    "legend.frameon": False,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.edgecolor": STAND_IN["muted"],
    "axes.labelcolor": STAND_IN["ink"],
    "axes.facecolor": "none",
    "axes.unicode_minus": True,
    "figure.facecolor": "none",
    "grid.color": STAND_IN["line"],
    "grid.linewidth": 0.7,
    "text.color": STAND_IN["ink"],
    "xtick.color": STAND_IN["muted"],
    "ytick.color": STAND_IN["muted"],
    "xtick.labelcolor": STAND_IN["ink"],
    "ytick.labelcolor": STAND_IN["ink"],
    "lines.linewidth": 1.3,
}
_LONGEST, _LONGEST_UPRIGHT, _LONGEST_TICK = 48, 44, 22  # letters
_NOTHING = {"Creator": None, "Date": None, "Format": None, "Type": None}
_SVG = "{http://www.w3.org/2000/svg}"
_NAMED = re.compile(r"(axes|legend|[xy]tick)_\d")  # what the page's script looks for
_LINK = "{http://www.w3.org/1999/xlink}href"


def picture(
    draw: Callable[[Any], None],
    *,
    key: str,
    alt: str,
    caption: str,
    height_in: float = 3.5,
    every_point: bool = False,
) -> Picture:
    """Draw on an empty matplotlib figure and return it as a picture of the page.

    `draw` draws on the `matplotlib.figure.Figure` that it is given, with colours of `STAND_IN`.
    `key` is another one for each picture of the page, for the names inside the SVG; `alt` says what
    the plot shows to a reader who does not see it. The height is that at a width of `WIDTH_IN`.
    With `every_point` the same place in two curves is the same sample.
    """
    from matplotlib.figure import Figure
    from matplotlib.style import context

    with (
        context(["default", _STYLE | {"path.simplify": not every_point}]),
        warnings.catch_warnings(),
    ):
        # The browser's fonts hold more letters than the one that measures here.
        warnings.filterwarnings("ignore", message="Glyph .* missing from", category=UserWarning)
        figure = Figure(figsize=(WIDTH_IN, height_in), layout="constrained")
        draw(figure)
        _shorten(figure)
        stream = io.StringIO()
        figure.savefig(stream, format="svg", metadata=_NOTHING)
        scales = {f"axes_{number}": _scales(axes) for number, axes in enumerate(figure.axes, 1)}
    # Control characters in names from files, some of which XML cannot hold, are made visible.
    text = "\n".join(map(printable, stream.getvalue().split("\n")))
    svg = _inline(text, key=anchor(key), alt=alt, scales=scales)
    return Picture(svg=svg, caption=caption)


def _scales(axes: Any) -> dict[str, str]:
    """Return what the page's script needs to read values off a plot with linear axes."""
    if axes.get_xscale() != "linear" or axes.get_yscale() != "linear" or not axes.axison:
        return {}
    ends = {"data-x": axes.get_xlim(), "data-y": axes.get_ylim()}
    return {name: " ".join(f"{end:.7g}" for end in both) for name, both in ends.items()} | {
        "data-names": json.dumps([axes.get_xlabel(), axes.get_ylabel()])
    }


def shortened(text: str, most: int) -> str:
    """Return a text with its middle left out where it has more letters.

    >>> shortened("a-long-name-of-a-run", 11)
    'a-lon…a-run'
    """
    half = most // 2
    return text if len(text) <= most else f"{text[:half]}…{text[len(text) - (most - half - 1) :]}"


def _shorten(figure: Any) -> None:
    """Shorten long names from files, which would leave no room for the plot."""
    from matplotlib.text import Text

    for text in figure.findobj(Text):
        text.set_text("\n".join(shortened(one, _LONGEST) for one in text.get_text().split("\n")))
    for axes in figure.axes:
        upright = axes.yaxis.label
        upright.set_text(shortened(upright.get_text(), _LONGEST_UPRIGHT))
        for axis in (axes.xaxis, axes.yaxis):
            names = [label.get_text() for label in axis.get_ticklabels()]
            if any(len(name) > _LONGEST_TICK for name in names):
                axis.set_ticks(
                    axis.get_ticklocs(), [shortened(name, _LONGEST_TICK) for name in names]
                )


def _inline(text: str, *, key: str, alt: str, scales: Mapping[str, Mapping[str, str]]) -> Markup:
    """Strip what only a file needs, make the ids the picture's own, shorten the numbers."""
    root = ET.fromstring(text)  # noqa: S314  our own output
    for parent in list(root.iter()):
        for style in parent.findall(f"{_SVG}defs/{_SVG}style/.."):
            parent.remove(style)  # it would hold for the whole page
    known = set(re.findall(r"#([\w.-]+)", text)) | set(scales)
    for element in root.iter():
        element.tag = element.tag.removeprefix(_SVG)
        if not _NAMED.match(name := element.attrib.get("id", "")) and name not in known:
            element.attrib.pop("id", None)
        attributes = {
            "href" if name == _LINK else name: _own(name, value, key)
            for name, value in element.attrib.items()
        }
        if attributes.get("transform", "").startswith("rotate(-0 "):
            del attributes["transform"]
        attributes |= scales.get(element.attrib.get("id", ""), {})
        element.attrib.clear()
        element.attrib.update(attributes)
        element.tail = None
    for name in ("width", "height", "version"):
        root.attrib.pop(name, None)
    root.attrib.update({"role": "img", "aria-label": printable(alt.replace("`", ""))})
    return Markup(themed(ET.tostring(root, encoding="unicode")))  # noqa: S704


def _own(name: str, value: str, key: str) -> str:
    if name == "id":
        return f"{key}-{value}"
    if name == _LINK:
        return f"#{key}-{value[1:]}"
    if name in {"d", "x", "y", "transform"}:
        short = re.sub(r"\d+\.\d{3,}", lambda number: f"{float(number[0]):.2f}", value)
        return re.sub(r"\s*([A-Zz])\s*", r"\1", short) if name == "d" else short
    if name == "style":  # the page has letters of its own
        value = re.sub(r"font-family: [^;]*; ", "", value)
    return value.replace("url(#", f"url(#{key}-")


def stacked(figure: Any, count: int, **options: Any) -> Any:
    """Return so many axes below each other; the options are those of `Figure.subplots`."""
    return figure.subplots(count, 1, squeeze=False, **options)[:, 0]


def line(axes: Any, time_s: Floats, values: Floats, **style: Any) -> None:
    """Draw values over time, with as many points as the plot can show."""
    kept = kept_samples(values)
    axes.plot(time_s[kept], values[kept], **style)


def bound(axes: Any, value: float, **style: Any) -> None:
    """Draw a bound, dashed."""
    look = {"color": STAND_IN["ink"], "linewidth": 1.0, "linestyle": (0, (4, 3)), "zorder": 3}
    axes.axhline(value, **look, **style)


def noise_bounds(axes: Any, noise: float | None) -> None:
    """Draw twice the noise to both sides of zero, where it is known."""
    if noise is not None:
        bound(axes, 2.0 * noise, label="± 2 × noise")
        bound(axes, -2.0 * noise)


def legend(figure: Any, axes: Any = None, *, ncols: int = 2, handlelength: float = 1.6) -> None:
    """Draw a legend above the plot, of `axes` alone where all panels show the same."""
    named = () if axes is None else axes.get_legend_handles_labels()
    figure.legend(
        *named, loc="outside upper left", ncols=ncols, handlelength=handlelength, columnspacing=1.2
    )


@dataclass(frozen=True)
class Residuals:
    """One panel: its name at the axis, time [s], both residuals, shape (n,) each, and the noise."""

    label: str
    time_s: Floats
    first: Floats
    second: Floats
    noise: float | None


def two_residuals(
    panels: Sequence[Residuals],
    *,
    names: tuple[str, str] = ("A", "B"),
    key: str,
    alt: str,
    caption: str,
) -> Picture:
    """Return the picture of panels below each other; the arguments are those of `picture`."""
    height_in = max(0.8 + 1.3 * len(panels), 2.7)
    draw = partial(_draw_two_residuals, panels=panels, names=names)
    return picture(draw, key=key, alt=alt, caption=caption, height_in=height_in)


def _draw_two_residuals(
    figure: Any, *, panels: Sequence[Residuals], names: tuple[str, str]
) -> None:
    """Draw the panels; the smaller residual is drawn over the larger one."""
    rows = stacked(figure, len(panels), sharex=True)
    for axes, panel in zip(rows, panels, strict=True):
        both = panel.first, panel.second
        least = min(float(np.nanstd(values)) for values in both)
        for name, values, role in zip(names, both, ("before", "after"), strict=True):
            order = 2.2 if float(np.nanstd(values)) <= least else 2.1
            style = {"color": STAND_IN[role], "linewidth": 0.7, "label": name, "zorder": order}
            line(axes, panel.time_s, values, **style)
        noise_bounds(axes, panel.noise)
        axes.set_ylabel(panel.label)
    rows[-1].set_xlabel("time [s]")
    figure.align_ylabels()
    legend(figure, rows[0], ncols=3)


def kept_samples(*series: Floats, points: int = POINTS) -> Indices:
    """Return the samples that a plot needs: the extremes of every series in each of equal bins.

    The first and the last sample are always kept, the last bin may be shorter than the others,
    and a bin without any number keeps one sample, so that a gap stays a gap.

    `series` are channels over the same samples, shape (n,) each, NaN for gaps; about `points`
    samples are kept.
    """
    n = series[0].size
    if n <= points:
        return np.arange(n)
    width = -(-n * 2 * len(series) // points)
    starts = np.arange(0, n, width)
    kept = [np.array([0, n - 1])]
    for values in series:
        padded = np.full(starts.size * width, np.nan)
        padded[:n] = values
        bins = padded.reshape(-1, width)
        missing = np.isnan(bins)
        kept.append(starts + np.where(missing, np.inf, bins).argmin(axis=1))
        kept.append(starts + np.where(missing, -np.inf, bins).argmax(axis=1))
    return np.unique(np.concatenate(kept))


def shared_points(curves: int, total: int) -> int:
    """Return about how many points each of so many curves may have, so that a page stays small.

    >>> shared_points(3, 30_000), shared_points(30, 30_000), shared_points(3000, 30_000)
    (2400, 1000, 200)
    """
    return min(max(total // max(curves, 1), FEWEST), POINTS)


def kept_cells(x: Floats, y: Floats) -> Indices:
    """Return the samples at which a curve in a plane enters another cell of an even grid.

    The curve keeps its shape to within a cell, whatever its speed along it. `x` and `y` have shape
    (n,), without gaps; the grid has `CELLS` cells along each axis of the curve's range.
    """
    both = np.stack((x, y))
    spans = np.ptp(both, axis=1, keepdims=True)
    shares = (both - both.min(axis=1, keepdims=True)) / np.where(spans > 0.0, spans, 1.0)
    enters = (np.diff(np.floor(shares * CELLS)) != 0).any(axis=0)
    return np.unique(np.concatenate(([0], np.flatnonzero(enters) + 1, [x.size - 1])))
