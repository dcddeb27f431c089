"""Estimates and their intervals, with what the tolerances of a rig may have moved them by.

The nominal model lacks the tolerances, so that a fit moves its parameters by what they do. The
values stay, since they belong together; the intervals are of the values moved back by the likely
tolerances (`tolerances.moved_by_tolerances`), extended to hold the fitted ones.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from tsas_cli.diagnosis.hypotheses import Hypotheses
from tsas_cli.diagnosis.tolerances import moved_by_tolerances, of_others
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit import with_errors
from tsas_cli.identification.hypothesis_fit import HypothesisFit, correlation_of
from tsas_cli.identification.joint_fit import estimates_of
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.records.base import TWO_SIDED
from tsas_cli.support.arrays import Floats

SHEATH, TENDON = "sheath_compression.compliance_ratio", "tendon_stiffness_N"


@dataclass(frozen=True, eq=False)
class Tolerated:
    """The `estimates` of a trial, with intervals that hold what tolerances may have moved them by.

    `moved` are the same where the likely tolerances are taken into account, as they are tested, and
    `correlation` is that of these, shape (p, p).
    """

    estimates: list[Estimate]
    moved: list[Estimate]
    correlation: Floats


def estimates_with_tolerances(
    search: Hypotheses, trial: HypothesisFit, tolerated: Floats
) -> Tolerated:
    """Return the estimates of a trial with what tolerances change, residuals of shape (n, m)."""
    solution = trial.solution
    counted = search.folds.blocks_of_runs(len(search.bench.rigs))
    fitted = with_errors(trial.unknowns, solution, counted, by_run=True)
    shift, unsure = moved_by_tolerances(trial, of_others(trial, tolerated), counted)
    known = np.where(np.isfinite(fitted.stderr), fitted.stderr, 0.0)
    by_noise = trial.correlation() * np.outer(known, known)
    # Few runs make the scatter unsure, Student's t; a tolerance's size is known beforehand.
    of_tolerances = np.sqrt(np.diag(unsure)) * TWO_SIDED / fitted.t
    fitted = replace(fitted, stderr=np.hypot(fitted.stderr, of_tolerances))

    def of(values: Floats) -> list[Estimate]:
        ids = search.bench.base.problem.ids
        stated = _at_data_sheet(values, trial)
        at_bound = fitted.at_bound & (stated == values)
        found = estimates_of(trial.unknowns, replace(fitted, values=stated, at_bound=at_bound), ids)
        at = next((j for j, u in enumerate(trial.unknowns) if u.name == TENDON), None)
        if at is None:
            return found
        EA = trial.unknowns[at]
        changes = [float(end - stated[at]) for end in (EA.lower, EA.upper)]
        return [_with_data_sheet_interval(e, changes) if e.name == SHEATH else e for e in found]

    estimates, moved = of(fitted.values), of(fitted.values + shift)
    held = [_holding(m, e.value) for e, m in zip(estimates, moved, strict=True)]
    return Tolerated(held, moved, correlation_of(by_noise + unsure))


def _holding(moved: Estimate, value: float) -> Estimate:
    """Return a value with the interval of a moved one, extended to hold it."""
    low, high = moved.interval_low, moved.interval_high
    if low is None or high is None:
        return replace(moved, value=value)
    return replace(moved, value=value, interval_low=min(low, value), interval_high=max(high, value))


def _at_data_sheet(values: Floats, trial: HypothesisFit) -> Floats:
    """Return the scaled values with the tendon's stiffness in the middle of its data sheet's range.

    The recordings determine (1 + ratio)/EA only, and l/EA of a free length l: a fit ends anywhere.
    """
    at = {u.name: j for j, u in enumerate(trial.unknowns)}
    if SHEATH not in at or TENDON not in at:
        return values
    EA, ratio = trial.unknowns[at[TENDON]], QUANTITIES[SHEATH]
    change = 0.5 * (EA.lower + EA.upper) - float(values[at[TENDON]])
    whole = (1.0 + ratio.unscaled(values[at[SHEATH]])) * math.exp(change)
    if whole < 1.0:  # a tendon that is stiffer than its data sheet has no compliant sheath
        return values
    out = values.copy()
    out[at[TENDON]] += change
    out[at[SHEATH]] = ratio.scaled(whole - 1.0)
    for name, j in at.items():
        if name.startswith("free_tendon."):
            out[j] *= math.exp(change)
    return out


def _with_data_sheet_interval(ratio: Estimate, changes: Sequence[float]) -> Estimate:
    """Return the sheath's compliance with the interval that follows from the tendon's data sheet.

    `changes` are those of log EA to the ends of its range.
    """
    low, high = (max((1.0 + ratio.value) * math.exp(change) - 1.0, 0.0) for change in changes)
    stderr = max(high - ratio.value, ratio.value - low) / TWO_SIDED
    return replace(ratio, stderr=stderr, interval_low=low, interval_high=high)
