"""Which effects that fail their proof are said to stand in for something."""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import pytest

from tsas_cli.diagnosis import proven as p
from tsas_cli.diagnosis.proof import FoundCause
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
        return p.Proven(search, fits, tuple(causes), found, (), {}, after)

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
