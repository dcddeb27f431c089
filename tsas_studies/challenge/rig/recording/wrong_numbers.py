"""Numbers in another unit than is written down, and a manifest that is wrong."""

from dataclasses import replace

import numpy as np

from tsas_studies.challenge.rig.motions import Floats
from tsas_studies.challenge.rig.recording.recorded import of_channels, of_runs
from tsas_studies.challenge.rig.recordings import Run


@of_channels
def scaled(_time_s: Floats, values: Floats, _rng: np.random.Generator, *, factor: float) -> Floats:
    """Return a channel by a factor: another unit, or the radius of a wheel for its diameter."""
    return factor * values


@of_runs
def wrong_condition(old: Run, _rng: np.random.Generator, *, key: str, factor: float) -> Run:
    """Return a run of which the manifest says another value."""
    return replace(old, conditions={**old.conditions, key: factor * old.conditions[key]})
