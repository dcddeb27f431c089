"""One step of the dynamic chain: variable-step BDF2, solved by Newton's method, and its size.

Second order (the first step after a reversal is a backward Euler step, first order):
y = (1+ω)²/(1+2ω) y1 − ω²/(1+2ω) y2 + gh dy/dt with gh = h(1+ω)/(1+2ω), ω = h over the step before.
"""

import math
from typing import NamedTuple

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import DISPLACEMENT, FORCE
from tsas_cli.physics.lugre import state as at
from tsas_cli.physics.lugre.balance import balance
from tsas_cli.physics.lugre.ends import StepEnds
from tsas_cli.physics.lugre.state import Formula, LugreLaws, Step
from tsas_cli.physics.lugre.tridiagonal import solve
from tsas_cli.support.arrays import Floats

MOST_ITERATIONS = 8


@kernel
def bdf2(h: float, h1: float, h2: float) -> Formula:
    """Return the formula of a step after two others; for the first step, backward Euler's."""
    ratio = h / h1
    below = 1.0 + 2.0 * ratio
    gh = h * (1.0 + ratio) / below
    return Formula(h, h1, h2, gh, (1.0 + ratio) ** 2 / below, ratio * ratio / below)


@kernel
def predict(s: Floats, laws: LugreLaws, formula: Formula) -> None:
    """Set the history terms of a step, and predict its rates by extrapolation."""
    h, h1, h2, gh, near, far = formula
    ratio = h / h1
    g0, g1, g2 = 1.0, 0.0, 0.0
    if h1 < math.inf:
        g0, g1 = 1.0 + ratio, -ratio
    if h2 < math.inf:
        both = h + h1 + h2
        g0 = (h + h1) * both / (h1 * (h1 + h2))
        g1 = -h * both / (h1 * h2)
        g2 = h * (h + h1) / ((h1 + h2) * h2)
    for i in range(laws.n + 2):
        s[at.POSITION_HISTORY + i] = near * s[at.POSITION + i] - far * s[at.POSITION_1 + i]
        s[at.SPEED_HISTORY + i] = near * s[at.SPEED + i] - far * s[at.SPEED_1 + i]
        s[at.DEFLECTION_HISTORY + i] = near * s[at.DEFLECTION + i] - far * s[at.DEFLECTION_1 + i]
        s[at.RATE + i] = (
            g0 * s[at.POSITION + i]
            + g1 * s[at.POSITION_1 + i]
            + g2 * s[at.POSITION_2 + i]
            - s[at.POSITION_HISTORY + i]
        ) / gh
        s[at.TENSION_SLOPE + i] = s[at.STIFFNESS + i] * gh + s[at.DAMPING + i]
    for i in range(2):
        s[at.LOAD_STATE_HISTORY + i] = near * s[at.LOAD_STATE + i] - far * s[at.LOAD_STATE_1 + i]
    for j in range(laws.n + 1):
        s[at.TENSION_HISTORY + j] = laws.preload_N + s[at.STIFFNESS + j] * (
            s[at.POSITION_HISTORY + j] - s[at.POSITION_HISTORY + j + 1]
        )


@kernel
def newton(s: Floats, step: Step, laws: LugreLaws, residual_N: float) -> tuple[int, bool]:
    """Solve for the rates at the end of a step from the predicted ones.

    Returns the iterations, and success: the residual forces, summed over the nodes, are at most
    `residual_N`.
    """
    last = laws.n + 1
    if laws.drive.given == DISPLACEMENT:
        s[at.RATE] = 0.0
    if laws.load.given == DISPLACEMENT:
        s[at.RATE + last] = (
            step.load.value - step.frame.value - s[at.POSITION_HISTORY + last]
        ) / step.gh
    for i in range(laws.n + 2):
        s[at.RATE_PREDICTED + i] = s[at.RATE + i]
    for iteration in range(MOST_ITERATIONS + 1):
        residual = balance(s, step, laws)
        if residual <= residual_N:
            return iteration, True
        if not residual < math.inf or iteration == MOST_ITERATIONS:
            return iteration, False
        solve(s, laws.n)
        for i in range(laws.n + 2):
            s[at.RATE + i] += s[at.INCREMENT + i]
    return MOST_ITERATIONS, False


@kernel
def step_error(s: Floats, laws: LugreLaws, formula: Formula) -> float:
    """Return the error of a step as a tension, from the error of the prediction [N]."""
    h, h1, h2, gh, _, _ = formula
    for j in range(laws.n + 1):
        difference = (s[at.RATE + j] - s[at.RATE_PREDICTED + j]) - (
            s[at.RATE + j + 1] - s[at.RATE_PREDICTED + j + 1]
        )
        s[at.INCREMENT + j] = abs(s[at.STIFFNESS + j] * difference)
    largest = largest_increment(s, laws.n + 1)
    if h2 == math.inf:
        return 0.5 * gh * largest
    ratio = h / h1
    corrected = h * h * h * (1.0 + ratio) ** 2 / (ratio * (1.0 + 2.0 * ratio))
    predicted = h * (h + h1) * (h + h1 + h2)
    return gh * largest * corrected / (corrected + predicted)


@kernel
def largest_increment(s: Floats, count: int) -> float:
    """Return the largest of INCREMENT, by two independent searches."""
    a, b = s[at.INCREMENT], 0.0
    for i in range(1, count - 1, 2):
        a, b = max(a, s[at.INCREMENT + i]), max(b, s[at.INCREMENT + i + 1])
    largest: float = max(a, b, s[at.INCREMENT + count - 1])
    return largest


@kernel
def accept_step(s: Floats, step: Step, laws: LugreLaws) -> None:
    """Accept a step: shift the state to its end."""
    for i in range(laws.n + 2):
        s[at.POSITION_2 + i] = s[at.POSITION_1 + i]
        s[at.POSITION_1 + i] = s[at.POSITION + i]
        s[at.POSITION + i] = s[at.POSITION_NEW + i]
        s[at.SPEED_1 + i] = s[at.SPEED + i]
        s[at.SPEED + i] = s[at.RATE + i] + step.frame.rate
        s[at.DEFLECTION_1 + i] = s[at.DEFLECTION + i]
        s[at.DEFLECTION + i] = s[at.DEFLECTION_NEW + i]
    for i in range(2):
        s[at.LOAD_STATE_1 + i], s[at.LOAD_STATE + i] = (
            s[at.LOAD_STATE + i],
            s[at.LOAD_STATE_NEW + i],
        )


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
