"""A regression without mechanics, for comparison: play operators of x_in, and products with f_out.

Nine widths, from half the learned stroke down to 1/512 of it, each as what it takes away from x_in;
x_in, f_out, and the products of f_out with the others: 21 numbers. Each run's mean is free.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from tsas_cli.effects.backlash import follow_play
from tsas_cli.numerics.compiled import kernel
from tsas_cli.support.arrays import Floats

WIDTHS = 9
PENALTY = 1e-4  # of a column's mean square
Columns = Mapping[str, Floats]


def ridge_errors(
    learned: Sequence[Columns], predicted: Sequence[Columns], channel: str, after_s: float
) -> list[Floats]:
    """Return measured less predicted of a channel, run by run; fits and means count `after_s`."""
    stroke = max(float(np.ptp(run["x_in_mm"])) for run in learned)
    known = np.concatenate([_table(run, channel, stroke, after_s)[1] for run in learned])
    scale = np.sqrt(np.mean(known**2, axis=0)) + np.finfo(float).tiny
    a, b = (known / scale)[:, :-1], known[:, -1]
    squares = a.T @ a + PENALTY * len(a) * np.eye(a.shape[1])
    weights = np.linalg.solve(squares, a.T @ b) / scale[:-1]
    tables = [_table(run, channel, stroke, after_s)[0] for run in predicted]
    return [table[:, -1] - table[:, :-1] @ weights for table in tables]


def _table(run: Columns, channel: str, stroke: float, after_s: float) -> tuple[Floats, Floats]:
    """Return the regressors and, last, the channel, less their means; then the rows that count."""
    x_in = np.array(run["x_in_mm"])
    columns = [x_in, *(_lost(x_in, stroke * 0.5**k) for k in range(1, WIDTHS + 1))]
    if "f_out_N" in run:
        columns += [run["f_out_N"], *(column * run["f_out_N"] for column in columns)]
    table, late = np.column_stack([*columns, run[channel]]), run["time_s"] >= after_s
    table -= table[late].mean(axis=0)
    return table, table[late]


@kernel
def _lost(x_in: Floats, width: float) -> Floats:
    """Return x_in less the output of the play operator, zero at the start, shape (n,)."""
    out = np.empty(x_in.size)
    at = x_in[0]
    for i in range(x_in.size):
        at = follow_play(at, x_in[i], width)
        out[i] = x_in[i] - at
    return out
