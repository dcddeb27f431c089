"""How long steps of the dynamic chain are: as the error of a tension and Newton's method allow."""

import math
from typing import NamedTuple

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.lugre.ends import StepEnds
from tsas_cli.physics.lugre.state import Floats, Formula, LugreLaws, Step
from tsas_cli.physics.lugre.step import newton, predict, step_error

LEAVES = 0.3  # of the error of a step: what Newton's method may leave
SWINGS = 0.04  # of the tolerance, with a mass that swings on: its errors add up
LONGER, SHORTER, CAREFUL = 2.0, 0.25, 0.85  # how the step may change, and how much of it is taken


class Tolerances(NamedTuple):
    """What a step may be off by."""

    error_N: float  # of a tension, infinite where steps are given
    leaves_N: float  # by Newton's method, summed over the nodes


@kernel
def tolerances_of(ends: StepEnds, laws: LugreLaws, tolerance: float, leaves: float) -> Tolerances:
    """Return what a step from these ends may be off by, and leave at most, as shares of a tension.

    An infinite tolerance is for steps that are given.
    """
    tension = max(abs(ends.drive.tension), abs(ends.load.tension), 0.1 * laws.preload_N)
    most = tolerance * tension * (SWINGS if laws.load.mass_kg > 0.0 else 1.0)
    return Tolerances(most, min(LEAVES * most, leaves * tension))


@kernel
def try_step(
    s: Floats, step: Step, formula: Formula, laws: LugreLaws, most: Tolerances
) -> tuple[float, int]:
    """Find the end of a step, which is not kept yet.

    Returns its error [N], infinite where Newton's method fails, zero where none is asked for, and
    the iterations.
    """
    predict(s, laws, formula)
    iterations, solved = newton(s, step, laws, most.leaves_N)
    if not solved:
        return math.inf, iterations
    return (step_error(s, laws, formula) if most.error_N < math.inf else 0.0), iterations


@kernel
def step_factor(off: float, most: Tolerances, formula: Formula) -> float:
    """Return by what the next step, or this one once more, may be longer or has to be shorter."""
    if off == math.inf:
        return SHORTER
    spare = most.error_N / (off + 1e-300)
    change = CAREFUL * (np.cbrt(spare) if formula.h2 < math.inf else math.sqrt(spare))
    return float(max(SHORTER, min(LONGER, change)))


@kernel
def fit_to_reversal(h: float, left: float) -> tuple[float, bool]:
    """Return a step that does not pass the next reversal, and whether it lands there.

    Before a short rest it takes half of both.
    """
    if h > (1.0 - 1e-9) * left:
        return left, True
    return (0.5 * left if 2.0 * h > left else h), False
