"""Verdict, reason and estimates of a diagnosis."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.diagnosis import diagnose as d
from tsas_cli.diagnosis import proven as p
from tsas_cli.diagnosis.diagnose import verdict_of
from tsas_cli.diagnosis.held_out import Folds
from tsas_cli.diagnosis.remainder import Remainder
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.extension import HypothesisFit
from tsas_cli.identification.fit import Fitted, Solution, Unknown


def test_a_tendon_stays_near_its_data_sheet(monkeypatch):
    """Told 1000 N, it lies between 0.85 of that and 1/0.85 of it."""
    given = {}
    monkeypatch.setattr(d, "base_fit", lambda *rest: given.update(plausible=rest[-1]))
    for told in (1000.0, None):
        sheet = SimpleNamespace(value=lambda name, told=told: told)
        monkeypatch.setattr(d, "data_sheet", lambda manifest, sheet=sheet: sheet)
        d.nominal_fit(None, None, [])
        if told is None:
            assert given["plausible"] == {}
        else:
            low, high = given["plausible"]["tendon_stiffness_N"]
            assert (low, high) == pytest.approx((850.0, 1000.0 / 0.85))


def stated(*parts):
    return [Remainder(mean_square, {}, (), reducible) for mean_square, reducible in parts]


@pytest.mark.parametrize(
    ("start", "after", "left"),
    [
        ((9.0, 4.0), (2.0, 1.0), 1.0 / 8.0),  # of 9 − 1 there is left 1
        ((9.0, 4.0), (2.0, 0.0), 0.0),  # slow noise of the same size is no cause's
        ((1.0, 0.0), (1.0, 0.0), 0.0),
        ((2.0, 1.0), (3.0, 2.0), 1.0),
    ],
)
def test_the_share_left_is_of_what_could_be_explained(start, after, left):
    assert d._share_left(*stated(start, after)) == pytest.approx(left)


def test_why_nothing_can_be_diagnosed():
    good = SimpleNamespace(converged=True, message="")
    bad = SimpleNamespace(converged=False, message="steps")

    def reason(runs, fitted):
        problem = SimpleNamespace(runs=runs)
        return d._not_possible(SimpleNamespace(problem=problem, fitted=fitted))

    assert reason([1], good) is None
    assert reason([], good).startswith("no run lasts")
    assert reason([1], None).startswith("no parameter")
    assert reason([1], bad).endswith("did not converge (steps).")


def test_tolerances_and_the_noise_add_up_in_squares(monkeypatch):
    """Noise leaves each of two unknowns by 1, a tolerance both together by 3.

    They are known by their difference. Blocks are counted from 0 in each run.
    """
    given = {}
    fitted = Fitted(*(np.full(2, v) for v in (7.0, 1.0, 2.0)), np.zeros(2, bool), True, "", 1)

    def with_errors(unknowns, solution, blocks, *, by_run):
        given.update(blocks=[b.tolist() for b in blocks], by_run=by_run)
        return fitted

    monkeypatch.setattr(p, "with_errors", with_errors)
    monkeypatch.setattr(p, "covariance_of_tolerances", lambda *_: np.full((2, 2), 9.0))
    monkeypatch.setattr(
        p,
        "estimates_of",
        lambda unknowns, fit, ids: [Estimate("a", e, "1", "fitted") for e in fit.stderr],
    )
    folds = Folds(np.zeros(6, int), np.array([0, 0, 1, 2, 2, 4]), np.repeat([0, 1], 3), True)
    bench = SimpleNamespace(rigs=[0, 1], base=SimpleNamespace(problem=SimpleNamespace(ids=[])))
    trial = SimpleNamespace(unknowns=[], solution=None, effects=(), correlation=lambda: np.eye(2))
    search = SimpleNamespace(folds=folds, bench=bench)
    told, correlation = p.estimates_with_tolerances(search, trial, np.zeros((6, 7)))
    assert [e.value for e in told] == pytest.approx([np.sqrt(10.0)] * 2)
    assert correlation == pytest.approx(np.array([[1.0, 0.9], [0.9, 1.0]]))
    assert given == {"blocks": [[0, 0, 1], [0, 0, 1]], "by_run": True}


def test_a_sheath_beside_an_unknown_tendon_is_found_by_its_name():
    """The tendon need not be the first unknown."""
    unknowns = [
        Unknown("friction_coefficient", None, 0.0, -9.0, 9.0, 1.0),
        Unknown("tendon_stiffness_N", None, 0.0, math.log(0.5), math.log(2.0), 1.0),
    ]
    solution = Solution(
        np.array([5.0, math.log(1.25)]),
        np.zeros(2, bool),
        np.zeros(1),
        np.zeros((1, 2)),
        True,
        "",
        1,
    )
    trial = HypothesisFit((), tuple(unknowns), solution, (1,), on_mesh=False)
    found = p._with_data_sheet_interval(Estimate(p.SHEATH, 1.0, "1", "fitted"), trial)
    assert found.interval_low == 0.0  # 2 · 0.5/1.25 is less than 1
    assert found.interval_high == pytest.approx(2.0 * 2.0 / 1.25 - 1.0)
    assert found.stderr == pytest.approx((2.0 * 2.0 / 1.25 - 2.0) / 1.96)


@pytest.mark.parametrize(
    ("rivals", "stand_ins", "complete", "verdict"),
    [
        ([], [], True, "sufficient"),
        ([], [], False, "unexplained"),
        ([], ["backlash"], True, "stand_in"),
        ([], ["backlash"], False, "stand_in"),
        ([()], [], True, "named"),
        ([()], [], False, "partly"),
        ([()], ["backlash"], True, "partly"),
        ([(), ("play",)], [], True, "ambiguous"),
        ([("play",)], [], False, "partly"),
    ],
)
def test_the_verdict(rivals, stand_ins, complete, verdict):
    assert verdict_of(rivals, stand_ins, complete=complete) == verdict


def test_a_sheath_is_as_unsure_as_the_tendons_data_sheet():
    """(1 + ratio)/EA is what is told: with EA 20 % up or down the ratio follows."""
    unknown = Unknown("tendon_stiffness_N", None, 0.0, math.log(0.8), math.log(1.2), 1.0)
    trial = SimpleNamespace(unknowns=[unknown], solution=SimpleNamespace(values=np.zeros(1)))
    ratio = Estimate("sheath_compression.compliance_ratio", 0.5, "1", "fitted", None, 0.0, 0.5, 0.5)
    found = p._with_data_sheet_interval(ratio, trial)
    assert found.interval_low == pytest.approx(1.5 * 0.8 - 1.0)
    assert found.interval_high == pytest.approx(1.5 * 1.2 - 1.0)
    assert found.stderr == pytest.approx(0.3 / 1.96)
    low = p._with_data_sheet_interval(Estimate("r", 0.1, "1", "fitted"), trial)
    assert low.interval_low == 0.0
    without = SimpleNamespace(unknowns=[], solution=trial.solution)
    assert p._with_data_sheet_interval(ratio, without) is ratio
