"""What an uneven bend leaves unsure, on a straight line and two made-up ways of being uneven."""

from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.diagnosis.uneven_bend import stderr_of_unevenness
from tsas_cli.identification.extension import Trial
from tsas_cli.identification.fit import Solution, Unknown

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
    trial = Trial(
        (), (Unknown("slope", None, 0.0, -9.0, 9.0, 1.0),), solution, (ROWS,) * RUNS, on_mesh=False
    )
    ways = np.column_stack((signature, np.zeros(X.size)))
    bench = SimpleNamespace(unevenness=lambda _: -ways)
    (found,) = stderr_of_unevenness(bench, trial, BLOCKS)
    return found, abs(float(slope[0]))


def test_what_looks_like_a_parameter_leaves_it_as_unsure_as_is_plausible():
    found, _ = unsure(0.3 * X)
    assert found == pytest.approx(0.3, rel=0.05)


def test_what_the_recordings_rule_out_leaves_nothing_unsure():
    found, _ = unsure(0.3 * X + 5.0 * OTHER)
    assert found < 0.02


@pytest.mark.parametrize("truly", [-2.0, 1.0, 2.0])
def test_what_the_recordings_ask_for_is_counted(truly):
    """The slope is off by as much as it is said to be."""
    found, off = unsure(0.3 * X + 5.0 * OTHER, truly)
    assert found == pytest.approx(0.3 * abs(truly), rel=0.1)
    assert off == pytest.approx(0.3 * abs(truly), abs=0.1)
