"""The way from effect to effect, on squares that are made up."""

import numpy as np
import pytest

from tsas_cli.diagnosis.evidence import gain
from tsas_cli.diagnosis.search import Search
from tsas_cli.effects import EFFECTS

BLOCKS = 20
SIMPLE, RICH, THIRD = "drive_friction", "force_sensor_offset", "position_sensor_gain"
PARAMETERS = {e.name: len(e.parameters) for e in EFFECTS}
HALVES = np.arange(BLOCKS) % 2


class MadeUp(Search):
    """A search among three effects whose held-out squares are given."""

    def __init__(self, squares):
        super().__init__(
            None, None, effects=tuple(e for e in EFFECTS if e.name in (SIMPLE, RICH, THIRD))
        )
        self.given = {frozenset(names): np.ones(BLOCKS) * value for names, value in squares.items()}

    def _squares(self, names):
        return self.given.get(
            names, min((self.given[n] for n in self.given if n <= names), key=np.sum)
        )

    def gain(self, before, after):
        return gain(self._squares(before), self._squares(after))

    def is_quiet(self, names):
        return self._squares(names).mean() < 1.15

    def matters(self, before, added):
        return self._squares(before | set(added)).sum() < 0.6 * self._squares(before).sum()

    def add(self, names):
        found = [
            (e.name, self.gain(names, names | {e.name}))
            for e in self.effects
            if e.name not in names
        ]
        return sorted(found, key=lambda f: -f[1].part)

    def _best_pair(self, names):
        return None


def test_the_simple_effect_has_fewer_parameters():
    assert PARAMETERS[SIMPLE] < PARAMETERS[RICH]


def test_a_simple_effect_that_leads_nowhere_gives_way_to_the_one_that_goes_on():
    """It is worse in half of the blocks only, so that chance cannot be left out."""
    search = MadeUp(
        {
            (): 1000.0,
            (SIMPLE,): np.where(HALVES, 20.0, 130.0),
            (RICH,): 50.0,
            (RICH, THIRD): 1.0,
        }
    )
    assert search.run() == {RICH, THIRD}


@pytest.mark.parametrize("left", [1.0, 100.0])
def test_a_simple_effect_is_enough_where_the_richer_one_ends_no_better(left):
    search = MadeUp({(): 1000.0, (SIMPLE,): left, (RICH,): 0.99 * left})
    assert search.run() == {SIMPLE}


def test_a_richer_effect_that_is_surely_better_is_named():
    search = MadeUp({(): 1000.0, (SIMPLE,): 400.0, (RICH,): 1.0})
    assert search.run() == {RICH}


def test_nothing_is_named_where_nothing_convinces():
    search = MadeUp({(): 1000.0, (SIMPLE,): np.where(HALVES, 1990.0, 2.0)})
    assert search.run() == frozenset()
