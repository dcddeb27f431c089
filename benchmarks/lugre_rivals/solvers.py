"""General solvers as rivals, each tuned for the least time at an error of 0.05 % of F_in's range.

None waits for Python more than it must: right hand side and Jacobian are compiled, linear algebra
is banded, and where a solver's own output costs more than its steps, the steps are joined by
cubics whose slopes are known.
"""

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from scipy.integrate import BDF, Radau, odeint
from scipy.linalg import get_lapack_funcs

from benchmarks.lugre_rivals import ode
from benchmarks.lugre_rivals.compiled import BANDS, LOWER, UPPER, jacobian, rate, spread
from benchmarks.lugre_rivals.drives import Floats, Samples
from benchmarks.lugre_rivals.native import cvode_in_c
from benchmarks.lugre_rivals.ode import Output, Problem
from benchmarks.lugre_rivals.solution import (
    NotAvailableError,
    Tolerance,
    at_times,
    joined,
)

MOST_STEPS = 1_000_000
LONGEST_JOINT_S = 0.005  # that LSODA's outputs are joined over by cubics

Rate: TypeAlias = Callable[[float, Floats], Floats]


def sundae(
    problem: Problem,
    tolerance: Tolerance,
    *,
    max_order: int = 2,
    max_newton: int = 2,
    steps_only: bool = True,
) -> Output:
    """CVODE through scikit-sundae, banded; its Newton coefficient cannot be set.

    `max_order` is the highest of the BDF formulas. With `steps_only` it is asked for its steps,
    which are joined by cubics; otherwise for the state at each time.
    """
    try:
        from sksundae.cvode import CVODE
    except ImportError as error:
        raise NotAvailableError("scikit-sundae is not installed") from error

    given, size = _tables(problem), problem.start().size
    columns = np.zeros((size, BANDS))

    def fill(t: float, state: Floats, _: Floats, J: Floats) -> None:
        jacobian(t, state, columns, *given)
        spread(columns, J)

    solver = CVODE(
        lambda t, state, out: rate(t, state, out, *given),
        jacfn=fill,
        linsolver="band",
        lband=LOWER,
        uband=UPPER,
        rtol=tolerance.relative,
        atol=tolerance.absolute(problem.model.lumps),
        max_order=max_order,
        max_nonlin_iters=max_newton,
        max_num_steps=MOST_STEPS,
    )
    wanted = problem.time_s[[0, -1]] if steps_only else problem.time_s
    found = solver.solve(wanted, problem.start())
    if not found.success:
        raise RuntimeError(found.message)
    return joined(problem, found.t, found.y) if steps_only else at_times(problem, found.y)


def lsoda(
    problem: Problem, tolerance: Tolerance, *, max_order: int = 2, join: bool = True
) -> Output:
    """LSODA through `odeint`, banded; where the drive is smooth, its outputs may be joined."""
    given = _tables(problem)
    out = np.empty(problem.start().size)
    columns = np.zeros((out.size, BANDS))

    def rate_of(t: float, state: Floats) -> Floats:
        rate(t, state, out, *given)
        return out

    def jacobian_of(t: float, state: Floats) -> Floats:
        jacobian(t, state, columns, *given)
        return columns

    every = 1
    if join and not isinstance(problem.drive, Samples):
        every = max(1, int(LONGEST_JOINT_S / (problem.time_s[1] - problem.time_s[0])))
    wanted = np.append(problem.time_s[:-1:every], problem.time_s[-1])
    states = odeint(
        rate_of,
        problem.start(),
        wanted,
        tfirst=True,
        Dfun=jacobian_of,
        col_deriv=True,
        ml=LOWER,
        mu=UPPER,
        rtol=tolerance.relative,
        atol=tolerance.absolute(problem.model.lumps),
        mxords=max_order,
        mxstep=MOST_STEPS,
    )
    return at_times(problem, states) if every == 1 else joined(problem, wanted, states)


def bdf(problem: Problem, tolerance: Tolerance) -> Output:
    """Solve by scipy's BDF with banded linear algebra, its steps joined by cubics."""
    solver = _banded(BDF, problem, tolerance, _compiled_rate(problem))
    times, states = [solver.t], [solver.y]
    while solver.status == "running":
        _step(solver)
        times.append(solver.t)
        states.append(solver.y)
    return joined(problem, np.array(times), np.array(states))


