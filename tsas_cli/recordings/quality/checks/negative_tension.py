"""A tension is negative for part of the run.

A tendon cannot push. Most often the sensor was zeroed under preload, so that the column holds the
change of the tension; or it reads the difference of two tendons; or its zero has drifted.
"""

from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark
from tsas_cli.recordings.quality.trial import RunSignals

_SPAN = 0.02  # of the range, below zero: a slack tendon on a sensor with a small offset


def find(trial: RunSignals) -> Iterator[Remark | CannotTell]:
    """Yield the tensions with negative values that neither noise nor a small offset explains."""
    for name in trial.mechanical:
        if not name.startswith("f_"):
            continue
        values = trial.channels[name]
        limit = max(trial.visible(name), _SPAN * trial.sizes[name].span)
        low, high = np.nanpercentile(values, (0.5, 98.0))
        if low < -limit and high >= -trial.visible(name):  # else the sign check reports it
            share = 100.0 * float(np.mean(values < 0.0))
            yield Remark(
                "warning",
                f"{name} is negative in {share:.3g} % of the samples, down to {low:.4g} N",
                "add the preload at ingest if the sensor was zeroed under it, or correct its "
                "offset; only the difference of two tendons may be negative",
                name,
                float(trial.time_s[np.argmax(values < -limit)]),
            )


CHECK = QualityCheck("negative-tension", find, of_long="strokes")
