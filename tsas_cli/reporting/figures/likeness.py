"""How much each two effects look alike, as squares below a diagonal of names."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.drawing import WIDTH_IN

Floats = npt.NDArray[np.float64]

_FAINT = 0.2  # below it a square is too small to see
_ROW_IN = 0.21
_NAMES_IN = 2.0  # of the longest name
_CORNERS = np.array([(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5), (-0.5, -0.5)])


def height_in(effects: int) -> float:
    """Return the height in inches that a plot of so many effects needs."""
    return 0.5 + _ROW_IN * effects


def draw_likeness(figure: Any, effects: Sequence[str], likeness: Floats, *, alike: float) -> None:
    """Draw a square for each two effects, its side the likeness.

    Parameters
    ----------
    figure
        The matplotlib figure to draw on.
    effects
        Their names, shape (n,), the first on top.
    likeness
        From 0 to 1, shape (n, n); only what is below the diagonal is read.
    alike
        From which likeness on the square is in the loud colour.
    """
    axes = figure.add_subplot()
    n = len(effects)
    for role, low, high, label in (
        ("alike", alike, np.inf, f"alike, {alike} or more"),
        ("muted", _FAINT, alike, f"less than {alike}"),
    ):
        pairs = [(i, j) for i in range(n) for j in range(i) if low <= likeness[i, j] < high]
        _squares(axes, pairs, [float(likeness[pair]) for pair in pairs], role=role, label=label)
    for place, name in enumerate(effects):
        axes.text(place - 0.4, place, name, va="center", fontsize=9)
        axes.plot([-0.5, place - 0.5], [place + 0.5] * 2, color=STAND_IN["line"], linewidth=0.6)
        axes.plot([place - 0.5] * 2, [place + 0.5, n - 0.5], color=STAND_IN["line"], linewidth=0.6)
    cell_in = min(_ROW_IN, (WIDTH_IN - _NAMES_IN) / n)
    axes.set(xlim=(-0.6, WIDTH_IN / cell_in), ylim=(n - 0.4, -0.6))
    axes.set_axis_off()
    figure.legend(loc="outside upper left", ncols=2, handlelength=1.0, columnspacing=1.2)


def _squares(
    axes: Any, pairs: Sequence[tuple[int, int]], sides: Sequence[float], *, role: str, label: str
) -> None:
    """Draw all squares of one colour as one path."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    if not pairs:
        return
    squares = [
        Path(_CORNERS * 0.94 * side + (column, row), closed=True)
        for (row, column), side in zip(pairs, sides, strict=True)
    ]
    patch = PathPatch(Path.make_compound_path(*squares), linewidth=0, label=label)
    patch.set_facecolor(STAND_IN[role])
    axes.add_patch(patch)