def radau(problem: Problem, tolerance: Tolerance, *, max_step_s: float = 0.16) -> Output:
    """Solve by scipy's Radau with banded linear algebra and its own polynomials between steps.

    Newton starts from the state before the step, since the last step's polynomial leads it astray
    at a reversal. `max_step_s` keeps a step from going far beyond one.
    """
    solver = _banded(Radau, problem, tolerance, _compiled_rate(problem), max_step=max_step_s)
    at = np.empty((problem.time_s.size, solver.n))
    at[0], done = solver.y, 1
    while solver.status == "running":
        solver.sol = None
        _step(solver)
        to = int(np.searchsorted(problem.time_s, solver.t, side="right"))
        if to > done:
            at[done:to] = solver.dense_output()(problem.time_s[done:to]).T
            done = to
    return at_times(problem, at)


def radau_in_numpy(problem: Problem, tolerance: Tolerance) -> Output:
    """Solve by scipy's Radau with the equations in numpy and a step's end at each time: slow."""
    solver = _banded(Radau, problem, tolerance, partial(ode.rate, problem=problem))
    at = [solver.y]
    for wanted in problem.time_s[1:]:
        solver.t_bound, solver.status = wanted, "running"
        while solver.status == "running":
            solver.sol = None
            _step(solver)
        at.append(solver.y)
    return at_times(problem, np.array(at))


def _banded(
    method: Any, problem: Problem, tolerance: Tolerance, rate_of: Rate, **options: Any
) -> Any:
    """Return one of scipy's implicit solvers, with banded linear algebra in place of its own."""
    given, start = _tables(problem), problem.start()
    factors = {
        np.dtype(kind): get_lapack_funcs(("gbtrf", "gbtrs"), dtype=kind)
        for kind in (float, complex)
    }

    def jacobian_of(t: float, state: Floats, _: Floats | None = None) -> Floats:
        bands = np.zeros((state.size, LOWER + BANDS))  # gbtrf fills the first ones
        jacobian(t, state, bands[:, LOWER:], *given)
        return bands.T

    def factorised(bands: Any) -> Any:
        factor, solve = factors[bands.dtype]
        lu, pivots, _ = factor(bands, LOWER, UPPER, overwrite_ab=True)
        return solve, lu, pivots

    def solved(factorisation: Any, b: Any) -> Any:
        solve, lu, pivots = factorisation
        return solve(lu, LOWER, UPPER, b, pivots)[0]

    solver = method(
        rate_of,
        problem.time_s[0],
        start,
        problem.time_s[-1],
        jac=np.zeros((start.size, start.size)),
        rtol=tolerance.relative,
        atol=tolerance.absolute(problem.model.lumps),
        **options,
    )
    solver.jac, solver.J = jacobian_of, jacobian_of(problem.time_s[0], start)
    solver.I = np.zeros_like(solver.J)
    solver.I[LOWER + UPPER] = 1.0
    solver.lu, solver.solve_lu = factorised, solved
    return solver


def _compiled_rate(problem: Problem) -> Rate:
    given, size = _tables(problem), problem.start().size

    def rate_of(t: float, state: Floats) -> Floats:
        out = np.empty(size)
        rate(t, state, out, *given)
        return out

    return rate_of


def _step(solver: Any) -> None:
    # scipy's BDF subtracts rows of its table that it has not filled yet: any numbers, maybe NaN.
    with np.errstate(invalid="ignore", over="ignore"):
        failure = solver.step()
    if failure:
        raise RuntimeError(failure)


def _tables(problem: Problem) -> tuple[Floats, Floats, Floats]:
    return np.array(problem.model.constants()), *problem.drive.tables()


class Rival(NamedTuple):
    """A solver, and the tolerance at which it is fastest with an error of at most 0.05 %.

    The usual call has one absolute tolerance for all, all orders, and the solver's own output.
    """

    name: str
    solve: Callable[[Problem, Tolerance], Output]
    tolerance: Tolerance


RIVALS = (
    Rival("CVODE in C", cvode_in_c, Tolerance(5e-4, 3.5e-3, 3.5e-6, 9e-8)),
    Rival("LSODA", lsoda, Tolerance(3e-4, 4.5e-2, 2.6e-6)),
    Rival("CVODE, scikit-sundae", sundae, Tolerance(4.6e-5, 3.6e-4, 1.2e-6, 2e-7)),
    Rival(
        "LSODA, usual call",
        partial(lsoda, max_order=5, join=False),
        Tolerance(1e-5, 1e-5, 1e-5, 1e-3),
    ),
    Rival(
        "CVODE, scikit-sundae, usual call",
        partial(sundae, max_order=5, max_newton=3, steps_only=False),
        Tolerance(1e-5, 1e-5, 1e-5, 1e-5),
    ),
    Rival("BDF, scipy", bdf, Tolerance(1.8e-5, 4e-3, 1.2e-6, 2e-4)),
    Rival("Radau, scipy", radau, Tolerance(1.4e-4, 1.2e-3, 1.4e-5, 5.6e-3)),
)
