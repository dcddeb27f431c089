"""What a joint fit finds, in units and intervals; what it misses, and what is said of it."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from tests.physics.references import GROUP_A
from tsas_cli.identification import fit_sentences as fs
from tsas_cli.identification import joint_fit as j
from tsas_cli.identification.base_fit import _zero_between
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit import Fitted, Unknown
from tsas_cli.identification.fit_problem import FitProblem, nominal_unknowns, rig_at
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


def test_an_estimate_is_in_its_own_unit():
    """A positive number has its interval in proportion, others a symmetric one."""
    sought = [unknown(FRICTION), unknown(ZERO, 1, -9.0, 9.0)]
    found = fitted([math.log(0.2), 1.5], [0.1, 0.25], t=2.0, at_bound=[1])
    friction, zero = j.estimates_of(sought, found, ["a", "b"])
    assert (friction.name, friction.run, friction.unit) == (FRICTION, None, "1")
    assert friction.value == pytest.approx(0.2)
    assert friction.stderr == pytest.approx(0.02)
    assert friction.interval_low == pytest.approx(0.2 * math.exp(-0.2))
    assert friction.interval_high == pytest.approx(0.2 * math.exp(0.2))
    assert (friction.origin, friction.at_bound) == ("fitted", False)
    assert (zero.name, zero.run, zero.value, zero.stderr) == (ZERO, "b", 1.5, 0.25)
    assert (zero.interval_low, zero.interval_high, zero.at_bound) == (1.0, 2.0, True)


def test_an_interval_ends_at_the_bounds_and_is_all_of_it_without_an_error():
    sought = [unknown(ZERO, 0, -1.0, 2.0)] * 2
    near, open_ = j.estimates_of(sought, fitted([1.5, 1.0], [5.0, math.inf]), ["a"])
    assert (near.interval_low, near.interval_high, near.stderr) == (-1.0, 2.0, 5.0)
    assert (open_.interval_low, open_.interval_high, open_.stderr) == (-1.0, 2.0, None)


def test_an_effect_s_number_is_in_units_of_its_size():
    name = "free_tendon.proximal_length_mm"
    size = QUANTITIES[name].size
    (found,) = j.estimates_of([unknown(name)], fitted([3.0], [0.5]), [])
    assert (found.value, found.stderr) == pytest.approx((3.0 * size, 0.5 * size))


def fit_of(problem, values=(), chosen=(), errors=()):
    return j.FittedModel(problem, np.array(values), tuple(chosen), errors, NOTHING, None, ())


def run_with(*errors_at):
    """Return a run's errors, told by the zero of x_out."""
    return SimpleNamespace(errors=lambda rig: errors_at[round(rig.x_out_zero_mm)])


def test_a_channel_is_missed_by_its_worst_run():
    """Mean squares of 1.69 and 1.7, and of 25: an error of 1.3 is the limit."""
    one = run_with({"f_in_N": np.full(4, 1.3), "f_out_N": np.array([5.0, -5.0])})
    two = run_with(None, {"f_in_N": np.full(4, 1.0), "f_out_N": np.array([1.0, 1.0])})
    (said,) = j.misfit(fit_of(problem_of(), errors=(one, two)))
    assert said.startswith("The reduced chi-square is up to 25 for f_out_N (1 at the noise level):")
    two = run_with(None, {"f_in_N": np.array([0.0, 1.31 * math.sqrt(2.0)])})
    (said,) = j.misfit(fit_of(problem_of(), errors=(one, two)))
    assert "up to 1.72 for f_in_N and 25 for f_out_N (1" in said


def test_a_rig_takes_its_own_values_and_the_shared_ones():
    sought = [unknown(FRICTION), unknown(ZERO, 0), unknown(ZERO, 1)]
    values = np.array([math.log(0.3), 1.0, 2.0])
    for k, zero in ((0, 1.0), (1, 2.0), (2, GROUP_A.x_in_zero_mm)):
        rig = rig_at(GROUP_A, k, sought, values)
        assert rig.friction_coefficient == pytest.approx(0.3)
        assert rig.x_in_zero_mm == zero


