"""Time stands still or runs backwards.

The clock was set, rows were written twice, or files were joined in the wrong order. Every other
stage refuses such a run.
"""

from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.quality.finding import CannotTell, Check, Remark
from tsas_cli.recordings.quality.trial import Trial


def find(trial: Trial) -> Iterator[Remark | CannotTell]:
    """Look for steps of time that are not positive."""
    rows = np.flatnonzero(np.diff(trial.time_s) <= 0) + 1
    if rows.size == 0:
        return
    row = int(rows[0])
    before, after = trial.time_s[row - 1], trial.time_s[row]
    yield Remark(
        "error",
        f"time does not increase at {rows.size} of {trial.time_s.size} rows, first at row "
        f"{trial.first_row + row} ({before:.6g} s, then {after:.6g} s)",
        "mend the clock or the order of the rows at the source, then ingest again",
        "time_s",
        float(before),
    )


CHECK = Check("time-order", find)
