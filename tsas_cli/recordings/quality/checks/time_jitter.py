"""The sample interval scatters.

A logger on a busy computer, or rounded time stamps. The scatter is the RMS about the usual
interval, without gaps; it is reported above 5 %. The usual interval is the mean without the
shortest and longest twentieth: where a logger makes late stamps increase, half are too close.
"""

from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark
from tsas_cli.recordings.quality.trial import RunSignals

_TOLERATED = 0.05


def find(trial: RunSignals) -> Iterator[Remark | CannotTell]:
    """Yield the scatter of the intervals about their median if it exceeds the limit."""
    if not trial.increases:
        yield CannotTell("time does not increase")
        return
    if trial.batches is not None:
        yield CannotTell("rows come in batches")
        return
    interval = np.diff(trial.time_s)
    usual = float(np.mean(np.sort(interval)[interval.size // 20 : -(interval.size // 20) or None]))
    steady = interval < 2.5 * usual
    scatter = float(np.sqrt(np.mean((interval[steady] / usual - 1.0) ** 2)))
    if scatter > _TOLERATED:
        yield Remark(
            "warning",
            f"the sample interval scatters by {100 * scatter:.3g} % about {1e3 * usual:.4g} ms "
            f"(from {1e3 * interval.min():.4g} to {1e3 * interval[steady].max():.4g} ms)",
            "record with the clock of the data acquisition instead of the computer's",
            "time_s",
        )


CHECK = QualityCheck("time-jitter", find)
