"""The runs of a case as they were recorded, and how a fault changes some channels of some runs."""

from collections.abc import Callable, Mapping
from functools import wraps
from typing import Any

import numpy as np

from tsas_studies.challenge.rig.motions import Floats
from tsas_studies.challenge.rig.recordings import Run

STEPS = {"x_in_mm": 0.002, "x_out_mm": 0.002, "f_in_N": 0.01, "f_out_N": 0.01}
CHANNELS = tuple(STEPS)
FORCES = ("f_in_N", "f_out_N")
Runs = Mapping[str, Run]


def of_runs(change: Callable[..., Run]) -> Callable[..., Runs]:
    """Return the fault of `change(old, rng, **parameters)`, in one `run` alone if it is named."""

    @wraps(change)
    def fault(
        runs: Runs, rng: np.random.Generator, *, run: str | None = None, **parameters: Any
    ) -> Runs:
        return {
            name: change(old, rng, **parameters) if run in (None, name) else old
            for name, old in runs.items()
        }

    return fault


def of_channels(change: Callable[..., Floats]) -> Callable[..., Runs]:
    """Return the fault of `change(time_s, values, rng, **parameters)`, of `channels` or `channel`.

    In one `run` alone if it is named.
    """

    @of_runs
    @wraps(change)
    def fault(
        old: Run,
        rng: np.random.Generator,
        *,
        channels: tuple[str, ...] = (),
        channel: str | None = None,
        **parameters: Any,
    ) -> Run:
        names = channels if channel is None else (channel,)
        return old.having(
            **{c: change(old.time_s, old.columns[c], rng, **parameters) for c in names}
        )

    return fault
