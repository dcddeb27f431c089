"""What several figures have in common: thinned curves over time, bounds, legends."""

from typing import Any

from tsas_cli.reporting.colours import STAND_IN
from tsas_cli.reporting.decimation import POINTS, kept_samples
from tsas_cli.support.arrays import Floats


def line(axes: Any, time_s: Floats, values: Floats, *, points: int = POINTS, **style: Any) -> None:
    """Draw values over time, with as many points as the plot can show."""
    kept = kept_samples(values, points=points)
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
    """Name above the plot what is drawn; of `axes` alone where all panels show the same."""
    named = () if axes is None else axes.get_legend_handles_labels()
    figure.legend(
        *named, loc="outside upper left", ncols=ncols, handlelength=handlelength, columnspacing=1.2
    )
