"""Single samples stand far off what is before and after them.

A bit that was lost on a line, a sentinel that a logger writes where it has measured nothing, a plug
that was touched. One of them decides a fit by least squares. Told of one to three samples in a row
that are off both sides by more than 20 times the noise, ten steps of quantisation and a twentieth
of the span, ten times steeper than the samples beside them; and of any value that no rig has, which
every other stage refuses. Not told: a step that stays, a fast reversal, what comes more often
than every fiftieth sample.
"""

from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.columns import largest
from tsas_cli.recordings.quality.finding import CannotTell, Check, Remark
from tsas_cli.recordings.quality.trial import Trial
from tsas_cli.support.wording import count_of


def find(trial: Trial) -> Iterator[Remark | CannotTell]:
    """Tell the samples of each channel that stand out, the farthest one with its value."""
    for name, outlying in trial.outlying.items():
        rows = np.flatnonzero(outlying)
        if rows.size == 0:
            continue
        values = trial.recording.columns[name]
        usual = float(np.nanmedian(values))
        farthest = rows[np.argmax(np.abs(values[rows] / 2.0 - usual / 2.0))]
        possible = abs(values[farthest]) <= largest(name)
        yield Remark(
            "error",
            f"{name} holds {count_of(rows.size, 'sample')} far off "
            f"{'what is before and after' if possible else 'what a rig can have'}; the farthest "
            f"is {values[farthest]:.6g} at {trial.time_s[farthest]:.6g} s, "
            f"row {trial.first_row + farthest}",
            "leave these cells empty in the file and ingest again; the stages leave the gap out",
            name,
            float(trial.time_s[rows[0]]),
        )


CHECK = Check("outlier", find)
