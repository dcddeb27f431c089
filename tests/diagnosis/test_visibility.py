"""From which size on: held against the evidence that a diagnosis asks for, on drawn noise."""

import math

import numpy as np
import pytest

from tsas_cli.diagnosis.amplitudes import amplitudes_of, causes_of
from tsas_cli.diagnosis.evidence import LEAST_REDUCTION, gain
from tsas_cli.diagnosis.visibility import TINY, LinearisedRuns, Part
from tsas_cli.effects import EFFECTS

BLOCKS, EACH = 40, 200


def part(blocks=BLOCKS, each=EACH):
    """Return a look at residuals in even blocks, with nothing free."""
    block = np.repeat(np.arange(blocks), each)
    return Part(None, np.ones(block.size, dtype=bool), block, np.zeros((block.size, 0)))


def test_what_is_everywhere_has_to_take_the_telling_part_of_the_squares():
    """Many blocks: squares s² d² n beside n of noise; their part is TELLING."""
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


class Answers:
    """A bench whose residuals with a cause are given."""

    def __init__(self, with_it):
        self.with_it = with_it

    def errors_at(self, trial, changes):
        del trial
        (size,) = changes.values()
        return self.with_it(size)


def looked_at(with_it):
    whole = part()
    look = LinearisedRuns(Answers(with_it), None, None, whole.block, np.zeros(BLOCKS * EACH))
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
