"""A tension has no constant part: its amplifier passes changes alone.

A tendon that pushes nowhere has a positive tension; behind a coupling to AC its mean falls to zero
within the time constant of the coupling, and what is left is negative half of the time. Reported
where the second half of a run has a mean near zero in both directions of the drive, though the
manifest states a preload. A zero that was set under load is a constant offset: it leaves the mean
where it was at the start.
"""

from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark
from tsas_cli.recordings.quality.trial import RunSignals

_ZERO = 0.15  # of the channel's span: the mean of the second half
_NEGATIVE = 0.2  # share of the samples there


def find(trial: RunSignals) -> Iterator[Remark | CannotTell]:
    """Yield the tensions whose mean falls to zero."""
    preload = trial.recording.run.preload_N
    if not preload or not trial.strokes:
        yield CannotTell("no preload is stated, or the drive does not move")
        return
    for name in ("f_in_N", "f_out_N"):
        if name not in trial.channels:
            continue
        values = trial.channels[name]
        late = values[values.size // 2 :]
        span = trial.sizes[name].span
        began = float(np.nanmean(values[: trial.strokes[0].stop + 1]))
        mean = float(np.nanmean(late))
        if abs(mean) < _ZERO * span < began and np.nanmean(late < 0.0) > _NEGATIVE:
            yield Remark(
                "error",
                f"{name} begins at {began:.3g} N and has a mean of {mean:.2g} N in the second half "
                f"of the run, with a preload of {preload:g} N: its amplifier is coupled to AC",
                "set the amplifier to DC and record again",
                name,
            )


CHECK = QualityCheck("ac-coupled", find, needs=("x_in_mm",))
