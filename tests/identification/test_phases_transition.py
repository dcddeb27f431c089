"""Where a stroke passes from the dead band to slip, on channels that follow the laws of both."""

import math

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


@pytest.mark.parametrize(("size", "cut"), [(0.0425, False), (0.0465, True)])
def test_a_cut_has_to_save_thirty_mean_squares(size, cut):
    """Two laws save 27 and 32 of what they leave here."""
    values = size * f_out() + np.random.default_rng(8).standard_normal(N)
    assert (p._transition(stroke({"f_out_N": values})) is not None) == cut


@pytest.mark.parametrize(("slip", "cut"), [(30.0, True), (40.0, False), (300.0, False)])
def test_slip_is_a_third_as_steep_at_the_most(slip, cut):
    """After a straight rise of 100 per mm; a law with √D fits that too."""
    D, rng = TRAVEL, np.random.default_rng(5)
    values = np.where(D[CUT] > D, 100.0 * D, 100.0 * D[CUT] + slip * (D - D[CUT]))
    found = p._transition(stroke({"f_in_N": values + rng.standard_normal(N)}))
    assert (found is not None) == cut


def test_a_stroke_with_too_few_samples_or_no_channel_is_not_cut():
    few = slice(CUT - 8, CUT + 8)  # 16: eight for each law would leave none to choose
    whole = f_in()
    assert p._transition(stroke({"f_in_N": whole[few]}, TRAVEL[few] - TRAVEL[few][0])) is None
    assert p._transition(stroke({})) is None


def test_a_short_stroke_is_cut_where_more_than_eight_samples_are_on_either_side():
    for half in (10, 9):
        few = slice(CUT - half, CUT + half)
        cut = p._transition(stroke({"f_out_N": 50.0 * f_out()[few]}, TRAVEL[few] - TRAVEL[few][0]))
        assert abs(cut - half) <= 1


def test_a_drive_that_slows_down_slips_along_a_line_too():
    """Samples that lie closer and closer: what is straight is so over travel, not over time."""
    travel = 12.0 * np.sin(np.linspace(0.0, 1.4, N))
    values = np.where(np.arange(N) < CUT, 0.0, 40.0 * (travel - travel[CUT]))
    assert abs(p._transition(stroke({"f_out_N": values}, travel)) - CUT) <= 1


@pytest.mark.parametrize("bend", [4, N - 4])
def test_a_bend_in_the_first_or_last_eight_samples_is_no_cut(bend):
    values = np.where(np.arange(N) < bend, 0.0, 900.0 * (TRAVEL - TRAVEL[bend]))
    found = p._transition(stroke({"f_out_N": values}))
    assert found is None or 8 <= found < N - 8


def test_a_cut_that_leaves_nothing_needs_to_save_next_to_nothing():
    assert abs(p._transition(stroke({"f_out_N": 1e-3 * f_out()})) - CUT) <= 1


def test_squares_are_never_negative():
    basis = np.column_stack((np.ones(N), TRAVEL))
    for values in (1e6 * TRAVEL, 0.1 * TRAVEL - 7e5):
        assert p._residual_squares(basis, values).min() == 0.0


def test_a_load_that_moves_slips():
    """Its slope counts inverted: a load that stands quite still is in the dead band."""
    load = np.where(TRAVEL[CUT] > TRAVEL, 0.0, -4.0 * (TRAVEL - TRAVEL[CUT]))
    before, after = p._slopes(stroke({"x_out_mm": load}), CUT)
    assert before > 1e9
    assert after == pytest.approx(1.0 / 4.0)


@pytest.mark.parametrize(("samples", "steep"), [(0, math.nan), (7, math.nan), (8, 3.0)])
def test_eight_samples_have_a_slope(samples, steep):
    line = {"x_out_mm": np.zeros(samples), "f_in_N": 3.0 * TRAVEL[:samples]}
    found = p._slopes(stroke(line if samples else {}, TRAVEL[:samples]), None)
    assert found == pytest.approx((steep, math.nan), nan_ok=True)


@pytest.mark.parametrize("cut", [None, 20, CUT])
def test_slopes_are_those_of_lines_through_all_samples_of_a_side(cut):
    values = np.random.default_rng(6).standard_normal(N)
    sides = (slice(0, cut), slice(cut, N))
    steep = [abs(np.polyfit(TRAVEL[side], values[side], 1)[0]) for side in sides]
    found = p._slopes(stroke({"f_out_N": -values, "f_in_N": values}), cut)
    assert found[0] == pytest.approx(steep[0])
    assert math.isnan(found[1]) if cut is None else found[1] == pytest.approx(steep[1])
