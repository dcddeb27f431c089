"""A signal that is cleaned in pieces is the one that is cleaned as a whole."""

import numpy as np
import pytest

from tsas_cli.numerics import conditioning_pieces
from tsas_cli.numerics.conditioning import condition, monotone_between
from tsas_cli.numerics.conditioning_pieces import CleaningPlan, cleaned, plan
from tsas_cli.numerics.turning_points import turning_points

NOISE = 0.01
TIME_S = np.arange(20_000) / 200.0
NOTHING_TO_CLEAN = CleaningPlan(0.0, 1.0, 0.0, 0.0, 0.005)


def motion(time_s):
    return 10.0 * np.sin(0.5 * time_s) + 3.0 * np.sin(1.7 * time_s)


def triangle(time_s):
    return 10.0 * np.arccos(np.cos(0.6 * time_s))


def dwells(time_s):
    return 10.0 * np.clip(1.5 * np.sin(0.4 * time_s), -1.0, 1.0)


def pieces(time_s, values, rows, beside):
    starts = range(0, max(values.size - 2 * beside, 1), rows - 2 * beside)
    return [(s, time_s[s : s + rows], values[s : s + rows]) for s in starts]


def noisy(true, seed):
    return true + NOISE * np.random.default_rng(seed).standard_normal(true.size)


def in_pieces(time_s, values, rows, beside, known=None):
    parts = pieces(time_s, values, rows, beside)
    known = known or plan(pieces(time_s, values, rows, 0), -(-values.size // rows))
    found = list(cleaned(parts, beside, known))
    assert [f.start for f in found] == [0, *np.cumsum([f.values.size for f in found])[:-1]]
    names = ("values", "sd", "unseen", "apart_s", "reversals")
    return {name: np.concatenate([getattr(f, name) for f in found]) for name in names}, known


LARGE = pytest.mark.large


@pytest.mark.parametrize(
    "rows", [3000, pytest.param(5000, marks=LARGE), pytest.param(8000, marks=LARGE)]
)
@pytest.mark.parametrize("shape", [motion, triangle, dwells])
def test_it_is_the_signal_that_is_cleaned_as_a_whole(shape, rows):
    time_s = TIME_S[:10_000]
    true = shape(time_s)
    raw = noisy(true, 1)
    whole = condition(time_s, raw)
    found, known = in_pieces(time_s, raw, rows, 500)
    assert known.noise == pytest.approx(whole.noise, rel=0.02)
    assert known.smallest_reversal == pytest.approx(whole.smallest_reversal, rel=0.2)
    assert found["reversals"].size == whole.reversals.size - 2
    # Where in a rest the drive turns is no matter.
    assert np.abs(true[found["reversals"]] - true[whole.reversals[1:-1]]).max() < 5.0 * NOISE
    missed, missed_whole = (np.std(v - true) for v in (found["values"], whole.values))
    assert missed < 1.5 * missed_whole < 0.25 * NOISE
    turns = [0, *found["reversals"], time_s.size - 1]  # and it turns nowhere else
    assert set(turning_points(found["values"], 0.0)) <= set(turns)


@pytest.mark.parametrize(("rows", "threshold"), [(100, 0.05), (1000, 2.0), (7000, 2.0)])
def test_between_reversals_it_is_the_nearest_monotone_signal_exactly(rows, threshold, monkeypatch):
    def as_it_is(time_s, values, noise, memory):
        return values, np.full(values.size, noise), 0.0

    monkeypatch.setattr(conditioning_pieces, "smooth_out", as_it_is)
    raw = noisy(motion(TIME_S), 2)
    known = CleaningPlan(NOISE, 1.0, threshold, 0.0, 0.005)
    found, _ = in_pieces(TIME_S, raw, rows, 10, known)
    turns = turning_points(raw, threshold)
    np.testing.assert_array_equal(found["reversals"], turns[1:-1])
    np.testing.assert_allclose(found["values"], monotone_between(raw, turns), atol=1e-12)
    np.testing.assert_allclose(found["values"] + found["unseen"], raw, atol=1e-12)


@pytest.mark.parametrize("rows", [900, 4000])
def test_without_noise_nothing_changes(rows):
    raw = motion(TIME_S)
    found, _ = in_pieces(TIME_S, raw, rows, 100, NOTHING_TO_CLEAN)
    np.testing.assert_array_equal(found["values"], raw)
    np.testing.assert_array_equal(found["reversals"], condition(TIME_S, raw).reversals[1:-1])


@pytest.mark.parametrize(
    "gap", [slice(2990, 3010), slice(0, 40), slice(19_900, 20_000), slice(2000, 9500)]
)
def test_a_gap_is_laid_over_straight_wherever_it_is(gap):
    raw = motion(TIME_S)
    raw[gap] = np.nan
    raw[5000::3] = np.nan
    found, _ = in_pieces(TIME_S, raw, 3000, 100, NOTHING_TO_CLEAN)
    there = np.isfinite(raw)
    np.testing.assert_allclose(found["values"], np.interp(TIME_S, TIME_S[there], raw[there]))
    before, after = gap.start - 1, gap.stop
    apart = TIME_S[after] - TIME_S[before] if before >= 0 and after < raw.size else np.inf
    if gap.stop < 5000:
        np.testing.assert_allclose(found["apart_s"][gap], apart)
    assert (found["apart_s"][there] == 0.0).all()


def test_a_rest_longer_than_two_pieces_neither_stops_it_nor_turns_back():
    time_s = np.arange(15_000) / 100.0
    true = np.interp(time_s, [0, 20, 120, 150], [0, 8, 8, 12])
    raw = noisy(true, 3)
    found, _ = in_pieces(time_s, raw, 1000, 150)
    assert found["reversals"].size == 0
    assert (np.diff(found["values"]) >= 0.0).all()
    assert np.abs(found["values"] - condition(time_s, raw).values).max() < 2.0 * NOISE


def test_a_drive_that_rests_first_and_for_long_begins_where_it_is():
    time_s = np.arange(20_000) / 200.0
    true = np.interp(time_s, [0, 60, 80, 100], [5, 5, 1, 4])
    raw = noisy(true, 4)
    found, _ = in_pieces(time_s, raw, 2000, 300)
    assert np.abs(found["values"] - true).max() < 2.0 * NOISE
    assert 15_990 <= found["reversals"][-1] <= 16_010
