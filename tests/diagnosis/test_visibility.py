"""From which size on: held against the evidence that a diagnosis asks for, on drawn noise."""

import math

import numpy as np
import pytest

from tsas_cli.diagnosis.amplitudes import Amplitude, Visibility, amplitudes_of, causes_of
from tsas_cli.diagnosis.evidence import LEAST_REDUCTION, gain
from tsas_cli.diagnosis.visibility import TINY, LinearisedRuns, Part
from tsas_cli.effects import EFFECTS
from tsas_cli.effects.effect import Effect, Parameter
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.numerics.least_squares import Solution

BLOCKS, EACH = 40, 200


def part(blocks=BLOCKS, each=EACH):
    """Return a look at residuals in even blocks, with nothing free."""
    block = np.repeat(np.arange(blocks), each)
    return Part(None, np.ones(block.size, dtype=bool), block, np.zeros((block.size, 0)))


def test_what_is_everywhere_has_to_take_the_telling_part_of_the_squares():
    """Many blocks: squares s² d² n beside n of noise; their part is LEAST_REDUCTION."""
    found = part(blocks=400).smallest(np.full(400 * EACH, 0.5))
    assert found == pytest.approx(
        math.sqrt(LEAST_REDUCTION / (1.0 - LEAST_REDUCTION)) / 0.5, rel=1e-6
    )


def test_what_shows_in_few_blocks_is_never_sure():
    """Six gains of one sign are √6 = 2.45 standard deviations; 2.6 are asked for."""
    signature = np.zeros(BLOCKS * EACH)
    signature[: 6 * EACH] = 1.0
    assert part().smallest(signature) == math.inf
    signature[: 7 * EACH] = 1.0
    assert math.isfinite(part().smallest(signature))


def test_nothing_is_never_found():
    assert part().smallest(np.zeros(BLOCKS * EACH)) == math.inf


@pytest.mark.parametrize("width", [8, 15, 40])
def test_at_this_size_about_every_second_diagnosis_is_convinced(width):
    rng = np.random.default_rng(3)
    signature = np.sin(np.arange(BLOCKS * EACH) / 7.0)
    signature[width * EACH :] = 0.0
    found = part().smallest(signature)

    def convinced(size):
        return np.mean([_convincing(size * signature, rng) for _ in range(200)])

    assert 0.2 < convinced(found) < 0.85
    assert convinced(0.5 * found) < 0.1
    assert convinced(2.0 * found) > 0.9


def _convincing(signal, rng):
    noise = rng.standard_normal(signal.size)
    squares = [np.sum(r.reshape(BLOCKS, EACH) ** 2, axis=1) for r in (noise + signal, noise)]
    return gain(*squares).convincing


STILL = HypothesisFit(
    (),
    (),
    Solution(
        np.zeros(0),
        np.zeros(0, bool),
        np.zeros(BLOCKS * EACH),
        np.zeros((BLOCKS * EACH, 0)),
        converged=True,
        message="nothing is free",
        evaluations=1,
    ),
    (BLOCKS * EACH,),
    on_mesh=True,
)


class Answers:
    """A bench whose residuals with a cause are given."""

    def __init__(self, with_it):
        self.with_it = with_it

    def errors_at(self, trial, changes):
        del trial
        size = next(iter(changes.values()))
        return self.with_it(size)


def looked_at(with_it):
    whole = part()
    look = LinearisedRuns(Answers(with_it), STILL, None, whole.block)
    return Part(look, whole.rows, whole.block, whole.basis)


PRESLIDING = next(effect for effect in EFFECTS if effect.name == "presliding")


def test_a_model_that_jumps_however_small_the_cause_is_looked_at_at_a_finite_size():
    jumping = looked_at(lambda size: np.full(BLOCKS * EACH, 1.0 + 0.0 * size))
    (cause,) = amplitudes_of(PRESLIDING)
    assert np.isfinite(jumping.own(cause)).all()
    assert 0.5 * TINY * cause.start < jumping.sizes[cause.name] < TINY * cause.start


def test_what_the_model_does_not_get_through_with_is_not_found():
    lost = looked_at(lambda size: np.full(BLOCKS * EACH, math.nan * size))
    (seen,) = lost.seen([PRESLIDING], [PRESLIDING])
    assert seen.found == math.inf
    other = next(effect for effect in EFFECTS if effect.name == "backlash")
    (seen,) = lost.seen([PRESLIDING], [other])
    assert (seen.found, seen.distinct) == (math.inf, {"backlash": math.inf})


def test_every_amplitude_of_every_effect_is_looked_at():
    for effect in EFFECTS:
        names = {cause.parameter.name for cause in causes_of(effect)}
        assert names == {p.name for p in effect.parameters if not p.shape}
        for cause in causes_of(effect):
            assert set(cause.shape) == {
                f"{effect.name}.{p.name}" for p in effect.parameters if p.shape
            }


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
