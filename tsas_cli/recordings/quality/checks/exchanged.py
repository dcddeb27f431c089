"""The two tension sensors are exchanged.

Friction holds back: at the same tension at the load, the drive's tension is higher during
contraction than during loosening. When it is the other way round, the proximal and the distal
column are swapped (or, where nothing else shows its sign, `x_in_mm` counts the wrong way).
"""

from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.quality.finding import CannotTell, Check, Remark
from tsas_cli.recordings.quality.trial import Trial

_CLEAR = 0.03


def find(trial: Trial) -> Iterator[Remark | CannotTell]:
    """Compare the two directions at the same tension at the load."""
    spring = trial.recording.run.load == "spring"
    against = [n for n in ("f_in_N", "f_out_N") if spring and (trial.follows(n) or 0.0) < 0.0]
    if against:
        yield CannotTell(f"the sign of {against[0]} against x_in_mm is in doubt")
        return
    if len({stroke.direction for stroke in trial.strokes}) < 2:
        yield CannotTell("the drive does not move both ways")
        return
    excess = _excess_while_pulling(trial)
    visible = 0.5 * (trial.visible("f_in_N") + trial.visible("f_out_N"))
    if excess < -max(_CLEAR * trial.span["f_in_N"], visible):
        yield Remark(
            "error",
            f"at the same f_out_N, f_in_N is {-excess:.3g} N lower when the drive pulls than when "
            "it gives way; friction makes it higher",
            "exchange the columns of f_in_N and f_out_N at ingest, or check the sign of x_in_mm",
            "f_in_N",
        )


def _excess_while_pulling(trial: Trial) -> float:
    """Return d of f_in = a + b f_out + d/2 · direction, the drive under way [N].

    A wrong gain or offset of a sensor goes into a and b. Where the load's own tension turns with
    the direction, b cannot be told from d; below zero it makes no sense and is left out.
    """
    f_in, f_out, direction = trial.channels["f_in_N"], trial.channels["f_out_N"], trial.direction
    rows = (direction != 0.0) & np.isfinite(f_in) & np.isfinite(f_out)
    terms = np.column_stack([direction[rows] / 2.0, np.ones(int(rows.sum())), f_out[rows]])
    fit = np.linalg.lstsq(terms, f_in[rows], rcond=None)[0]
    if fit[2] < 0.0:
        fit = np.linalg.lstsq(terms[:, :2], f_in[rows], rcond=None)[0]
    return float(fit[0])


CHECK = Check("exchanged", find, needs=("x_in_mm", "f_in_N", "f_out_N"))
