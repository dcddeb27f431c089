"""Verdict, reason and estimates of a diagnosis."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from tests.counted import Counted
from tsas_cli.diagnosis import diagnose as d
from tsas_cli.diagnosis.diagnose import (
    Diagnosis,
    _two_digits,
    _with_data_sheet_interval,
    leaves_much,
    verdict_of,
)
from tsas_cli.diagnosis.held_out import Folds
from tsas_cli.diagnosis.remainder import Remainder
from tsas_cli.diagnosis.search import Hypotheses
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.extension import HypothesisFit
from tsas_cli.identification.fit import Fitted, Solution, Unknown
from tsas_cli.identification.model import Model

PLAY, MASS = "backlash", "load_inertia"


def left_of(mean_square, *signals):
    return Remainder(mean_square, {}, signals)


def diagnosis(verdict, *causes, mean_square=1.0, share=0.0, signals=()):
    left = left_of(mean_square, *signals)
    return Diagnosis(verdict, "", Model(()), Model(()), causes, {}, left, share)


def reason(found, start=16.0):
    return d._reason(found, left_of(start), found.remainder)


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


def nominal(monkeypatch, converged=True, blocks=9):
    fitted = SimpleNamespace(converged=converged, message="m")
    base = SimpleNamespace(
        problem=SimpleNamespace(runs=[1]),
        model=Model(()),
        fitted=fitted,
        cannot_tell=["solved"],
        not_identifiable=("u",),
    )
    monkeypatch.setattr(d, "nominal_fit", lambda *_: "problem")
    monkeypatch.setattr(d, "solve_fit", {"problem": base}.__getitem__)
    monkeypatch.setattr(d, "bench_of", lambda base: SimpleNamespace(base=base))
    monkeypatch.setattr(d, "bench_folds", lambda bench: SimpleNamespace(blocks=blocks))
    search = SimpleNamespace(named=frozenset())
    monkeypatch.setattr(d, "find_effects", lambda *_: search)
    concluded = diagnosis("sufficient")
    monkeypatch.setattr(d, "_concluded", lambda *_: concluded)
    monkeypatch.setattr(d, "with_preload_correction", lambda model, runs: model)


def test_what_cannot_be_decided_is_not(monkeypatch):
    nominal(monkeypatch, converged=False)
    found = d.diagnose_runs(None, None, [])
    assert (found.verdict, found.cannot_tell) == ("undecided", ("solved",))
    assert "converge" in found.reason
    nominal(monkeypatch, blocks=5)
    few = d.diagnose_runs(None, None, [])
    assert few.verdict == "undecided"
    assert few.reason == "only 5 independent stretches: too few for a diagnosis."
    nominal(monkeypatch, blocks=6)
    counted = Counted()
    assert d.diagnose_runs(None, None, [], counted).verdict == "sufficient"
    assert counted.total == counted.done == 1  # the search is made up


def judged(squares, named, rivals=()):
    """Return hypotheses with held-out squares of ten blocks; all that is named needs a mesh."""
    rivals = {e.name: dict(rivals).get(e.name, ()) for e in d.EFFECTS if e.name in named}
    mesh = bool(named)
    return Hypotheses(
        SimpleNamespace(on_mesh=bool),
        None,
        frozenset(named),
        rivals,
        (),
        {(frozenset(k), mesh): SimpleNamespace(named=frozenset(k)) for k in squares},
        {(frozenset(k), mesh): np.ones(10) * v for k, v in squares.items()},
    )


@pytest.fixture
def concluded(monkeypatch):
    """Conclude from mean squares by set of effects; a square below 1 is noise alone."""

    def conclude(squares, *named, rivals=()):
        left = {frozenset(k): v for k, v in squares.items()}
        monkeypatch.setattr(
            d,
            "remainder",
            lambda bench, trial, folds: Remainder(left[trial.named], {}, ("time_s",)),
        )
        monkeypatch.setattr(d, "channel_errors", lambda *_: {})
        monkeypatch.setattr(
            d,
            "_estimates",
            lambda search, trial: [
                Estimate(f"{name}.size", 1.0, "mm", "fitted") for name in sorted(trial.named)
            ],
        )
        base = SimpleNamespace(model=Model(()), not_identifiable=("a is fixed",))
        found = judged(squares, named, rivals)
        return d._concluded(found, found, base)

    return conclude


def test_the_share_left_is_of_what_was_beyond_the_noise(concluded):
    """Of 9 − 1 there is left 2.15 − 1 − 0.15: an eighth."""
    found = concluded({(): 9.0, (PLAY,): 2.15}, PLAY)
    assert found.share_left == pytest.approx(1.0 / 8.0)
    assert (found.verdict, found.cannot_tell) == ("named", ("a is fixed",))
    assert [c.effect for c in found.causes] == [PLAY]
    assert [e.name for e in found.causes[0].parameters] == [f"{PLAY}.size"]
    assert [e.name for e in found.model.estimates] == [f"{PLAY}.size"]
    assert found.nominal.estimates == ()
    assert found.causes[0].gain_percent == pytest.approx(100.0 * (1.0 - math.sqrt(2.15 / 9.0)))
    assert "from 3.0 to 1.5 ×" in found.reason


def test_what_is_below_the_noise_leaves_nothing(concluded):
    assert concluded({(): 0.9, (PLAY,): 0.5}, PLAY).share_left == 0.0
    assert concluded({(): 9.0, (PLAY,): 1.1}, PLAY).share_left == 0.0
    assert concluded({(): 1.5, (PLAY,): 1.65}, PLAY).share_left == pytest.approx(1.0)


def test_where_nothing_is_named_all_is_left(concluded):
    found = concluded({(): 9.0})
    assert (found.share_left, found.verdict, found.causes) == (1.0, "unexplained", ())
    assert found.nominal == found.model
    assert found.before.named == found.final.named == frozenset()


def test_causes_stand_in_the_order_of_the_catalogue_with_their_own_parameters(concluded):
    squares = {(): 9.0, (PLAY,): 4.0, (MASS,): 2.0, (PLAY, MASS): 1.0}
    found = concluded(squares, MASS, PLAY, rivals={MASS: ("presliding",)})
    assert [c.effect for c in found.causes] == [PLAY, MASS]
    assert [c.rivals for c in found.causes] == [(), ("presliding",)]
    assert [c.gain_percent for c in found.causes] == pytest.approx(
        [100.0 * (1.0 - 1.0 / math.sqrt(2.0)), 50.0]
    )
    assert [e.name for c in found.causes for e in c.parameters] == [f"{PLAY}.size", f"{MASS}.size"]
    assert found.verdict == "ambiguous"


def test_the_gain_has_the_interval_of_its_blocks():
    found = d._cause(judged({(): 4.0, (PLAY,): 1.0}, [PLAY]), PLAY, [])
    assert found.gain_percent == pytest.approx(50.0)
    assert found.gain_interval_percent == pytest.approx((50.0, 50.0))
    spread = {(): 4.0, (PLAY,): np.linspace(0.5, 1.5, 10)}
    uneven = d._cause(judged(spread, [PLAY]), PLAY, [])
    low, high = uneven.gain_interval_percent
    assert 40.0 < low < 49.0 < uneven.gain_percent < 51.0 < high < 60.0


def test_an_uneven_bend_and_the_noise_add_up_in_squares(monkeypatch):
    """Blocks are counted from 0 in each run; 3 and 4 make 5."""
    given = {}
    fitted = Fitted(*(np.full(1, v) for v in (7.0, 3.0, 2.0)), np.zeros(1, bool), True, "", 1)

    def with_errors(unknowns, solution, blocks, *, by_run):
        given.update(blocks=[b.tolist() for b in blocks], by_run=by_run)
        return fitted

    monkeypatch.setattr(d, "with_errors", with_errors)
    monkeypatch.setattr(d, "stderr_of_unevenness", lambda *_: np.full(1, 4.0))
    monkeypatch.setattr(
        d, "estimates_of", lambda unknowns, fit, ids: [Estimate("a", fit.stderr[0], "1", "fitted")]
    )
    folds = Folds(np.zeros(6, int), np.array([0, 0, 1, 2, 2, 4]), np.repeat([0, 1], 3), True)
    bench = SimpleNamespace(rigs=[0, 1], base=SimpleNamespace(problem=SimpleNamespace(ids=[])))
    trial = SimpleNamespace(unknowns=[], solution=None)
    (told,) = d._estimates(SimpleNamespace(folds=folds, bench=bench), trial)
    assert told.value == 5.0
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
    found = d._with_data_sheet_interval(Estimate(d.SHEATH, 1.0, "1", "fitted"), trial)
    assert found.interval_low == 0.0  # 2 · 0.5/1.25 is less than 1
    assert found.interval_high == pytest.approx(2.0 * 2.0 / 1.25 - 1.0)
    assert found.stderr == pytest.approx((2.0 * 2.0 / 1.25 - 2.0) / 1.96)


@pytest.mark.parametrize(
    ("rivals", "left", "share", "verdict"),
    [
        ([], 1.29, 1.0, "sufficient"),  # 1 + 2 · 0.15
        ([], 1.31, 1.0, "unexplained"),
        ([()], 1.0, 0.51, "unexplained"),
        ([()], 1.0, 0.5, "named"),
        ([()], 9.0, 0.49, "named"),
        ([(), ("play",)], 1.0, 0.0, "ambiguous"),
    ],
)
def test_the_verdict_on_what_is_left(rivals, left, share, verdict):
    assert verdict_of(rivals, left, share) == verdict


@pytest.mark.parametrize(
    ("left", "share", "much"),
    [
        (4.1, 0.0, True),
        (4.0, 0.0, False),
        (2.0, 0.02, False),
        (3.9, 0.019, False),
        (3.9, 0.021, True),
        (1.16, 0.021, True),
        (1.14, 0.9, False),
    ],
)
def test_what_nobody_calls_explained(left, share, much):
    assert leaves_much(left, share) == much


def test_two_digits_and_no_more():
    told = [_two_digits(v) for v in (1.0, 1.04, 9.94, 9.96, 10.4, 123.0)]
    assert told == ["1.0", "1.0", "9.9", "10", "10", "120"]


def test_a_sheath_is_as_unsure_as_the_tendons_data_sheet():
    """(1 + ratio)/EA is what is told: with EA 20 % up or down the ratio follows."""
    unknown = Unknown("tendon_stiffness_N", None, 0.0, math.log(0.8), math.log(1.2), 1.0)
    trial = SimpleNamespace(unknowns=[unknown], solution=SimpleNamespace(values=np.zeros(1)))
    ratio = Estimate("sheath_compression.compliance_ratio", 0.5, "1", "fitted", None, 0.0, 0.5, 0.5)
    found = _with_data_sheet_interval(ratio, trial)
    assert found.interval_low == pytest.approx(1.5 * 0.8 - 1.0)
    assert found.interval_high == pytest.approx(1.5 * 1.2 - 1.0)
    assert found.stderr == pytest.approx(0.3 / 1.96)
    low = _with_data_sheet_interval(Estimate("r", 0.1, "1", "fitted"), trial)
    assert low.interval_low == 0.0
    without = SimpleNamespace(unknowns=[], solution=trial.solution)
    assert _with_data_sheet_interval(ratio, without) is ratio


def found(rivals=(), unexplained=False):
    return SimpleNamespace(causes=[SimpleNamespace(rivals=rivals)], unexplained=unexplained)
