"""The fits of a search, as the diagnosis asks for them."""

import numpy as np
import pytest

from tsas_cli.diagnosis.held_out import Folds
from tsas_cli.diagnosis.hypotheses import Hypotheses

NOTHING, A, B, C = frozenset(), frozenset({"a"}), frozenset({"b"}), frozenset({"c"})
BLOCKS = np.ones(8)


def fits(squares):
    folds = Folds(np.arange(8), np.arange(8), np.zeros(8, int), by_run=False)
    return Hypotheses(None, folds, NOTHING, {}, (), {}, squares)


def test_the_best_effect_alone_counts_on_whichever_mesh_it_was_fitted():
    found = fits({
        (NOTHING, False): 10.0 * BLOCKS,
        (NOTHING, True): 9.0 * BLOCKS,
        (A, False): 8.0 * BLOCKS,
        (B, True): 3.0 * BLOCKS,
        (A | C, True): BLOCKS,
    })  # fmt: skip
    name, reduction = found.best_alone(NOTHING)
    assert name == "b"
    assert reduction.part == pytest.approx(2.0 / 3.0)
    assert found.best_alone(B)[0] == "a"
    assert found.best_alone(A | B) is None
