"""What both sides leave of each channel over time, run by run, on the same axes."""

from functools import partial

import numpy as np

from tsas_cli.comparing.compare import Comparison
from tsas_cli.comparing.predictions import Both, channels
from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.records.comparison import shared_name
from tsas_cli.reporting.content import Group, Picture, Section
from tsas_cli.reporting.drawing import picture
from tsas_cli.reporting.numbers import plain
from tsas_cli.reporting.two_residuals import Residuals, draw_two_residuals, height_in

_MOST_RUNS = 10


def section(it: Comparison) -> Section:
    """Return the section of the residuals, one group per run that both answer to."""
    left = len(it.shared) - _MOST_RUNS
    more = f" The first {_MOST_RUNS} of {len(it.shared)} runs are shown." if left > 0 else ""
    groups = tuple(
        Group(f"Run {shared_name(*both.ids)}", pictures)
        for number, both in enumerate(it.shared[:_MOST_RUNS])
        if (pictures := _pictures(both, number))
    )
    what = "Measured minus simulated. Noise alone leaves 95 % between the dashed lines."
    return Section("residuals", "Residuals over time", (what + more,), groups=groups)


def _pictures(both: Both, number: int) -> tuple[Picture, ...]:
    if both.a is None or both.b is None:
        return ()
    a, b = both.a, both.b
    panels, said = [], []
    for name in channels(both):
        errors = a.errors.get(name), b.errors.get(name)
        if any(error is None or not np.isfinite(error).any() for error in errors):
            continue
        unit = BY_NAME[name].unit
        label = f"{name.rsplit('_', 1)[0]} [{unit}]"
        time_s, noise = a.run.time_s, a.noise(name)
        panels.append(Residuals(label, time_s, a.errors[name], b.errors[name], noise))
        said.append(f"{name} A {plain(a.rmse(name), 3)}, B {plain(b.rmse(name), 3)} {unit}")
    if not panels:
        return ()
    run = shared_name(*both.ids)
    return (
        picture(
            partial(draw_two_residuals, panels=panels),
            key=f"residuals-{number}",
            alt=f"Run {run}: measured minus simulated over time, of A and of B. "
            f"Root mean square: {'; '.join(said)}.",
            caption=f"RMSE: {'; '.join(said)}.",
            height_in=height_in(len(panels)),
        ),
    )
