"""Numbers in another unit than is written down, and a manifest that is wrong."""

from dataclasses import replace

import numpy as np

from tsas_studies.challenge.rig.recording.recorded import Runs, changed


def scaled(
    runs: Runs, _rng: np.random.Generator, *, channels: tuple[str, ...], factor: float
) -> Runs:
    """Return channels by a factor: another unit, or the radius of a wheel for its diameter."""
    return changed(runs, channels, lambda _t, v: factor * v)


def wrong_condition(
    runs: Runs, _rng: np.random.Generator, *, run: str | None, key: str, factor: float
) -> Runs:
    """Return runs of which the manifest says another value; one of them, or all for None."""
    return {
        name: replace(old, conditions={**old.conditions, key: factor * old.conditions[key]})
        if run in (None, name)
        else old
        for name, old in runs.items()
    }
