"""Newton's equations solved: a tridiagonal matrix, from both ends to the middle.

With every row divided by its diagonal, the leading minors are p[i] = p[i−1] − l[i] u[i−1] p[i−2],
and the right side scaled by them is q[i] = r[i] p[i−1] − l[i] q[i−1]: no division waits for the
one before it. A minor is no less than about half of the one before it, so that 1000 rows do not
underflow.
"""

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.lugre.state import DIAGONAL, INCREMENT, LOWER, MINOR, RESIDUAL, SCALED, UPPER
from tsas_cli.support.arrays import Floats


@kernel
def solve(s: Floats, n: int) -> None:
    """Write the solution for the nodes 0 to n + 1 to INCREMENT."""
    last = n + 1
    for i in range(n + 2):
        inverse = 1.0 / s[DIAGONAL + i]
        s[LOWER + i] *= inverse
        s[UPPER + i] *= inverse
        s[RESIDUAL + i] *= inverse
    middle = (n + 2) // 2  # the first node that is eliminated from the load's end
    p, p_before, q = 1.0, 1.0, s[RESIDUAL]
    r, r_before, t = 1.0, 1.0, s[RESIDUAL + last]
    s[MINOR], s[SCALED] = 1.0, q
    s[MINOR + last], s[SCALED + last] = 1.0, t
    for i in range(1, middle):
        j = last - i
        q = s[RESIDUAL + i] * p - s[LOWER + i] * q
        t = s[RESIDUAL + j] * r - s[UPPER + j] * t
        p, p_before = p - s[LOWER + i] * s[UPPER + i - 1] * p_before, p
        r, r_before = r - s[UPPER + j] * s[LOWER + j + 1] * r_before, r
        s[MINOR + i], s[SCALED + i] = p, q
        s[MINOR + j], s[SCALED + j] = r, t
    if 2 * middle < n + 2:
        j = middle
        t = s[RESIDUAL + j] * r - s[UPPER + j] * t
        r, r_before = r - s[UPPER + j] * s[LOWER + j + 1] * r_before, r
        s[MINOR + j], s[SCALED + j] = r, t
    solve_middle(s, middle, p_before, r_before)
    substitute(s, n, middle)


@kernel
def solve_middle(s: Floats, middle: int, p_before: float, r_before: float) -> None:
    """Solve the two rows where both eliminations meet."""
    a, b = s[MINOR + middle - 1], s[UPPER + middle - 1] * p_before
    c, d = s[LOWER + middle] * r_before, s[MINOR + middle]
    inverse = 1.0 / (a * d - b * c)
    s[INCREMENT + middle - 1] = (d * s[SCALED + middle - 1] - b * s[SCALED + middle]) * inverse
    s[INCREMENT + middle] = (a * s[SCALED + middle] - c * s[SCALED + middle - 1]) * inverse


@kernel
def substitute(s: Floats, n: int, middle: int) -> None:
    """Substitute from the middle to both ends."""
    for i in range(1, middle):  # towards x[i−1] = q/p − (u p before/p) x[i]
        s[DIAGONAL + i] = s[UPPER + i] * s[MINOR + i - 1]
    s[DIAGONAL] = s[UPPER]
    for j in range(middle, n + 1):
        s[DIAGONAL + j] = s[LOWER + j] * s[MINOR + j + 1]
    s[DIAGONAL + n + 1] = s[LOWER + n + 1]
    for i in range(n + 2):
        inverse = 1.0 / s[MINOR + i]
        s[DIAGONAL + i] *= inverse
        s[SCALED + i] *= inverse
    above, below = s[INCREMENT + middle - 1], s[INCREMENT + middle]
    for i in range(middle - 2, -1, -1):
        above = s[SCALED + i] - s[DIAGONAL + i] * above
        s[INCREMENT + i] = above
    for j in range(middle + 1, n + 2):
        below = s[SCALED + j] - s[DIAGONAL + j] * below
        s[INCREMENT + j] = below
