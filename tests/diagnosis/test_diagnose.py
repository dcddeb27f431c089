"""Verdict, reason and estimates of a diagnosis."""

from types import SimpleNamespace

import pytest

from tsas_cli.diagnosis import diagnose as d
from tsas_cli.diagnosis.diagnose import verdict_of
from tsas_cli.diagnosis.remainder import Remainder


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
