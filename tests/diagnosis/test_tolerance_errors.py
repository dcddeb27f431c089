"""What tolerances leave unsure, on a straight line and two made-up ones."""

import numpy as np
import pytest

from tsas_cli.diagnosis.tolerances import moved_by_tolerances
from tsas_cli.identification.fit import Solution, Unknown
from tsas_cli.identification.hypothesis_fit import HypothesisFit

RUNS, ROWS = 4, 500
BLOCKS = [np.arange(ROWS) // 25 for _ in range(RUNS)]
X = np.tile(np.linspace(-1.0, 1.0, ROWS), RUNS)
LINE = X[:, None]
OTHER = np.cos(40.0 * X)  # what no slope can imitate


def unsure(signature, truly=0.0):
    """Fit a slope to noise and to so much of the first way; the second does nothing."""
    data = np.random.default_rng(1).standard_normal(X.size) + truly * signature
    slope = np.linalg.lstsq(LINE, data, rcond=None)[0]
    solution = Solution(slope, np.zeros(1, bool), LINE @ slope - data, LINE, True, "", 1)
    trial = HypothesisFit(
        (), (Unknown("slope", None, 0.0, -9.0, 9.0, 1.0),), solution, (ROWS,) * RUNS, on_mesh=False
    )
    ways = np.column_stack((signature, np.zeros(X.size)))
    (moved,), ((unsure,),) = moved_by_tolerances(trial, -ways, BLOCKS)
    return float(slope[0]), float(moved), float(np.sqrt(unsure))


def test_what_looks_like_a_parameter_leaves_it_as_unsure_as_is_plausible():
    _, moved, found = unsure(0.3 * X)
    assert moved == pytest.approx(0.0, abs=0.02)
    assert found == pytest.approx(0.3, rel=0.05)


def test_what_the_recordings_rule_out_leaves_nothing_unsure():
    _, moved, found = unsure(0.3 * X + 5.0 * OTHER)
    assert abs(moved) < 0.02
    assert found < 0.02


@pytest.mark.parametrize("truly", [-2.0, 1.0, 2.0])
def test_what_the_recordings_ask_for_is_taken_back(truly):
    slope, moved, found = unsure(0.3 * X + 5.0 * OTHER, truly)
    assert abs(slope) > 0.9 * abs(0.3 * truly)
    assert slope + moved == pytest.approx(0.0, abs=0.05)
    assert found < 0.02


def test_no_tolerance_counts_for_more_than_is_plausible():
    """The slope is off by ten times what two standard deviations do."""
    slope, moved, _ = unsure(0.3 * X + 5.0 * OTHER, 20.0)
    assert abs(slope) == pytest.approx(6.0, abs=0.1)
    assert abs(moved) == pytest.approx(0.3 * 2.0, rel=0.05)
