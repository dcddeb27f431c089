"""Which effects that fail their proof are said to stand in for something."""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.diagnosis import proven as p
from tsas_cli.diagnosis.constancy import Split
from tsas_cli.diagnosis.evidence import Reduction
from tsas_cli.diagnosis.proof import FoundCause
from tsas_cli.diagnosis.remainder import Remainder
from tsas_cli.identification.estimate import Estimate
from tsas_cli.support.steps import NO_PROGRESS


@dataclass(frozen=True)
class Search:
    """The effects of a search, with their rivals."""

    named: frozenset[str]
    rivals: dict[str, tuple[str, ...]]


ZERO = Estimate("backlash.play_mm", 0.01, "mm", "fitted", None, 0.01, 0.0, 0.03, False)
CLEAR = replace(ZERO, value=0.1, interval_low=0.08, interval_high=0.12)


@pytest.mark.parametrize(
    ("negligible", "convincing", "complete", "play", "stand_ins"),
    [
        (True, True, False, CLEAR, []),
        (False, True, False, CLEAR, ["backlash"]),
        (False, True, False, ZERO, ["backlash"]),
        (False, False, False, CLEAR, ["backlash"]),
        (False, True, True, CLEAR, ["backlash"]),
        (False, True, True, ZERO, []),  # nothing is left without it
        (False, False, True, CLEAR, []),
    ],
)
def test_an_effect_that_is_negligible_stands_in_for_nothing(
    monkeypatch, negligible, convincing, complete, play, stand_ins
):
    """It is left out all the same, and the others are judged without it."""
    fails = FoundCause(
        *("backlash", (), (play,), 1.0, (0.0, 2.0), ("fails",)),
        convincing=convincing,
        negligible=negligible,
    )
    holds = FoundCause("preload_loss", (), (), 9.0, (8.0, 10.0))

    def judged(search, fits, found):
        causes = [cause for cause in (fails, holds) if cause.effect in search.named]
        after = SimpleNamespace(complete=complete)
        return p.Proven(search, fits, tuple(causes), found, (), {}, after, after)

    monkeypatch.setattr(p, "_judged", judged)
    monkeypatch.setattr(p, "reweighted_hypotheses", lambda search, step: search)
    names = ("backlash", "preload_loss")
    found = p.proven_effects(Search(frozenset(names), dict.fromkeys(names, ())), NO_PROGRESS)
    assert [cause.effect for cause in found.causes] == ["preload_loss"]
    assert [cause.effect for cause in found.stand_ins] == stand_ins


@pytest.mark.parametrize(
    ("first", "second", "law", "refused"),
    [
        ("load_spring_nonlinearity", "load_ripple", "over the tension", True),
        ("load_spring_nonlinearity", "load_ripple", "", False),
        ("load_spring_nonlinearity", "drive_ripple", "over the tension", False),
        ("stribeck_friction", "sheath_compression", "over the speed", False),
        ("force_sensor_curvature", "force_sensor_tilt", "over the tension", True),
        ("force_sensor_curvature", "position_sensor_ripple", "over the tension", False),
    ],
)
def test_what_a_law_of_one_place_lacks_is_no_second_cause(first, second, law, refused):
    """Of two at one place the one that gains less is refused, where the other's law differs."""
    more = FoundCause(first, (), (), 60.0, (50.0, 70.0), law_differs=law)
    less = FoundCause(second, (), (), 40.0, (30.0, 50.0), law_differs=law)
    both = more, less
    assert p._beside_another_law(more, both) == more
    failed = p._beside_another_law(less, both).failed
    assert bool(failed) == refused
    assert not failed or "nonlinear load spring" in failed[0] or "curved scale" in failed[0]


EVEN, ODD = np.full(20, 10.0), 10.0 + 0.1 * (-1.0) ** np.arange(20)
FEW = np.array([1.0, *np.full(19, 10.01)])  # one block of twenty gains


