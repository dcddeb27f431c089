"""The two tension sensors are exchanged.

With friction, at the same distal tension, the proximal tension is higher during contraction than
during loosening. If it is lower, the proximal and the distal column are exchanged (or `x_in_mm` has
the wrong sign, if no other channel shows its sign).
"""

from collections.abc import Iterator

import numpy as np

from tsas_cli.recordings.quality.finding import CannotTell, QualityCheck, Remark
from tsas_cli.recordings.quality.trial import RunSignals

_CLEAR = 0.03


def find(trial: RunSignals) -> Iterator[Remark | CannotTell]:
    """Yield the exchange if f_in is lower in contraction than in loosening at the same f_out."""
    spring = trial.recording.run.load == "spring"
    against = [n for n in ("f_in_N", "f_out_N") if spring and (trial.follows(n) or 0.0) < 0.0]
    if against:
        yield CannotTell(f"the sign of {against[0]} against x_in_mm is in doubt")
        return
    if len({stroke.direction for stroke in trial.strokes}) < 2:
        yield CannotTell("the drive does not move in both directions")
        return
    excess = _excess_while_pulling(trial)
    visible = 0.5 * (trial.visible("f_in_N") + trial.visible("f_out_N"))
    if excess < -max(_CLEAR * trial.sizes["f_in_N"].span, visible):
        yield Remark(
            "error",
            f"at the same f_out_N, f_in_N is {-excess:.3g} N lower in contraction than in "
            "loosening; friction makes it higher",
            "exchange the columns of f_in_N and f_out_N at ingest, or check the sign of x_in_mm",
            "f_in_N",
        )


def _excess_while_pulling(trial: RunSignals) -> float:
    """Return d of f_in = a + b f_out + d/2 · direction, fitted while the drive moves [N].

    A wrong gain or offset of a sensor enters a and b. If the load's own tension reverses with the
    direction, b and d are indistinguishable; a negative b is implausible and left out.
    """
    f_in, f_out, direction = trial.channels["f_in_N"], trial.channels["f_out_N"], trial.direction
    rows = (direction != 0.0) & np.isfinite(f_in) & np.isfinite(f_out)
    terms = np.column_stack([direction[rows] / 2.0, np.ones(int(rows.sum())), f_out[rows]])
    fit = np.linalg.lstsq(terms, f_in[rows], rcond=None)[0]
    if fit[2] < 0.0:
        fit = np.linalg.lstsq(terms[:, :2], f_in[rows], rcond=None)[0]
    return float(fit[0])


CHECK = QualityCheck("exchanged", find, needs=("x_in_mm", "f_in_N", "f_out_N"), of_long="strokes")
