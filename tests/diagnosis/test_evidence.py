"""Gains over blocks: sure where many agree, unsure where one speaks, never by samples."""

import numpy as np
import pytest

from tsas_cli.diagnosis.evidence import Reduction, gain, gain_percent

RNG = np.random.default_rng(1)
BEFORE = RNG.chisquare(50, 40)


def test_many_blocks_that_gain_are_convincing_and_the_other_way_round_not():
    found = gain(BEFORE, 0.8 * BEFORE)
    assert found.part == pytest.approx(0.2)
    assert found.convincing
    assert not gain(0.8 * BEFORE, BEFORE).convincing


def test_one_block_alone_convinces_nobody_however_much_it_gains():
    after = BEFORE.copy()
    after[3] = 0.01
    found = gain(BEFORE, after)
    assert found.part > 0.01
    assert not found.convincing


def test_blocks_that_gain_nothing_do_not_speak():
    after = BEFORE.copy()
    after[:20] *= 0.5
    ranks = np.arange(21.0, 41.0)  # the upper half
    assert gain(BEFORE, after).test_statistic == pytest.approx(ranks.sum() / np.sqrt(ranks @ ranks))


def test_blocks_that_gain_more_do_not_outvote_the_others():
    """All of twelve gain, three of them twenty times as much as the rest: 1 in 4096 by chance."""
    after = np.ones(12)
    before = np.exp(np.linspace(0.1, 0.2, 12))
    before[-3:] *= 20.0
    assert gain(before, after).convincing
    before[:5] = 1.0 / before[:5]
    assert not gain(before, after).convincing


def test_chance_is_rarely_convincing():
    convincing = 0
    for _ in range(2000):
        before = RNG.chisquare(50, 40)
        convincing += gain(before, before * np.exp(0.1 * RNG.standard_normal(40))).convincing
    assert convincing < 2000 * 0.01


def test_a_sure_gain_that_is_tiny_does_not_matter():
    found = gain(BEFORE, 0.999 * BEFORE)
    assert found.test_statistic == pytest.approx(np.sqrt(1.5 * 40 * 41 / 81))
    assert not found.convincing


def test_the_gain_in_percent_is_that_of_the_root_and_lies_in_its_interval():
    after = BEFORE * RNG.uniform(0.2, 0.3, 40)
    whole, low, high = gain_percent(BEFORE, after, np.random.default_rng(2))
    assert low < whole < high
    assert whole == pytest.approx(50.0, abs=2.0)
    assert high - low < 3.0


def test_to_be_convincing_takes_more_than_the_least_of_both():
    assert Reduction(0.026, 2.61).convincing
    assert not Reduction(0.025, 2.61).convincing
    assert not Reduction(0.026, 2.6).convincing
    assert Reduction(0.026, 2.5, needed=2.4).convincing
    assert Reduction(0.011, 2.61).beyond(0.01)
    assert not Reduction(0.01, 2.61).beyond(0.01)


def test_what_changes_nothing_is_not_sure():
    same = gain(BEFORE, BEFORE)
    assert (same.part, same.test_statistic) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("blocks", "needed"), [(1, 0.9), (4, 9 / 30**0.5), (9, 40.5 / 285**0.5), (11, 2.6)]
)
def test_few_blocks_have_to_agree(blocks, needed):
    """Nine tenths of what they say together, where that is less than 2.6."""
    assert gain(np.ones(blocks), np.ones(blocks)).needed == pytest.approx(needed)


def test_the_test_statistic_is_that_of_signed_ranks():
    found = gain(np.array([np.e, 1.0, np.e**3]), np.array([1.0, np.e**2, 1.0]))
    assert found.test_statistic == pytest.approx((1.0 - 2.0 + 3.0) / np.sqrt(1.0 + 4.0 + 9.0))
    assert found.part == pytest.approx(1.0 - (2.0 + np.e**2) / (1.0 + np.e + np.e**3))


def test_the_interval_is_that_of_the_mean_over_blocks():
    """The root falls by 100 (1 − √m): ± 1.96 · 50/√m times the error of the mean m."""
    after = 0.25 * (1.0 + 0.2 * np.random.default_rng(3).standard_normal(400))
    whole, low, high = gain_percent(np.ones(400), after, np.random.default_rng(2))
    mean, error = after.mean(), after.std() / 20.0
    assert whole == pytest.approx(100.0 * (1.0 - np.sqrt(mean)))
    assert (high - low) / 2.0 == pytest.approx(1.96 * 50.0 / np.sqrt(mean) * error, rel=0.06)
    assert (high + low) / 2.0 == pytest.approx(whole, abs=0.02)