@pytest.mark.parametrize(
    ("after", "told", "failed", "law", "negligible"),
    [
        (0.1 * EVEN, {}, (), "", False),
        (0.1 * EVEN, {"zero": True}, (), "", False),
        (ODD, {}, (), "", True),  # less than a fortieth, and by chance
        (FEW, {}, (), "", False),
        (FEW, {"zero": True}, (), "", True),
        # A law differs where a twentieth is left of the 100 that 200 squares are beyond the noise.
        (0.1 * EVEN, {"split": "s", "structure": 4.9}, (), "over s", False),
        (0.1 * EVEN, {"split": "s", "structure": 5.1}, ("is not constant over s",), "", False),
        (0.1 * EVEN, {"split": "s", "apart": True}, ("is not constant over s",), "", False),
        (0.1 * EVEN, {"structure": 9.0}, (), "", False),
        (0.1 * EVEN, {"tolerance": True}, ("is no more than a tolerance",), "", True),
        (0.1 * EVEN, {"scatter": True}, ("is no more than a friction",), "", True),
    ],
)
def test_what_an_effect_proves(monkeypatch, after, told, failed, law, negligible):
    told = {"split": None, "structure": 0.0, "zero": False} | told
    given = {}

    def failures(name, own, again, fewer, whole, **more):
        given.update(more, own=[e.name for e in own])
        return ()

    def may_be_zero(name, moved, correlation):
        given.update(moved=[e.value for e in moved], correlation=correlation.tolist())
        return told["zero"]

    def within_tolerances(trial, name, tolerated, reduction):
        given.update(reduction=reduction)
        return "tolerance" in told

    for function in (failures, may_be_zero, within_tolerances):
        monkeypatch.setattr(p, function.__name__, function)
    monkeypatch.setattr(p, "worst_split", lambda *_: told["split"])
    monkeypatch.setattr(p, "split_in_words", lambda split: f"over {split}")
    monkeypatch.setattr(p, "of_one_size", lambda split: "apart" not in told)
    monkeypatch.setattr(p, "_within_interval", lambda split, own: False)
    monkeypatch.setattr(p, "within_scatter", lambda *_: "scatter" in told)
    monkeypatch.setattr(p, "_of_another_law", lambda *_: ())
    monkeypatch.setattr(p, "largest_forces", lambda bench: {"f_in_N": 40.0})
    folds = SimpleNamespace(block=np.zeros(100, int), run=None)
    judged = SimpleNamespace(
        named=frozenset({"backlash", "preload_loss"}),
        rivals={"backlash": ("free_tendon",)},
        bench=SimpleNamespace(closed=()),
        folds=folds,
        trial=lambda names: None,
    )
    estimates = [replace(ZERO, name=n) for n in ("preload_loss.x", "backlash.play_mm", "slack_mm")]
    moved = [replace(e, value=k) for k, e in enumerate(estimates)]
    found = SimpleNamespace(estimates=estimates, moved=moved, correlation=np.diag((1.0, 2.0, 3.0)))
    squares = {judged.named: after, frozenset({"preload_loss"}): EVEN}
    held_out = {names: SimpleNamespace(squares=s) for names, s in squares.items()}
    signals = {"x_in_mm": np.array([-3.0, 5.0])}
    last = p._LastFit(judged, found, held_out, signals, told["structure"], None)
    cause = p._cause(last, "backlash")
    assert (cause.effect, cause.rivals, cause.law_differs) == ("backlash", ("free_tendon",), law)
    assert len(cause.failed) == len(failed)
    assert all(said.startswith(start) for said, start in zip(cause.failed, failed, strict=True))
    assert cause.negligible == negligible
    assert cause.gain_percent == pytest.approx(100.0 - 100.0 * np.sqrt(after.sum() / 200.0))
    low, high = cause.gain_interval_percent
    assert low <= cause.gain_percent + 1e-9
    assert cause.gain_percent <= high + 1e-9
    assert given == {
        "own": ["backlash.play_mm"],
        "moved": [1],
        "correlation": [[2.0]],
        "tolerance_N": {"f_in_N": pytest.approx(0.1)},
        "stroke_mm": 8.0,
        "zero": told["zero"],
        "reduction": pytest.approx(200.0 - after.sum()),
    }


@pytest.mark.parametrize(
    ("first", "last", "reducible", "structure", "refused"),
    [
        (401.0, 40.0, 39.0, 1.0, False),  # a tenth of 400, less a little
        (401.0, 42.0, 41.0, 1.0, True),
        (401.0, 1.0, 0.0, 1.0, False),
        (401.0, 42.0, 41.0, 0.0, False),
    ],
)
def test_where_much_is_left_no_effect_is_proven(first, last, reducible, structure, refused):
    """A lost motion at the drive passes for a gain of x_out that takes half of it."""
    start = Remainder(first, {"x_out_mm": 1.0}, ())
    after = Remainder(last, {"x_out_mm": structure}, (), reducible=reducible)
    cause = FoundCause("position_sensor_gain", (), (), 50.0, (40.0, 60.0))
    failed = p._beside_what_is_left(cause, start, after).failed
    assert failed == (("leaves 10 % of what could be explained",) if refused else ())


@pytest.mark.parametrize(("values", "within"), [((0.09, 0.11), True), ((0.09, 0.13), False)])
def test_parts_within_the_interval_of_the_whole_do_not_differ(values, within):
    parts = tuple(zip(("low", "high"), values, strict=True))
    split = Split("backlash.play_mm", "speed", Reduction(0.1, 3.0), parts)
    assert p._within_interval(split, [CLEAR]) == within
