"""The tendon never slips through to the load in one of the two directions.

After a reversal the drive first crosses a dead band, in which the distal end rests. The stiffness
of contraction and of loosening can only be told from strokes that go on well beyond it: at least a
fifth of one stroke, in which the distal end moves.
"""

from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.quality.finding import CannotTell, Check, Remark
from tsas_cli.recordings.quality.trial import Stroke, Trial

_ENOUGH = 0.2
_FEWEST_ROWS = 10
_WITNESSES = {
    "spring": ("x_out_mm", "f_out_N"),
    "force": ("x_out_mm",),
    "displacement": ("f_out_N",),
}


def find(trial: Trial) -> Iterator[Remark | CannotTell]:
    """Look for the longest part of a stroke in which the distal end moves, in each direction."""
    witnesses = [n for n in _WITNESSES[trial.recording.run.load] if n in trial.channels]
    if not witnesses or not trial.strokes:
        yield CannotTell(
            "the drive does not move visibly"
            if witnesses
            else "no channel shows when the distal end moves"
        )
        return
    for phase, direction in (("contraction", 1), ("loosening", -1)):
        strokes = [s for s in trial.strokes if s.direction == direction]
        share = max((_moving(trial, n, s) for n in witnesses for s in strokes), default=1.0)
        if share < _ENOUGH:
            yield Remark(
                "warning",
                f"no steady {phase}: by {' and '.join(witnesses)}, the distal end moves in at most "
                f"{100 * share:.2g} % of a stroke of x_in_mm",
                "record longer strokes, so that the load moves well beyond the dead band",
                witnesses[0],
            )


def _moving(trial: Trial, name: str, stroke: Stroke) -> float:
    """Return the share of a stroke's travel that lies after the distal end has begun to move."""
    values, x = trial.channels[name][stroke.rows], trial.channels["x_in_mm"][stroke.rows]
    there = np.isfinite(values) & np.isfinite(x)
    if not there.any():
        return 0.0
    values, x = values[there], x[there]
    limit = max(trial.visible(name), 0.02 * trial.span[name])
    away = np.abs(values - values[0]) > limit
    if not away[-1]:
        return 0.0
    begin = int(np.flatnonzero(~away)[-1])
    if away.size - begin < _FEWEST_ROWS:
        return 0.0
    return float(abs((x[-1] - x[begin]) / (x[-1] - x[0])))


CHECK = Check("no-steady-motion", find, needs=("x_in_mm",))
