"""From which size on a signature shows, and from which others it is told."""

import math

import numpy as np
import pytest

from tests.diagnosis.test_visibility import amplitude, cause, effect
from tsas_cli.diagnosis.visibility import Imitation, Part

BLOCKS, EACH = 20, 10
SIZE = BLOCKS * EACH


def part(block=None, basis=None, look=None):
    block = np.repeat(np.arange(BLOCKS), EACH) if block is None else block
    basis = np.zeros((block.size, 0)) if basis is None else basis
    return Part(look, np.ones(block.size, dtype=bool), block, basis)


def smallest_by_definition(signature, block):
    """Try sizes one by one, 10^(1/100) apart, from the one that takes a fortieth of the squares."""
    E, n = [], []
    for b in sorted(set(block)):
        E.append(sum(float(y) ** 2 for y in signature[block == b]))
        n.append(int(sum(block == b)))
    first = math.sqrt(0.025 / 0.975 * sum(n) / sum(E))
    for k in range(301):
        s = first * 10.0 ** (k / 100.0)
        gains = [math.log(1.0 + s * s * e / m) for e, m in zip(E, n, strict=True)]
        noise = [2.0 * s * math.sqrt(e) / (m + s * s * e) for e, m in zip(E, n, strict=True)]
        whole = sum(g * g + d * d for g, d in zip(gains, noise, strict=True))
        if sum(gains) > 2.6 * math.sqrt(whole):
            return s
    return math.inf


@pytest.mark.parametrize("blocks", [7, 8, 9, 12, 20, 60])
@pytest.mark.parametrize("each", [3, 40])
def test_a_size_is_found_by_the_definition(blocks, each):
    """Gains log(1 + s² E/n), which noise scatters by 2 s √E/(n + s² E)."""
    block = np.repeat(np.arange(blocks), each)
    ramp = 0.3 + block / blocks + np.arange(block.size) % 3
    found = part(block).smallest(ramp)
    assert found == pytest.approx(smallest_by_definition(ramp, block), rel=1e-9)


def test_what_cannot_be_done_by_what_is_free():
    """Nothing negative: the second column has to be taken away, which is not done."""
    imitation = Imitation(np.eye(4)[:, :3], np.array([[2.0, 0.0], [0.0, 0.25], [0.0, 0.0]]))
    left = imitation.left(np.array([3.0, -1.0, 5.0, 7.0]))
    np.testing.assert_allclose(left, [0.0, -1.0, 5.0, 7.0], atol=1e-12)


class MadeUpLook:
    """Signatures that are given by name, each for a unit of size; some depend on the size."""

    def __init__(self, **signatures):
        self.signatures, self.asked = signatures, []

    def signature(self, cause, size):
        self.asked.append((cause.name, size))
        given = self.signatures[cause.effect.name]
        return given(size) if callable(given) else given


def wave(k, scale=1.0):
    return scale * np.sin(2.0 * math.pi * k * np.arange(SIZE) / EACH)


def test_what_free_parameters_do_is_taken_out():
    free = np.linalg.qr(wave(1)[:, None])[0]
    look = MadeUpLook(e=wave(1, 5.0) + wave(2, 3.0))
    found = part(basis=free, look=look)
    one = cause(amplitude(upper=1e9), "e")
    np.testing.assert_allclose(found.own(one), wave(2, 3.0), atol=1e-9)
    np.testing.assert_allclose(found.tiny(one), wave(2, 3.0), atol=1e-9)
    assert look.asked[-1] == ("e.size", 0.5e-6)
    assert found.blocks == BLOCKS


@pytest.mark.parametrize(("own", "shows"), [(0.031, False), (0.033, True)])
def test_it_shows_from_a_thousandth_of_the_squares_on(own, shows):
    """Waves of 1 and of 2 periods per block are orthogonal and of one size."""
    free = np.linalg.qr(wave(1)[:, None])[0]
    look = MadeUpLook(e=wave(1) + wave(2, own))
    assert part(basis=free, look=look).shows(cause(amplitude(), "e")) == shows


def seen(look, first, *rivals):
    found = part(look=look)
    (told,) = found.seen([first], [first, *rivals])
    return told


def wide(name, **other):
    return effect(name, amplitude(**{"upper": 1e9, "lower": 0.0} | other))


def test_an_effect_is_told_from_what_does_something_else():
    look = MadeUpLook(a=wave(1), b=wave(2), c=wave(1) + wave(2))
    told = seen(look, wide("a"), wide("b"), wide("c"))
    assert set(told.distinct) == {"b", "c"}
    assert told.found == pytest.approx(smallest_by_definition(wave(1), part().block))
    assert told.distinct["b"] == pytest.approx(told.found)
    half = 0.5 * (wave(1) - wave(2))  # what is left of a beside the best of c
    assert told.distinct["c"] == pytest.approx(smallest_by_definition(half, part().block))


def test_one_that_acts_in_one_direction_does_not_hide_the_other():
    """A rival that is its opposite hides what may act in both directions, nothing else."""
    look = MadeUpLook(a=wave(1), b=-wave(1))
    assert seen(look, wide("a"), wide("b")).distinct["b"] < math.inf
    assert seen(look, wide("a", lower=-1e9), wide("b")).distinct["b"] == math.inf
    assert seen(look, wide("a"), wide("b", lower=-1e9)).distinct["b"] == math.inf
    # Starting below the neutral value, it acts in the other direction.
    below = wide("b", start=-0.5, lower=-1e9, upper=0.0)
    assert seen(look, wide("a"), below).distinct["b"] == math.inf


def test_what_nearly_imitates_it_hides_it():
    """A thousandth of the squares is too little to tell."""
    for off, hidden in ((0.031, True), (0.033, False)):
        look = MadeUpLook(a=wave(1) + wave(2, off), b=wave(1))
        assert (seen(look, wide("a"), wide("b")).distinct["b"] == math.inf) == hidden


def test_what_is_imitated_while_it_is_small_is_hidden_though_it_is_not_when_it_is_large():
    look = MadeUpLook(a=lambda size: wave(1) if abs(size) < 1e-4 else wave(2), b=wave(1))
    assert seen(look, wide("a"), wide("b")).distinct["b"] == math.inf


def test_no_size_is_larger_than_the_largest():
    found = smallest_by_definition(wave(1), part().block)
    for upper, limited in ((1.01 * found, False), (0.99 * found, True)):
        told = seen(MadeUpLook(a=wave(1), b=wave(2)), wide("a", upper=upper), wide("b"))
        assert (told.found == math.inf) == limited
        assert (told.distinct["b"] == math.inf) == limited
