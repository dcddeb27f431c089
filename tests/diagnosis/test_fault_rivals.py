"""Which of several faults is said, and what leaves no more than noise."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from tests.diagnosis.test_fault_laws import NOISE, RUN, TOLERATED, F, search_of, trial_of
from tsas_cli.diagnosis.faults import search as s
from tsas_cli.diagnosis.faults.beside import Candidate, beside
from tsas_cli.diagnosis.faults.rivals import leaves_noise


def judged(monkeypatch, found, *, squares=200.0):
    """Return what is said of faults with given reductions, of 100 residuals."""
    search = search_of(np.zeros(RUN.size), np.zeros(100, int))
    monkeypatch.setattr(s, "beside", lambda *_: SimpleNamespace(squares=squares))
    monkeypatch.setattr(s, "runs_at", lambda *_: [None])
    monkeypatch.setattr(s, "candidates", lambda *_: found)
    monkeypatch.setattr(s, "_closer", lambda found, *_: found)
    monkeypatch.setattr(s, "of_frictions", lambda *_: iter(()))
    return s.fault_of_recording(search, ())


def fault(reduction, run=None, code="hum", channels=(F,), edges=1):
    return Candidate(code, run, channels, 1.0, reduction, edges)


def test_the_simplest_is_said_and_rivals_as_good_elsewhere_with_no_more_ends(monkeypatch):
    def runs(*found):
        return [c.run for c in judged(monkeypatch, list(found)).found]

    best = fault(100.0, 0, edges=1)
    assert runs(best, fault(90.1, 1), fault(89.9, 2)) == [0, 1]
    assert runs(best, fault(99.0, 1), fault(98.0, 2), fault(97.0, 3)) == [0, 1, 2]
    assert runs(best, fault(99.0, 0, "clock"), fault(98.0, 1), fault(97.0, 1, "clock")) == [0, 1]
    assert runs(best, fault(96.0, 1, edges=2), fault(95.0, 2, edges=1)) == [0, 2]
    assert runs(best, fault(99.0, 1, "channel_delay"), fault(98.0, 2)) == [0, 2]
    two = fault(100.0, 0, edges=2), fault(99.0, 1, edges=2)
    assert runs(*two, fault(96.9, 2)) == [0, 1, 2]
    assert runs(*two, fault(97.1, 2)) == [2]  # with fewer ends as good
    since = replace(fault(98.0, 1), first_s=5.0)
    assert runs(best, since) == [1, 0]  # as good as until then
    assert runs(best, replace(since, reduction=96.9)) == [0, 1]


@pytest.mark.parametrize(("share", "noise"), [(1.14, True), (1.16, False)])
def test_what_leaves_no_more_than_a_complete_model_may_leaves_noise(share, noise):
    """15 % more than one for each residual, beside what is free and tolerated."""
    plain = beside(trial_of(NOISE), TOLERATED, RUN).squares
    search = search_of(NOISE * np.sqrt(share * RUN.size / plain))
    for names in (frozenset(), frozenset({"backlash"})):
        left = leaves_noise(search, names, SimpleNamespace(found=(fault(1.0),), usual=RUN.size))
        assert left == noise
