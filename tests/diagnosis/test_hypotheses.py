"""The fits of a search, as the diagnosis asks for them."""

from dataclasses import replace

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


class OffTheMesh:
    """A bench of which no effect needs the mesh."""

    def on_mesh(self, effects):
        return False


def test_the_nearest_fit_is_of_the_set_or_of_one_that_differs_least():
    """A set with a rival in the place of an effect, or without one, may not have been fitted."""
    trials = {key: key for key in ((NOTHING, False), (A, False), (A, True), (A | B | C, False))}
    found = replace(fits({}), bench=OffTheMesh(), trials=trials)
    assert found.nearest(A) == (A, False)
    assert found.nearest(A | C) == (A, False)  # one more in either: the first that was fitted
    assert found.nearest(B) == (NOTHING, False)
    assert found.nearest(B | C) == (A | B | C, False)
