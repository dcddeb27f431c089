"""Single samples are far from the samples before and after them.

A bit error on a line, a sentinel for a missing value, a loose plug. One outlier can dominate a fit
by least squares. Reported are one to three consecutive samples that deviate from both neighbours by
more than 20 times the noise, ten quantisation steps and a twentieth of the span, ten times steeper
than the neighbouring samples; and any implausible value, which every other stage refuses. Not
reported: a lasting step, a fast reversal, deviations of more than 2 % of the samples.
"""

from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.columns import largest
from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark
from tsas_cli.recordings.quality.trial import RunSignals
from tsas_cli.support.wording import count_of


def find(trial: RunSignals) -> Iterator[Remark | CannotTell]:
    """Yield the number of outliers of each channel, and the farthest one."""
    for name, outlying in trial.outlying.items():
        rows = np.flatnonzero(outlying)
        if rows.size == 0:
            continue
        values = trial.recording.columns[name]
        usual = float(np.nanmedian(values))
        farthest = rows[np.argmax(np.abs(values[rows] / 2.0 - usual / 2.0))]
        plausible = abs(values[farthest]) <= largest(name)
        yield Remark(
            "error",
            f"{name} holds {count_of(rows.size, 'sample')} far from "
            f"{'the samples before and after' if plausible else 'any plausible value'}; the "
            f"farthest is {values[farthest]:.6g} at {trial.time_s[farthest]:.6g} s, "
            f"row {trial.first_row + farthest}",
            "leave these cells empty in the file and ingest again; the stages leave the gap out",
            name,
            float(trial.time_s[rows[0]]),
        )


CHECK = QualityCheck("outlier", find)
