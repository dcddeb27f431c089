"""Gains over blocks: sure where many agree, unsure where one speaks, never by samples."""

import numpy as np
import pytest

from tsas_cli.diagnosis.evidence import gain, gain_percent

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
    assert gain(BEFORE, after).sureness == pytest.approx(np.sqrt(20.0))


def test_chance_is_rarely_convincing():
    convincing = 0
    for _ in range(2000):
        before = RNG.chisquare(50, 40)
        convincing += gain(before, before * np.exp(0.1 * RNG.standard_normal(40))).convincing
    assert convincing < 2000 * 0.01


def test_a_sure_gain_that_is_tiny_does_not_matter():
    found = gain(BEFORE, 0.999 * BEFORE)
    assert found.sureness > 6.0
    assert not found.convincing


def test_the_gain_in_percent_is_that_of_the_root_and_lies_in_its_interval():
    after = BEFORE * RNG.uniform(0.2, 0.3, 40)
    whole, low, high = gain_percent(BEFORE, after, np.random.default_rng(2))
    assert low < whole < high
    assert whole == pytest.approx(50.0, abs=2.0)
    assert high - low < 3.0
