"""Phase portraits, one panel for each controller."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from tsas_cli.reporting.colours import STAND_IN, of_controller
from tsas_cli.reporting.decimation import kept_cells

Floats = npt.NDArray[np.float64]
_ACROSS = 2


@dataclass(frozen=True)
class Orbit:
    """A curve in the plane of one controller, shape (n,) each."""

    name: str
    x: Floats
    y: Floats


def portraits_in(orbits: int) -> float:
    """Return the height in inches that so many panels need."""
    return 0.5 + 2.0 * -(-orbits // _ACROSS) if orbits > 1 else 3.5


def draw_portraits(figure: Any, *, orbits: Sequence[Orbit], labels: tuple[str, str]) -> None:
    """Draw each orbit in a panel with scales of its own, zero as a cross; labels of both axes."""
    across = min(_ACROSS, len(orbits))
    panels = figure.subplots(-(-len(orbits) // across), across, squeeze=False)
    for axes in panels.flat[len(orbits) :]:
        axes.set_axis_off()
    for axes, orbit in zip(panels.flat, orbits, strict=False):
        axes.axhline(0.0, color=STAND_IN["muted"], linewidth=0.9)
        axes.axvline(0.0, color=STAND_IN["muted"], linewidth=0.9)
        kept = kept_cells(orbit.x, orbit.y)
        axes.plot(orbit.x[kept], orbit.y[kept], color=of_controller(orbit.name), linewidth=0.8)
        axes.set_title(orbit.name, loc="left", fontsize=9.0, pad=3.0)
        axes.locator_params(nbins=5)
    for axes in panels[-1]:
        axes.set_xlabel(labels[0])
    for axes in panels[:, 0]:
        axes.set_ylabel(labels[1])
