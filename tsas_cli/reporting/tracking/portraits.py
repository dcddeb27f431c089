"""Phase portraits: the rate of the drive's error over the error, as the controllers see them."""

from functools import partial

import numpy as np
import numpy.typing as npt

from tsas_cli.controllers.signals import ORDER, error_filter, filtered
from tsas_cli.records.tracking import Settings
from tsas_cli.reporting.content import Picture, Section
from tsas_cli.reporting.drawing import picture
from tsas_cli.reporting.numbers import plain
from tsas_cli.reporting.tracking.orbits import Orbit, draw_portraits, portraits_in
from tsas_cli.reporting.tracking.runs import X_IN, X_INV, Condition, Followed

Floats = npt.NDArray[np.float64]


def part(conditions: tuple[Condition, ...], settings: Settings) -> Section:
    """Return the part, one picture for each condition."""
    what = (
        "The rate of the error e = x_inv − x_in of the drive over the error, both by the filter of "
        f"the sliding modes ({settings.loop.filter_Hz:g} Hz). A turn of the wanted force throws a "
        "controller off, over a dead band; what it does until it is back at the cross is the loop. "
        "Each panel has scales of its own."
    )
    pictures = tuple(_picture(condition, settings) for condition in conditions)
    return Section("tracking-phase", "Phase portraits", (what,), pictures=pictures)


def _picture(condition: Condition, settings: Settings) -> Picture:
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


def _error_and_rate(run: Followed, settings: Settings) -> tuple[Floats, Floats]:
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
