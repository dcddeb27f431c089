"""How far intervals reach, and which effects are tried."""

from types import SimpleNamespace

import pytest

from tsas_cli.identification import missing_effects as m
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model


def estimate(value, low, high, *, name="friction_coefficient", run=None, stderr=0.1):
    return Estimate(name, value, "1", "fitted", run, stderr, low, high)


OWN = estimate(10.0, 9.0, 11.5)


@pytest.mark.parametrize(
    ("others", "low", "high"),
    [
        ([(12.0, 11.0, 13.0)], 10.0, 13.0),  # from its own value, not from its own interval
        ([(8.0, 7.0, 9.0)], 7.0, 10.0),
        ([(12.0, 11.0, 13.0), (8.0, 7.5, 9.0)], 7.5, 13.0),
        ([], 10.0, 10.0),
        ([(12.0, None, None), (9.0, 8.0, 9.5)], 8.0, 10.0),
    ],
)
def test_an_interval_reaches_from_the_value_over_those_of_the_others(others, low, high):
    found = m._hull(OWN, [estimate(*other) for other in others])
    assert (found.value, found.interval_low, found.interval_high) == (10.0, low, high)
    assert found.stderr == pytest.approx(max(high - 10.0, 10.0 - low) / 1.96)


def test_what_has_no_interval_or_error_gets_none():
    for own in (estimate(10.0, None, 11.0), estimate(10.0, 9.0, None)):
        assert m._hull(own, [estimate(12.0, 11.0, 13.0)]) is own
    free = m._hull(estimate(10.0, 9.0, 11.0, stderr=None), [estimate(12.0, 11.0, 13.0)])
    assert (free.stderr, free.interval_high) == (None, 13.0)


def trial(name, mean_square, value=None, converged=True):
    solution = SimpleNamespace(converged=converged)
    return SimpleNamespace(effects=(name,), mean_square=mean_square, value=value, solution=solution)


TOLD = [OWN, estimate(5.0, 4.0, 6.0, name="preload_N", run="a")]


@pytest.fixture
def widened(monkeypatch):
    """Widen estimates by trials whose estimates are one wide about a value."""

    def with_trials(*trials):
        monkeypatch.setattr(m, "bench_of", lambda fit: fit)
        monkeypatch.setattr(m, "_best_trials", lambda bench, step: list(trials))
        monkeypatch.setattr(
            m, "_estimates", lambda bench, t: [estimate(t.value, t.value - 1.0, t.value + 1.0)]
        )
        return m.widened(SimpleNamespace(model=Model(tuple(TOLD))))

    return with_trials


def ends(found):
    return [(e.interval_low, e.interval_high) for e in found.estimates]


def test_without_an_effect_that_helps_intervals_stay(widened):
    found = widened()
    assert found.estimates == tuple(TOLD)
    assert found.effects == ()


@pytest.mark.parametrize(
    ("mean_squares", "near"),
    [
        ((1.5, 1.99, 2.01), "ab"),  # an excess of 0.5: up to twice that counts
        ((1.99, 2.01, 1.5), "ac"),
        ((1.1, 1.19, 1.21), "ab"),
        ((0.9, 0.99, 1.01), "ab"),  # no excess: nothing beyond the noise counts
        ((1.0, 1.0, 1.5), "ab"),
    ],
)
def test_effects_with_twice_the_excess_of_the_best_count(widened, mean_squares, near):
    values = (12.0, 7.0, 3.0)
    trials = [trial(n, s, v) for n, s, v in zip("abc", mean_squares, values, strict=True)]
    found = widened(*trials)
    assert "".join(found.effects) == near
    ((low, high), other) = ends(found)
    counted = [t.value for t in trials if t.effects[0] in near]
    assert (low, high) == (min(10.0, min(counted) - 1.0), max(10.0, max(counted) + 1.0))
    assert other == (5.0, 5.0)  # no fit tells it


@pytest.mark.parametrize(("mean_square", "own_too"), [(1.99, False), (2.01, True), (2.0, False)])
def test_where_no_effect_explains_it_the_nominal_interval_counts_too(widened, mean_square, own_too):
    found = widened(trial("a", mean_square, 20.0))
    low = 9.0 if own_too else 10.0
    assert ends(found) == [(low, 21.0), (4.0, 6.0) if own_too else (5.0, 5.0)]
