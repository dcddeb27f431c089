"""Time stops, decreases, or increases by an implausible step.

The clock was set, rows are duplicate, or files were joined in the wrong order; or the unit of time
is wrong by orders of magnitude. Every other stage refuses such a run.
"""

from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.support.arrays import Mask
from tsas_cli.support.limits import LONGEST_STEP_S, SHORTEST_STEP_S


def find(trial: RunSignals) -> Iterator[Remark | CannotTell]:
    """Yield the first step of time that is not positive, else the first implausible one."""
    step = np.diff(trial.time_s)
    rows = np.flatnonzero(step <= 0) + 1
    if rows.size == 0:
        yield from _implausible_steps(trial, (step < SHORTEST_STEP_S) | (step > LONGEST_STEP_S))
        return
    row = int(rows[0])
    before, after = trial.time_s[row - 1], trial.time_s[row]
    yield Remark(
        "error",
        f"time does not increase at {rows.size} of {trial.time_s.size} rows, first at row "
        f"{trial.first_row + row} ({before:.6g} s, then {after:.6g} s)",
        "correct the clock or the order of the rows at the source, then ingest again",
        "time_s",
        float(before),
    )


def _implausible_steps(trial: RunSignals, implausible: Mask) -> Iterator[Remark]:
    if implausible.any():
        row = int(implausible.argmax()) + 1
        before = float(trial.time_s[row - 1])
        yield Remark(
            "error",
            f"time increases by less than {SHORTEST_STEP_S:g} s or more than {LONGEST_STEP_S:g} s "
            f"at {int(implausible.sum())} of {implausible.size + 1} rows, first at row "
            f"{trial.first_row + row} "
            f"({before:.6g} s, then {trial.time_s[row]:.6g} s)",
            "check the unit of the time, then ingest again",
            "time_s",
            before,
        )


CHECK = QualityCheck("time-order", find)
