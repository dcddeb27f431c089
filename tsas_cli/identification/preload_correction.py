"""Mean difference of fitted and stated preloads, for runs that were not fitted."""

from collections.abc import Sequence

import numpy as np

from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import CORRECTION, Model
from tsas_cli.identification.prepared import Prepared


def with_preload_correction(model: Model, runs: Sequence[Prepared]) -> Model:
    """Return a model with the mean difference of fitted and stated preload.

    Its interval is a prediction interval for a further run; it needs two runs.
    """
    from scipy.stats import t

    fitted = {e.run: e.value for e in model.estimates if e.name == "preload_N" and e.stderr}
    differences = [
        fitted[r.run.id] - r.run.preload_N
        for r in runs
        if r.run.id in fitted and r.run.preload_N is not None
    ]
    count = len(differences)
    if count < 2:
        return model
    mean = float(np.mean(differences))
    spread = float(np.std(differences, ddof=1)) * (1.0 + 1.0 / count) ** 0.5
    half = float(t.ppf(0.975, count - 1)) * spread
    correction = Estimate(
        CORRECTION,
        mean,
        "N",
        "fitted",
        stderr=spread,
        interval_low=mean - half,
        interval_high=mean + half,
    )
    return Model((correction,)).over(model)
