"""What a diagnosis writes of its search, on trials that are made up."""

from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.diagnosis import diagnosis_json as j
from tsas_cli.diagnosis.evidence import Gain

PARTS = {"a": 0.75, "b": 0.36, "ab": 0.84, "ac": 0.19, "bc": 0.5, "abc": 0.9}


def names(text):
    return frozenset(text)


class MadeUp:
    bench = SimpleNamespace(on_mesh=lambda found: "c" in found)

    def __init__(self, *sets):
        self.trials = dict.fromkeys(sets)

    def trial(self, found):
        solution = SimpleNamespace(converged=True)
        return SimpleNamespace(mean_square=1.5, solution=solution, values=lambda: {"p": 2.0})

    def gain(self, before, after):
        assert before == frozenset()
        return Gain(PARTS["".join(sorted(after))], 4.0)


def rows(named, *sets):
    search = MadeUp(*sets)
    causes = [SimpleNamespace(effect=name) for name in named]
    found = j._candidates(SimpleNamespace(search=search, causes=causes))
    return [("".join(row["effects"]), round(row["gain_percent"], 9)) for row in found]


def test_single_effects_and_what_stands_in_place_of_the_named_ones():
    """The root falls by 1 − √(1 − part); the best is first, each on the mesh that it needs."""
    sets = [(names(s), "c" in s) for s in ("b", "a", "ab", "ac", "abc")]
    assert rows("ab", *sets) == [("ab", 60.0), ("a", 50.0), ("b", 20.0), ("ac", 10.0)]
    assert rows("", *sets) == [("a", 50.0), ("b", 20.0)]
    assert rows("a", (names("a"), True), (names(""), False)) == []


def test_a_candidate_says_how_it_was_fitted():
    (row,) = j._candidates(SimpleNamespace(search=MadeUp((names("a"), False)), causes=[]))
    assert row["convincing"]
    assert (row["sureness"], row["mean_square"], row["converged"]) == (4.0, 1.5, True)
    assert row["parameters"] == {"p": 2.0}
    assert j._candidates(SimpleNamespace(search=None, causes=[])) == []


@pytest.mark.parametrize("angle", [0.0, 30.0, 90.0])
def test_likeness_is_the_cosine_between_two_directions(angle):
    first = np.array([[1.0], [0.0], [0.0]])
    turn = np.radians(angle)
    second = np.array([[np.cos(turn)], [np.sin(turn)], [0.0]])
    assert j._likeness(first, second) == pytest.approx(np.cos(turn), abs=1e-12)
    assert j._likeness(first, np.hstack((second, first[::-1]))) == pytest.approx(np.cos(turn))
    assert j._likeness(first, np.zeros((3, 0))) == 0.0


def test_directions_that_are_the_same_count_once():
    one = np.array([3.0, 4.0, 0.0])
    basis = j._orthonormal(np.column_stack((one, 2.0 * one)))
    assert basis.shape == (3, 1)
    assert np.abs(basis[:, 0] @ one) == pytest.approx(5.0)
    assert j._orthonormal(np.zeros((3, 2))).shape == (3, 0)


def test_how_was_held_out_is_said():
    folds = SimpleNamespace(by_run=True, blocks=40)
    search = SimpleNamespace(folds=folds, bench=SimpleNamespace(rigs=[1, 2, 3]))
    found = j._evidence(search)
    assert (found["held_out"], found["blocks"], found["runs"]) == ("runs", 40, 3)
    assert found["sentence"].startswith("each of 3 runs is predicted by a fit to the others; 40")
    folds.by_run = False
    assert j._evidence(search)["held_out"] == "stretches"
    assert j._evidence(search)["sentence"].startswith("with 3 run(s), stretches")
