"""One step of the dynamic chain: variable-step BDF2, solved by Newton's method.

Second order (the first step after a turning point is a backward Euler step, first order):
y = (1+ω)²/(1+2ω) y1 − ω²/(1+2ω) y2 + gh dy/dt with gh = h(1+ω)/(1+2ω), ω = h over the step before.
"""

import math

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.lugre.balance import balance
from tsas_cli.physics.lugre.state import (
    CHANGE,
    DAMPING,
    STIFFNESS,
    T_BY_W,
    T_PAST,
    V1,
    V_PAST,
    W_GUESS,
    Y1,
    Y2,
    Y_NEW,
    Y_PAST,
    Z1,
    Z_NEW,
    Z_PAST,
    Floats,
    Formula,
    Law,
    Step,
    V,
    W,
    Y,
    Z,
)
from tsas_cli.physics.lugre.tridiagonal import solve
from tsas_cli.physics.slip.state import DISPLACEMENT, Boundary

MOST_ITERATIONS = 8


@kernel
def formula_of(h: float, h1: float, h2: float) -> Formula:
    """Return the formula of a step after two others; without one before, backward Euler's."""
    ratio = h / h1
    below = 1.0 + 2.0 * ratio
    gh = h * (1.0 + ratio) / below
    return Formula(h, h1, h2, gh, (1.0 + ratio) ** 2 / below, ratio * ratio / below)


@kernel
def look_back(s: Floats, law: Law, formula: Formula) -> None:
    """Set the history terms of a step, and guess its speeds by extrapolation."""
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
    for i in range(law.n + 2):
        s[Y_PAST + i] = near * s[Y + i] - far * s[Y1 + i]
        s[V_PAST + i] = near * s[V + i] - far * s[V1 + i]
        s[Z_PAST + i] = near * s[Z + i] - far * s[Z1 + i]
        s[W + i] = (g0 * s[Y + i] + g1 * s[Y1 + i] + g2 * s[Y2 + i] - s[Y_PAST + i]) / gh
        s[T_BY_W + i] = s[STIFFNESS + i] * gh + s[DAMPING + i]
    for j in range(law.n + 1):
        s[T_PAST + j] = law.preload_N + s[STIFFNESS + j] * (s[Y_PAST + j] - s[Y_PAST + j + 1])


@kernel
def newton(
    s: Floats, step: Step, boundary: Boundary, law: Law, leaves_N: float
) -> tuple[int, bool]:
    """Find the speeds at the end of a step from their guess; return the iterations, and success.

    It ends when what the forces leave, summed over the nodes, is at most `leaves_N`.
    """
    last = law.n + 1
    if boundary.drive == DISPLACEMENT:
        s[W] = 0.0
    if boundary.load == DISPLACEMENT:
        s[W + last] = (step.load - step.position - s[Y_PAST + last]) / step.gh
    for i in range(law.n + 2):
        s[W_GUESS + i] = s[W + i]
    for iteration in range(MOST_ITERATIONS + 1):
        left = balance(s, step, boundary, law)
        if left <= leaves_N:
            return iteration, True
        if not left < math.inf or iteration == MOST_ITERATIONS:
            return iteration, False
        solve(s, law.n)
        for i in range(law.n + 2):
            s[W + i] += s[CHANGE + i]
    return MOST_ITERATIONS, False


@kernel
def error(s: Floats, law: Law, formula: Formula) -> float:
    """Return the error of a step as a tension, from how far its guess was off [N]."""
    h, h1, h2, gh, _, _ = formula
    for j in range(law.n + 1):
        off = (s[W + j] - s[W_GUESS + j]) - (s[W + j + 1] - s[W_GUESS + j + 1])
        s[CHANGE + j] = abs(s[STIFFNESS + j] * off)
    largest = largest_of(s, law.n + 1)
    if h2 == math.inf:
        return 0.5 * gh * largest
    ratio = h / h1
    corrected = h * h * h * (1.0 + ratio) ** 2 / (ratio * (1.0 + 2.0 * ratio))
    guessed = h * (h + h1) * (h + h1 + h2)
    return gh * largest * corrected / (corrected + guessed)


@kernel
def largest_of(s: Floats, count: int) -> float:
    """Return the largest of CHANGE, by two searches side by side."""
    a, b = s[CHANGE], 0.0
    for i in range(1, count - 1, 2):
        a, b = max(a, s[CHANGE + i]), max(b, s[CHANGE + i + 1])
    largest: float = max(a, b, s[CHANGE + count - 1])
    return largest


@kernel
def keep(s: Floats, step: Step, law: Law) -> None:
    """Take the step's end as the present."""
    for i in range(law.n + 2):
        s[Y2 + i] = s[Y1 + i]
        s[Y1 + i] = s[Y + i]
        s[Y + i] = s[Y_NEW + i]
        s[V1 + i] = s[V + i]
        s[V + i] = s[W + i] + step.speed
        s[Z1 + i] = s[Z + i]
        s[Z + i] = s[Z_NEW + i]
