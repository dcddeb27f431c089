"""A channel is updated less often than the rows are written.

Its sensor updates at a lower rate and the logger repeats the last value (zero-order hold), so the
channel is late by half an update on average. An encoder in slow motion also rests between its
steps, but moves by one step at a time; a channel under zero-order hold jumps.
"""

from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark
from tsas_cli.recordings.quality.samples import rows_between_changes, smallest_change
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.support.arrays import Floats

_FEWEST_CHANGES = 20


def find(trial: RunSignals) -> Iterator[Remark | CannotTell]:
    """Yield the displacements and tensions that seldom change from one row to the next."""
    fresh = ~trial.repeats
    for name, values in trial.mechanical.items():
        if is_held(values[fresh]) and _jumps(values):
            rows = rows_between_changes(values[fresh])
            yield Remark(
                "warning",
                f"{name} changes only every {np.median(rows):.0f} rows (zero-order hold)",
                "record the channel at its own rate, or correct for half an update of delay",
                name,
            )


def is_held(values: Floats) -> bool:
    """Return whether a channel changes in every second row at most."""
    rows = rows_between_changes(values)
    return rows.size >= _FEWEST_CHANGES and bool(np.quantile(rows, 0.05) >= 2.0)


def _jumps(values: Floats) -> bool:
    """Return whether most changes exceed one step."""
    change = np.abs(np.diff(values))
    return bool(np.nanmedian(change[change > 0.0]) > 1.5 * smallest_change(values))


CHECK = QualityCheck("slow-channel", find)
