"""Which effects that fail their proof are said to stand in for something."""

from dataclasses import dataclass
from types import SimpleNamespace

import pytest

from tsas_cli.diagnosis import proven as p
from tsas_cli.diagnosis.proof import FoundCause
from tsas_cli.support.steps import NO_PROGRESS


@dataclass(frozen=True)
class Search:
    """The effects of a search, with their rivals."""

    named: frozenset[str]
    rivals: dict[str, tuple[str, ...]]


@pytest.mark.parametrize(("negligible", "stand_ins"), [(True, []), (False, ["backlash"])])
def test_an_effect_that_is_negligible_stands_in_for_nothing(monkeypatch, negligible, stand_ins):
    """It is left out all the same, and the others are judged without it."""
    fails = FoundCause("backlash", (), (), 1.0, (0.0, 2.0), ("fails",), negligible=negligible)
    holds = FoundCause("preload_loss", (), (), 9.0, (8.0, 10.0))

    def judged(search, fits, found):
        causes = [cause for cause in (fails, holds) if cause.effect in search.named]
        return p.Proven(search, fits, tuple(causes), found, (), {}, SimpleNamespace())

    monkeypatch.setattr(p, "_judged", judged)
    monkeypatch.setattr(p, "reweighted_hypotheses", lambda search, step: search)
    names = ("backlash", "preload_loss")
    found = p.proven_effects(Search(frozenset(names), dict.fromkeys(names, ())), NO_PROGRESS)
    assert [cause.effect for cause in found.causes] == ["preload_loss"]
    assert [cause.effect for cause in found.stand_ins] == stand_ins
