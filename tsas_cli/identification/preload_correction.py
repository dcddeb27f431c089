"""By how much fitted preloads miss what the manifest states, for runs that were not fitted."""

from collections.abc import Sequence

import numpy as np

from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import CORRECTION, Model
from tsas_cli.identification.prepared import Prepared


def with_preload_correction(model: Model, runs: Sequence[Prepared]) -> Model:
    """Renew the mean difference of fitted and stated preload, for runs that were not fitted.

    Its interval is the one that a further run's difference lies in; one run alone gives none.
    """
    from scipy.stats import t

    fitted = {e.run: e.value for e in model.estimates if e.name == "preload_N" and e.stderr}
    off = [
        fitted[r.run.id] - r.run.preload_N
        for r in runs
        if r.run.id in fitted and r.run.preload_N is not None
    ]
    count = len(off)
    if count < 2:
        return model
    mean = float(np.mean(off))
    spread = float(np.std(off, ddof=1)) * (1.0 + 1.0 / count) ** 0.5
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
