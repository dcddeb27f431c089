"""Which effects are proven, and what gives way to what; the fits are made up."""

from dataclasses import dataclass, field, replace
from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.diagnosis import proven as p
from tsas_cli.diagnosis.constancy import Split
from tsas_cli.diagnosis.evidence import Reduction
from tsas_cli.diagnosis.held_out import Folds
from tsas_cli.diagnosis.intervals import estimates_with_tolerances
from tsas_cli.diagnosis.proof import FoundCause, may_be_zero
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit_problem import unknown_of
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.numerics.least_squares import Solution
from tsas_cli.support.steps import NO_PROGRESS


@dataclass(frozen=True)
class Search:
    """The effects of a search, with their rivals."""

    named: frozenset[str]
    rivals: dict[str, tuple[str, ...]]
    squares: dict[tuple[frozenset[str], bool], np.ndarray] = field(default_factory=dict)


ZERO = Estimate("backlash.play_mm", 0.01, "mm", "fitted", None, 0.01, 0.0, 0.03, False)
CLEAR_PLAY = replace(ZERO, value=0.1, interval_low=0.08, interval_high=0.12)


@pytest.mark.parametrize(
    ("negligible", "convincing", "complete", "play", "stand_ins"),
    [
        (True, True, False, CLEAR_PLAY, []),
        (False, True, False, CLEAR_PLAY, ["backlash"]),
        (False, True, False, ZERO, ["backlash"]),
        (False, False, False, CLEAR_PLAY, ["backlash"]),
        (False, True, True, CLEAR_PLAY, ["backlash"]),
        (False, True, True, ZERO, []),  # nothing is left without it
        (False, False, True, CLEAR_PLAY, []),
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
        return p.Proven(search, fits, tuple(causes), found, (), {}, after, after, None)

    monkeypatch.setattr(p, "_judged", judged)
    monkeypatch.setattr(p, "reweighted_hypotheses", lambda search, step: search)
    names = ("backlash", "preload_loss")
    found = p.proven_effects(Search(frozenset(names), dict.fromkeys(names, ())), NO_PROGRESS)
    assert [cause.effect for cause in found.causes] == ["preload_loss"]
    assert [cause.effect for cause in found.stand_ins] == stand_ins


@pytest.mark.parametrize(
    ("proven", "law", "complete", "left", "named", "rivals"),
    [
        ({"load_ripple"}, "", True, 2.0, "load_ripple", ("free_tendon", "friction_drift")),
        ({"free_tendon"}, "", True, 2.0, "free_tendon", ("load_ripple", "friction_drift")),
        ({"friction_drift"}, "", True, 2.0, None, ()),  # fits worse than the first two
        ({"load_ripple"}, "", False, 2.0, None, ()),  # no less is left than by the one that fails
        ({"load_ripple"}, "", False, 1.9, "load_ripple", ("free_tendon", "friction_drift")),
        ({"load_ripple"}, "over the speed", True, 1.9, None, ()),
    ],
)
def test_an_effect_that_fails_gives_way_to_a_rival_that_is_proven(
    monkeypatch, proven, law, complete, left, named, rivals
):
    def judged(search, fits, found):
        causes = [
            FoundCause(
                *(name, search.rivals[name], (CLEAR_PLAY,), 9.0, (8.0, 10.0)),
                failed=() if name in proven | {"preload_loss"} else ("fails",),
                law_differs=law if name in proven else "",
            )
            for name in search.rivals
        ]
        mean_square = 2.0 if "backlash" in search.named else left
        after = SimpleNamespace(complete=complete, mean_square=mean_square)
        return p.Proven(search, fits, tuple(causes), found, (), {}, after, after, None)

    monkeypatch.setattr(p, "_judged", judged)
    monkeypatch.setattr(p, "reweighted_hypotheses", lambda search, step: search)
    others = ("load_ripple", "free_tendon", "friction_drift")
    search = Search(
        frozenset(("backlash", "preload_loss")), {"backlash": others, "preload_loss": ()}
    )
    found = p.proven_effects(search, NO_PROGRESS)
    of = {cause.effect: cause.rivals for cause in found.causes}
    assert of == {"preload_loss": ()} | ({named: rivals} if named else {})
    assert [cause.effect for cause in found.stand_ins] == ([] if named else ["backlash"])


@pytest.mark.parametrize(("values", "within"), [((0.09, 0.11), True), ((0.09, 0.13), False)])
def test_parts_within_the_interval_of_the_whole_do_not_differ(values, within):
    parts = tuple(zip(("low", "high"), values, strict=True))
    split = Split("backlash.play_mm", "speed", Reduction(0.1, 3.0), parts)
    assert p._within_interval(split, [CLEAR_PLAY]) == within


def test_an_effects_shape_is_held_where_it_may_be_zero():
    """Three runs tell the size well at each shape, and hardly its time: they scatter along both."""
    rng, rows = np.random.default_rng(4), 60
    wave, other = np.linalg.qr(rng.standard_normal((rows, 2)))[0].T
    jacobian = np.tile(np.column_stack((30.0 * wave, 3.0 * wave + 3.0 * other)), (3, 1))
    noise = 0.1 * rng.standard_normal(3 * rows)
    residual = noise + np.concatenate([error * other for error in (4.0, -4.0, 0.5)])
    names = ("load_relaxation.share", "load_relaxation.time_s")
    values = np.array(
        [QUANTITIES[name].scaled(value) for name, value in zip(names, (0.02, 2.0), strict=True)]
    )
    unknowns = tuple(unknown_of(name) for name in names)
    solution = Solution(values, np.zeros(2, bool), residual, jacobian, True, "", 1)
    trial = HypothesisFit(("load_relaxation",), unknowns, solution, (rows,) * 3, on_mesh=True)
    block = np.repeat(np.arange(18), 10)
    run = np.repeat(np.arange(3), rows)
    bench = SimpleNamespace(
        rigs=[None] * 3, base=SimpleNamespace(problem=SimpleNamespace(ids=["a", "b", "c"]))
    )
    judged = SimpleNamespace(
        bench=bench,
        folds=Folds(run, block, run, by_run=True),
        named=frozenset({"load_relaxation"}),
        trial=lambda _: trial,
    )
    tolerated = np.zeros((3 * rows, 8))
    found = estimates_with_tolerances(judged, trial, tolerated)
    assert may_be_zero("load_relaxation", found.moved, found.correlation)
    last = SimpleNamespace(judged=judged, found=found, tolerated=tolerated)
    assert not p._may_be_zero(last, "load_relaxation")
