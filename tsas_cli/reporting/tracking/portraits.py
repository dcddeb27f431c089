"""Phase portraits: the rate of the drive's error over the error, as the controllers see them."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from tsas_cli.controllers.signals import ORDER, error_filter, filtered
from tsas_cli.records.tracking import StatedSettings
from tsas_cli.reporting.colours import STAND_IN, of_controller
from tsas_cli.reporting.content import Picture, Section
from tsas_cli.reporting.drawing import kept_cells, picture
from tsas_cli.reporting.numbers import plain
from tsas_cli.reporting.tracking.runs import X_IN, X_INV, RunsUnderCondition, TrackedRun
from tsas_cli.support.arrays import Floats

_ACROSS = 2


@dataclass(frozen=True)
class Orbit:
    """A curve in the plane of one controller, shape (n,) each."""

    name: str
    x: Floats
    y: Floats


def part(conditions: tuple[RunsUnderCondition, ...], settings: StatedSettings) -> Section:
    """Return the part, one picture for each condition."""
    what = (
        "The rate of the error e = x_inv − x_in of the drive over the error, both by the filter of "
        f"the sliding modes ({settings.loop.filter_Hz:g} Hz). A turn of the wanted force throws a "
        "controller off, over a dead band; what it does until it is back at the cross is the loop. "
        "Each panel has scales of its own."
    )
    pictures = tuple(_picture(condition, settings) for condition in conditions)
    return Section("tracking-phase", "Phase portraits", (what,), pictures=pictures)


def _picture(condition: RunsUnderCondition, settings: StatedSettings) -> Picture:
    orbits = [Orbit(run.name, *_error_and_rate(run, settings)) for run in condition.runs]
    said = "; ".join(
        f"{o.name} error up to {plain(_most(o.x), 3)} mm, rate up to {plain(_most(o.y), 3)} mm/s"
        for o in orbits
    )
    return picture(
        partial(draw_portraits, orbits=orbits, labels=("e [mm]", "de/dt [mm/s]")),
        key=f"tracking-phase-{condition.number}",
        alt=f"Phase portraits of the drive's error, {condition.name}: {said}.",
        caption=f"{condition.name.capitalize()}: rate of the drive's error over the error.",
        height_in=portraits_in(len(orbits)),
    )


def _error_and_rate(run: TrackedRun, settings: StatedSettings) -> tuple[Floats, Floats]:
    """Return what the filter of the controllers makes of the run's error, shape (n,) each."""
    A, b = error_filter(settings.loop.filter_Hz, 1.0 / settings.sensor.rate_Hz)
    state, error = np.zeros(ORDER), run.columns[X_INV] - run.columns[X_IN]
    both = np.empty((2, error.size))
    for k, e in enumerate(error):
        filtered(state, e, A, b)
        both[:, k] = state[:2]
    return both[0], both[1]


def _most(values: Floats) -> float:
    return float(np.abs(values).max())


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
