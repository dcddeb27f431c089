"""Results of a joint fit and its problem, made up as several tests need them."""

from types import SimpleNamespace

import numpy as np

from tests.physics.references import GROUP_A
from tsas_cli.identification.fit import Fitted, Unknown
from tsas_cli.identification.fit_problem import FitProblem
from tsas_cli.identification.model import Model
from tsas_cli.identification.quantities import QUANTITIES

FRICTION, ZERO = "friction_coefficient", "x_in_zero_mm"


def fitted(values, stderr, t=2.0, at_bound=(), *, converged=True, message="done."):
    n = len(values)
    bound = np.array([k in at_bound for k in range(n)])
    return Fitted(np.array(values), np.array(stderr), np.full(n, t), bound, converged, message, 1)


def unknown(name, run=None, lower=None, upper=None):
    q = QUANTITIES[name]
    low = q.scaled(q.lower) if lower is None else lower
    return Unknown(name, run, 0.0, low, q.scaled(q.upper) if upper is None else upper, 1.0)


NOTHING = Model(())


def problem_of(unknowns=(), runs="ab", initial=NOTHING, fixed=NOTHING):
    """Return the problem of runs with these names, whose rigs differ by the zero of x_out."""
    named = tuple(SimpleNamespace(run=SimpleNamespace(id=name)) for name in runs)
    rigs = tuple(GROUP_A._replace(x_out_zero_mm=float(k)) for k in range(len(runs)))
    return FitProblem(initial, fixed, named, rigs, tuple(unknowns), (), ())
