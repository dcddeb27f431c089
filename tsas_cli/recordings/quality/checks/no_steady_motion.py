"""The tendon never slips through to the load in one of the two directions.

After a reversal the drive first crosses a dead band, in which the distal end rests. The stiffness
of contraction and of loosening is identifiable only from strokes that continue well beyond it: the
distal end has to move in at least a fifth of one stroke.
"""

from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark
from tsas_cli.recordings.quality.trial import RunSignals, Stroke

_ENOUGH = 0.2
_FEWEST_ROWS = 10
_INDICATORS = {
    "spring": ("x_out_mm", "f_out_N"),
    "force": ("x_out_mm",),
    "displacement": ("f_out_N",),
}


def find(trial: RunSignals) -> Iterator[Remark | CannotTell]:
    """Yield the directions in which the distal end moves in too small a part of each stroke."""
    indicators = [n for n in _INDICATORS[trial.recording.run.load] if n in trial.channels]
    if not indicators or not trial.strokes:
        yield CannotTell(
            "the drive does not move visibly"
            if indicators
            else "no channel shows when the distal end moves"
        )
        return
    for phase, direction in (("contraction", 1), ("loosening", -1)):
        strokes = [s for s in trial.strokes if s.direction == direction]
        share = max((_moving(trial, n, s) for n in indicators for s in strokes), default=1.0)
        if share < _ENOUGH:
            yield Remark(
                "warning",
                f"no steady {phase}: by {' and '.join(indicators)}, the distal end moves in at "
                f"most {100 * share:.2g} % of a stroke of x_in_mm",
                "record longer strokes, so that the load moves well beyond the dead band",
                indicators[0],
            )


def _moving(trial: RunSignals, name: str, stroke: Stroke) -> float:
    """Return the share of a stroke's travel that lies after the distal end has begun to move."""
    values, x = trial.channels[name][stroke.rows], trial.channels["x_in_mm"][stroke.rows]
    valid = np.isfinite(values) & np.isfinite(x)
    if not valid.any():
        return 0.0
    values, x = values[valid], x[valid]
    limit = max(trial.visible(name), 0.02 * trial.sizes[name].span)
    away = np.abs(values - values[0]) > limit
    if not away[-1]:
        return 0.0
    begin = int(np.flatnonzero(~away)[-1])
    if away.size - begin < _FEWEST_ROWS:
        return 0.0
    return float(abs((x[-1] - x[begin]) / (x[-1] - x[0])))


CHECK = QualityCheck("no-steady-motion", find, needs=("x_in_mm",), of_long="strokes")