def test_values_that_are_moved_stay_within_their_bounds():
    sought = [
        unknown(FRICTION), unknown(ZERO, 0, -1.0, 1.0), unknown("bristles.damping_N_s_per_mm"),
    ]  # fmt: skip
    problem = problem_of(sought, "a", initial=Model((Estimate("preload_N", 7.0, "N", "given"),)))
    made = fit_of(problem, [math.log(0.2), 0.5, math.nan], chosen=[1])
    model = j.moved_model(made, np.array([0.25]))
    assert model.value(FRICTION) == pytest.approx(0.2)
    assert model.value(ZERO, "a") == 0.75
    assert model.value("preload_N") == 7.0
    assert model.value("bristles.damping_N_s_per_mm") is None  # critical
    assert j.moved_model(made, np.array([9.0])).value(ZERO, "a") == 1.0
    assert j.moved_model(made, np.array([-9.0])).value(ZERO, "a") == -1.0
    assert {e.origin for e in model.estimates if e.name == ZERO} == {"default"}


class Runaway:
    """Residuals of one run: a friction of 0.3, and a zero that gains the farther away it is."""

    def residuals(self, rig):
        noise = np.random.default_rng(7).standard_normal(100)
        drifted = 2e4 * (1.0 - rig.x_in_zero_mm / 2e5)
        return noise + drifted + np.linspace(-1, 1, 100) * 1e3 * (rig.friction_coefficient - 0.3)


