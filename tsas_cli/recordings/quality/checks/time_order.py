"""Time stands still, runs backwards, or goes on by a step that no clock has.

The clock was set, rows were written twice, or files were joined in the wrong order; or the time is
in another unit by far. Every other stage refuses such a run.
"""

from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.quality.finding import CannotTell, Check, Remark
from tsas_cli.recordings.quality.samples import Booleans
from tsas_cli.recordings.quality.trial import Trial
from tsas_cli.support.limits import LONGEST_STEP_S, SHORTEST_STEP_S


def find(trial: Trial) -> Iterator[Remark | CannotTell]:
    """Look for steps of time that are not positive, then for those that no clock has."""
    step = np.diff(trial.time_s)
    rows = np.flatnonzero(step <= 0) + 1
    if rows.size == 0:
        yield from _odd(trial, (step < SHORTEST_STEP_S) | (step > LONGEST_STEP_S))
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


def _odd(trial: Trial, odd: Booleans) -> Iterator[Remark]:
    if odd.any():
        row = int(odd.argmax()) + 1
        before = float(trial.time_s[row - 1])
        yield Remark(
            "error",
            f"time goes on by less than {SHORTEST_STEP_S:g} s or more than {LONGEST_STEP_S:g} s at "
            f"{int(odd.sum())} of {odd.size + 1} rows, first at row {trial.first_row + row} "
            f"({before:.6g} s, then {trial.time_s[row]:.6g} s)",
            "look up the unit of the time, then ingest again",
            "time_s",
            before,
        )


CHECK = Check("time-order", find)
