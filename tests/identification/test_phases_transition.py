"""Where a stroke passes from the dead band to slip, on channels that follow the laws of both."""

import numpy as np
import pytest

from tsas_cli.identification import phases as p

N, CUT = 120, 45
TRAVEL = np.linspace(0.0, 12.0, N)


def stroke(channels, travel=TRAVEL):
    n = travel.size
    return p._Stroke(0, n, True, np.arange(n), travel, channels)


def f_in(slip=20.0, dead=100.0, noise=0.0, seed=1):
    """Tension over noise: along the front's law up to the cut, straight after it."""
    D = TRAVEL
    band = 40.0 * np.sqrt(D) + dead * D
    line = band[CUT] + slip * (D - D[CUT])
    return np.where(D[CUT] > D, band, line) + noise * np.random.default_rng(seed).standard_normal(N)


def f_out(noise=0.0, seed=2):
    still = np.where(TRAVEL[CUT] > TRAVEL, 0.0, 15.0 * (TRAVEL - TRAVEL[CUT]))
    return still + noise * np.random.default_rng(seed).standard_normal(N)


@pytest.mark.parametrize("columns", [1, 2, 3])
def test_squares_that_a_fit_to_the_first_samples_leaves(columns):
    basis = np.column_stack([TRAVEL**0.5**k for k in range(columns)])
    basis[:, 0] = 1.0
    values = 7.0 + np.random.default_rng(3).standard_normal(N)
    left = p._residual_squares(basis, values)
    assert left.size == N + 1
    assert left[0] == 0.0
    for k in (1, 2, 5, 40, N):
        fit = np.linalg.lstsq(basis[:k], values[:k], rcond=None)[0]
        direct = np.sum((values[:k] - basis[:k] @ fit) ** 2)
        assert left[k] == pytest.approx(direct, abs=1e-5)


@pytest.mark.parametrize("names", [("f_in_N",), ("f_out_N",), ("f_in_N", "f_out_N")])
def test_the_cut_is_where_both_laws_meet(names):
    channels = {"f_in_N": f_in(noise=1.0), "f_out_N": f_out(noise=1.0)}
    found = p._transition(stroke({name: channels[name] for name in names}))
    assert abs(found - CUT) <= 2


def test_a_stroke_that_one_law_is_enough_for_is_not_cut():
    noise = np.random.default_rng(4).standard_normal(N)
    assert p._transition(stroke({"f_in_N": 20.0 * TRAVEL + noise})) is None
    band = 40.0 * np.sqrt(TRAVEL) + 100.0 * TRAVEL + noise
    assert p._transition(stroke({"f_in_N": band})) is None
    assert p._transition(stroke({"f_out_N": noise})) is None


def test_a_drive_that_slows_down_slips_along_a_line_too():
    """Samples that lie closer and closer: what is straight is so over travel, not over time."""
    travel = 12.0 * np.sin(np.linspace(0.0, 1.4, N))
    values = np.where(np.arange(N) < CUT, 0.0, 40.0 * (travel - travel[CUT]))
    assert abs(p._transition(stroke({"f_out_N": values}, travel)) - CUT) <= 1


def test_a_load_that_moves_slips():
    """Its slope counts inverted: a load that stands quite still is in the dead band."""
    load = np.where(TRAVEL[CUT] > TRAVEL, 0.0, -4.0 * (TRAVEL - TRAVEL[CUT]))
    before, after = p._slopes(stroke({"x_out_mm": load}), CUT)
    assert before > 1e9
    assert after == pytest.approx(1.0 / 4.0)