def test_a_zero_that_runs_to_its_bound_is_fixed_and_the_rest_fitted_again(monkeypatch):
    monkeypatch.setattr(j, "reweighted", lambda errors, rig: errors)
    monkeypatch.setattr(j, "blocks_of", lambda errors, rigs: [np.arange(100) // 10])
    problem = problem_of([unknown(FRICTION), unknown(ZERO, 0)], "a")
    fit = j.solve_fit(replace(problem, errors=(Runaway(),)))
    assert [u.name for u in fit.free] == [FRICTION]
    assert fit.model.value(FRICTION) == pytest.approx(0.3, abs=0.05)
    assert fit.values[1] == 0.0
    (note,) = fit.not_identifiable
    assert note == f"{ZERO} is not identifiable from these recordings; it is fixed at 0 mm."


def estimate(name=FRICTION, run=None, *, at_bound=False, stderr=0.1, low=1.0, high=2.0, value=1.5):
    return Estimate(name, value, QUANTITIES[name].unit, "fitted", run, stderr, low, high, at_bound)


def doubts(*estimates, **how):
    return fs.doubts_of(estimates, fitted([0.0], [1.0], **how))


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


def test_what_is_said_of_many_runs_is_said_once():
    (said,) = doubts(*(estimate(ZERO, run, at_bound=True) for run in "abcd"))
    assert said.startswith("x_in_zero_mm of 4 runs converged to its plausible bound, 1.5: ")


def test_what_has_no_error_or_no_end_is_said():
    (said,) = doubts(estimate(stderr=None))
    assert said.startswith("friction_coefficient is not identifiable at the minimum")
    (said,) = doubts(estimate(low=1.0000000001e-4, high=10.0))  # the whole range
    assert said.startswith("friction_coefficient is not identifiable at the minimum")
    assert doubts(estimate(low=1e-4), estimate(high=10.0)) == []
    (said,) = doubts(estimate(), converged=False, message="too many evaluations.")
    assert said.startswith("The fit did not converge (too many evaluations): its estimates")


def test_what_is_fixed_is_said_once_for_each_reason():
    unknowns = [unknown(FRICTION), unknown(ZERO, 0), unknown(ZERO, 1), unknown("preload_N", 1)]
    problem = problem_of(unknowns, fixed=Model((Estimate(ZERO, 0.25, "mm", "given", "a"),)))
    assert fs.fixed_sentences(problem, {1: [3, 0], 2: [0, 3], 0: [], 3: []}) == [
        (
            "x_in_zero_mm is not identifiable together with friction_coefficient and preload_N "
            "from these recordings; it is fixed at 0.25 mm."
        ),
        "friction_coefficient is not identifiable from these recordings; it is fixed at 0.1.",
        "preload_N is not identifiable from these recordings (runs b); it is fixed at 10 N.",
    ]
    assert fs.fixed_sentences(problem, {1: [0], 2: [0, 3]}) == [
        (
            "x_in_zero_mm is not identifiable together with friction_coefficient and preload_N "
            "from these recordings; it is fixed at 0.25 mm."
        )
    ]
    assert problem.ids == ["a", "b"]
    of_b = fs.fixed_sentences(problem, {2: [1]})
    assert of_b[0].startswith(
        "x_in_zero_mm is not identifiable together with x_in_zero_mm of other"
    )


@pytest.mark.parametrize(("load", "bend_rad"), [("spring", 3.0), ("spring", None), ("force", 3.0)])
def test_each_load_has_its_unknowns_as_far_off_as_they_may_be(load, bend_rad):
    """A preload and a load's spring are told by a spring alone; a zero is off by a tenth."""
    run = SimpleNamespace(id="a", load=load, total_bend_rad=bend_rad, sheath_length_mm=700.0)
    runs = [SimpleNamespace(run=run, drive=SimpleNamespace(values=np.array([-3.0, 5.0])))] * 2
    stated = Model((Estimate("friction_coefficient", 0.2, "1", "data sheet"),))
    found = list(nominal_unknowns(stated, stated, runs, {"tendon_stiffness_N": (1e4, 2e4)}))
    own = [("preload_N", 0), ("preload_N", 1)] if load == "spring" else []
    zeros = [(f"x_{end}_zero_mm", k) for end in ("in", "out") for k in (0, 1)]
    shared = ["friction_coefficient", *(["load_stiffness_N_per_mm"] if own else [])]
    first = [(name, None) for name in shared]
    expected = [*first, *own, ("tendon_stiffness_N", None), *zeros]
    assert [(u.name, u.run) for u in found] == expected
    scales = {u.name: u.scale for u in found}
    assert scales["friction_coefficient"] == (1.0 if bend_rad else 7.0)
    assert (scales["tendon_stiffness_N"], scales["x_in_zero_mm"]) == pytest.approx((7.0, 0.8))
    tendon = next(u for u in found if u.name == "tendon_stiffness_N")
    assert np.exp([tendon.lower, tendon.initial, tendon.upper]) == pytest.approx([1e4, 2e4, 2e4])
    assert found[0].initial == pytest.approx(np.log(0.2))


@pytest.mark.parametrize(("lead_mm", "slack"), [(-0.11, True), (-0.09, False)])
def test_a_tendon_that_would_be_slack_between_two_drives_has_another_zero(lead_mm, slack):
    """20 N stretch it by 0.1 mm, 30 N by half of that more."""
    rig = GROUP_A._replace(preload_N=20.0, tendon_stiffness_N=4000.0, sheath_length_mm=20.0)
    x = np.array([1.0, 2.0, 4.0])
    ends = {"x_in_mm": SimpleNamespace(values=x + lead_mm), "x_out_mm": SimpleNamespace(values=x)}
    run = SimpleNamespace(
        measured={"f_out_N": np.full(3, 30.0)}, drive_column="x_in_mm", conditioned=ends
    )
    expected = {"x_in_zero_mm": pytest.approx(lead_mm - 0.05)} if slack else {}
    assert _zero_between(run, rig) == expected


@pytest.mark.parametrize(
    ("low", "high", "values", "held"),
    [
        (0.1, 0.3, (0.1, 0.3), True),
        (0.1, 0.3, (0.2, 0.31), False),
        (0.1, 0.3, (0.0,), False),
        (None, None, (0.2,), False),
    ],
)
def test_an_interval_holds_values_only_where_there_is_one(low, high, values, held):
    e = Estimate("friction", 0.2, "1", "fitted", interval_low=low, interval_high=high)
    assert e.holds(*values) == held


@pytest.mark.parametrize(("left", "converged"), [(1e3, True), (1.0, False)])
def test_far_from_the_noise_a_fit_ends_where_it_gains_little(monkeypatch, left, converged):
    """Of two residuals one stays, the other falls by a factor e in each of few steps."""
    monkeypatch.setattr("tsas_cli.identification.fit.MOST_EVALUATIONS", 4)
    unknowns = [unknown(FRICTION)]
    rig = GROUP_A._replace(friction_coefficient=1.0)
    problem = replace(problem_of(unknowns, runs="a"), rigs=(rig,))
    run = SimpleNamespace(
        residuals=lambda rig: np.array([left, 300.0 * rig.friction_coefficient]),
        blocks=lambda rig, longest: np.array([0, 1]),
        length=2,
    )
    found = j._fit(problem, (run,), np.zeros(1), [0], tolerance=j.FINE)
    assert found.converged is converged
    assert found.values[0] < -2.9
