"""On rigs at random the dynamic chain ends, stays finite, and is near its own limit."""

import numpy as np
import pytest

from tests.physics.lugre.random_rigs import (
    TIGHT,
    USUAL,
    followed,
    is_unstable,
    largest_difference,
    random_case,
)


@pytest.mark.parametrize("seed", range(40))
def test_a_run_is_near_its_limit_or_is_said_to_be_unstable(seed):
    case = random_case(seed)
    usual = followed(case, USUAL)
    assert np.all(np.isfinite(usual.columns))
    if is_unstable(case):
        return
    assert usual.finished
    tight = followed(case, TIGHT)
    rings = case.rig.effects.load_inertia.mass_kg > 0.0
    if tight.finished:
        assert largest_difference(usual, tight) < (0.05 if rings else 0.01)
