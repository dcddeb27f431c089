"""Sizes and shapes of the causes that are looked for, and what hides a cause."""

import math

import pytest

from tsas_cli.diagnosis.amplitudes import Amplitude, Visibility, amplitudes_of, causes_of
from tsas_cli.effects.effect import Effect, Parameter


def amplitude(name="size", neutral=0.0, start=0.5, lower=0.0, upper=9.0):
    return Parameter(name, "mm", neutral, start, lower, upper)


def shape(name, *starts, start=7.0):
    return Parameter(name, "1", 0.0, start, 0.0, 9.0, shape=True, starts=starts)


def effect(name, *parameters):
    return Effect(name, name, "drive", True, "", "", parameters or (amplitude(),), "")


def cause(parameter, name="play"):
    return Amplitude(effect(name, parameter), parameter, {})


@pytest.mark.parametrize(
    ("parameter", "start", "one_sided", "largest"),
    [
        (amplitude(), 0.5, True, 9.0),
        (amplitude(start=0.05), 0.05, True, 5.0),  # a hundred times the start
        (amplitude(neutral=1.0, start=1.02, lower=0.5, upper=1.7), 0.02, False, 0.7),
        (amplitude(neutral=1.0, start=0.9, lower=0.2, upper=1.7), -0.1, False, 0.8),
        (amplitude(neutral=1.0, start=0.996, lower=0.0, upper=1.0), -0.004, True, 0.4),
    ],
)
def test_sizes_are_less_the_neutral_value(parameter, start, one_sided, largest):
    found = cause(parameter)
    assert found.start == pytest.approx(start)
    assert found.one_sided == one_sided
    assert found.largest == pytest.approx(largest)
    assert found.name == "play.size"


@pytest.mark.parametrize(
    ("told", "named", "hidden", "nearest"),
    [
        ({}, 2.0, [], None),
        ({"a": 2.0, "b": 1.0}, 2.0, [], None),
        ({"a": 2.5, "b": 3.0}, 3.0, [], "b"),
        ({"a": 20.0}, 20.0, [], "a"),
        ({"a": 3.0, "b": 20.1}, 20.1, ["b"], "b"),
        ({"a": math.inf, "b": 1.0}, math.inf, ["a"], "a"),
    ],
)
def test_what_hides_where(told, named, hidden, nearest):
    """Ten times the size found tells them apart, or nothing does."""
    found = Visibility(cause(amplitude()), 2.0, told)
    assert (found.named, found.hidden_in, found.nearest) == (named, hidden, nearest)
    assert found.counted == (math.inf if hidden else named)


def test_few_shapes_are_all_looked_at_of_many_the_start():
    four = effect("e", amplitude(), shape("a", 1.0, 2.0, 3.0, 4.0))
    assert [c.shape for c in causes_of(four)] == [{"e.a": x} for x in (1.0, 2.0, 3.0, 4.0)]
    for many in (
        effect("e", amplitude(), shape("a", *range(5))),
        effect("e", amplitude(), shape("a")),
    ):
        assert [c.shape for c in causes_of(many)] == [{"e.a": 7.0}]
    two = effect("e", shape("a", 1.0, 2.0), amplitude("x"), amplitude("y"), shape("b", 3.0, 4.0))
    found = [(c.parameter.name, *c.shape.values()) for c in causes_of(two)]
    assert len(found) == len(set(found)) == 8
    assert found[0] == ("x", 1.0, 3.0)
    assert [c.name for c in amplitudes_of(two)] == ["e.x", "e.y"]
    assert {tuple(c.shape.items()) for c in amplitudes_of(two)} == {(("e.a", 1.0), ("e.b", 3.0))}
