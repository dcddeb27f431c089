"""How well a run of the closed loop has followed: the numbers of one run, and over many seeds."""

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from tsas_cli.records.tracking import Scores, Spread
from tsas_cli.support.arrays import Floats

OUTSIDE = 0.02  # of the wanted force's range


@dataclass(frozen=True)
class Score:
    """One run. Errors are wanted less true force at the load; u is the speed asked for."""

    rmse_N: float
    lowest_error_N: float
    highest_error_N: float
    effort_rpm: float  # root mean square of u
    chatter_rpm_per_s: float  # total variation of u per second
    outside_percent: float  # time with an error beyond 2 % of the wanted force's range
    at_limit_percent: float  # time with the motor at its speed limit


def score(
    wanted_N: Floats, f_out_N: Floats, asked_rpm: Floats, step_s: float, limit_rpm: float
) -> Score:
    """Return the numbers of a run, all arrays of shape (m,)."""
    error = wanted_N - f_out_N
    beyond = np.abs(error) > OUTSIDE * np.ptp(wanted_N)
    return Score(
        rmse_N=float(np.sqrt(np.mean(error**2))),
        lowest_error_N=float(error.min()),
        highest_error_N=float(error.max()),
        effort_rpm=float(np.sqrt(np.mean(asked_rpm**2))),
        chatter_rpm_per_s=float(np.abs(np.diff(asked_rpm)).sum() / (step_s * error.size)),
        outside_percent=100.0 * float(beyond.mean()),
        at_limit_percent=100.0 * float((np.abs(asked_rpm) >= limit_rpm).mean()),
    )


def over_seeds(scores: Sequence[Score]) -> Scores:
    """Return mean and standard deviation of each number over the seeds; of one seed no spread."""
    spreads = {}
    for field in fields(Score):
        values = np.array([getattr(one, field.name) for one in scores])
        spread = float(values.std(ddof=1)) if values.size > 1 else None
        spreads[field.name] = Spread(mean=float(values.mean()), sd=spread)
    return Scores(**spreads)
