"""What is said of a fit: bounds, missing errors, what is fixed and why."""

from tests.identification.fits import FRICTION, ZERO, fitted, problem_of, unknown
from tsas_cli.identification import joint_fit as w
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model
from tsas_cli.identification.quantities import QUANTITIES


def estimate(name=FRICTION, run=None, *, at_bound=False, stderr=0.1, low=1.0, high=2.0, value=1.5):
    return Estimate(name, value, QUANTITIES[name].unit, "fitted", run, stderr, low, high, at_bound)


def doubts(*estimates, **how):
    return w.doubts_of(estimates, fitted([0.0], [1.0], **how))


def test_a_good_fit_leaves_no_doubt():
    assert doubts(estimate(), estimate(ZERO, "a")) == []


def test_what_ended_at_a_bound_is_said():
    own, shared = doubts(estimate(ZERO, "a", at_bound=True), estimate(at_bound=True))
    assert own == (
        "x_in_zero_mm of run a converged to its plausible bound, 1.5: the estimate is unreliable."
    )
    assert shared.startswith("friction_coefficient converged to its plausible bound")


def test_what_ended_where_it_does_nothing_is_no_bound():
    name = "free_tendon.proximal_length_mm"
    (said,) = doubts(estimate(name, at_bound=True, value=0.0, low=0.0, high=3.14159))
    assert said == f"{name} converged to zero: values up to 3.1 mm are not excluded."
    assert doubts(estimate(name, value=0.0, low=0.0)) == []  # near it, not at the bound


def test_what_has_no_error_or_no_end_is_said():
    (said,) = doubts(estimate(stderr=None))
    assert said.startswith("friction_coefficient is not identifiable at the minimum")
    (said,) = doubts(estimate(), converged=False, message="too many evaluations.")
    assert said.startswith("The fit did not converge (too many evaluations): its estimates")


def test_what_is_fixed_is_said_once_for_each_reason():
    unknowns = [unknown(FRICTION), unknown(ZERO, 0), unknown(ZERO, 1), unknown("preload_N", 1)]
    problem = problem_of(unknowns, fixed=Model((Estimate(ZERO, 0.25, "mm", "given", "a"),)))
    assert w.fixed_sentences(problem, {1: [3, 0], 2: [0, 3], 0: [], 3: []}) == [
        (
            "x_in_zero_mm is not identifiable together with friction_coefficient and preload_N "
            "from these recordings (runs a, b); it is fixed at 0.25 mm."
        ),
        "friction_coefficient is not identifiable from these recordings; it is fixed at 0.1.",
        "preload_N is not identifiable from these recordings (runs b); it is fixed at 10 N.",
    ]
    assert problem.ids == ["a", "b"]


def test_damping_that_nobody_knows_is_critical():
    name = "bristles.damping_N_s_per_mm"
    assert w._fixed_value(Model(()), name, "") == "its critical value"
    known = Model((Estimate(name, 0.5, "N s/mm", "given"),))
    assert w._fixed_value(known, name, "") == "0.5 N s/mm"
