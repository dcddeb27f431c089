"""Step size of the dynamic chain: by the error of a tension and Newton's convergence."""

import math
from typing import NamedTuple

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import FORCE
from tsas_cli.physics.lugre.ends import StepEnds
from tsas_cli.physics.lugre.state import Formula, LugreLaws, Step
from tsas_cli.physics.lugre.step import newton, predict, step_error
from tsas_cli.support.arrays import Floats

RESIDUAL_SHARE = 0.3  # residual of Newton's method over the error of a step
WITH_MASS = 0.04  # factor of the tolerance with an oscillating mass: its errors add up
LONGER, SHORTER, CAREFUL = 2.0, 0.25, 0.85  # bounds of the change of a step, safety factor


class Tolerances(NamedTuple):
    """Tolerances of a step."""

    error_N: float  # of a tension, infinite where steps are given
    residual_N: float  # of Newton's method, summed over the nodes


@kernel
def tolerances_of(
    ends: StepEnds, laws: LugreLaws, tolerance: float, residual_share: float
) -> Tolerances:
    """Return the tolerances of a step from these ends; both arguments are shares of a tension.

    An infinite tolerance is for given steps.
    """
    tension = max(abs(ends.drive.tension), abs(ends.load.tension), 0.1 * laws.preload_N)
    swings = laws.load.mass_kg > 0.0 or (laws.drive.given == FORCE and laws.drive.mass_kg > 0.0)
    most = tolerance * tension * (WITH_MASS if swings else 1.0)
    return Tolerances(most, min(RESIDUAL_SHARE * most, residual_share * tension))


@kernel
def try_step(
    s: Floats, step: Step, formula: Formula, laws: LugreLaws, most: Tolerances
) -> tuple[float, int]:
    """Solve a step without accepting it.

    Returns its error [N], infinite where Newton's method fails, zero for given steps, and the
    iterations.
    """
    predict(s, laws, formula)
    iterations, solved = newton(s, step, laws, most.residual_N)
    if not solved:
        return math.inf, iterations
    return (step_error(s, laws, formula) if most.error_N < math.inf else 0.0), iterations


@kernel
def step_factor(error_N: float, most: Tolerances, formula: Formula) -> float:
    """Return the factor of the next step after an accepted one, or of the repeated step."""
    if error_N == math.inf:
        return SHORTER
    ratio = most.error_N / (error_N + 1e-300)
    change = CAREFUL * (np.cbrt(ratio) if formula.h2 < math.inf else math.sqrt(ratio))
    return float(max(SHORTER, min(LONGER, change)))


@kernel
def fit_to_reversal(h: float, left: float) -> tuple[float, bool]:
    """Return a step that does not pass the next reversal, and whether it ends there.

    A short remainder is avoided: two steps of half the time to the reversal.
    """
    if h > (1.0 - 1e-9) * left:
        return left, True
    return (0.5 * left if 2.0 * h > left else h), False
