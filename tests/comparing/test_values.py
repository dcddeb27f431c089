import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tsas_cli.comparing.sides import Side, difference, overlap, pairs, same_runs
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model
from tsas_cli.records.base import DatasetSource

A = Estimate("friction_coefficient", 0.125, "1", "fitted", None, 0.002, 0.121, 0.130)
B = Estimate("friction_coefficient", 0.150, "1", "fitted", None, 0.002, 0.142, 0.153)
NO_INTERVAL = {"interval_low": None, "interval_high": None}
PRELOAD = Estimate("preload_N", 25.0, "N", "fitted", "a", 0.1, 24.8, 25.2)


def side(*estimates, recordings=None):
    source = None if recordings is None else DatasetSource(name="bench", hashes=recordings)
    return Side(Path("m.toml"), "model", {}, Model(estimates), source=source)


def test_the_interval_adds_the_ends_that_pull_the_same_way_in_quadrature():
    d = difference(A, B)
    assert d.value == pytest.approx(0.025)
    assert d.low == pytest.approx(0.025 - math.hypot(0.008, 0.005))
    assert d.high == pytest.approx(0.025 + math.hypot(0.003, 0.004))
    assert d.excludes_zero


@pytest.mark.parametrize("ratio", [1.0, 4.0])
def test_one_in_twenty_claims_is_false_and_a_large_difference_is_found(ratio):
    rng, trials = np.random.default_rng(1), 4000

    def claims(shift):
        drawn = rng.normal((0.0, shift), (1.0, ratio), size=(trials, 2))
        told = (
            [replace(A, value=v, interval_low=v - 1.96 * s, interval_high=v + 1.96 * s)
             for v, s in zip(values, (1.0, ratio), strict=True)]
            for values in drawn
        )  # fmt: skip
        return sum(bool(difference(a, b).excludes_zero) for a, b in told) / trials

    assert claims(0.0) == pytest.approx(0.05, abs=0.01)
    assert claims(5.0 * math.hypot(1.0, ratio)) > 0.99


def test_intervals_that_are_not_symmetric_hold_the_difference_as_often():
    # A logarithm that is normal, as positive parameters are fitted.
    rng, trials, spread = np.random.default_rng(2), 4000, 0.3
    held = 0
    for logs in rng.normal(0.0, spread, size=(trials, 2)):
        ends = np.exp(logs[:, None] + [0.0, -1.96 * spread, 1.96 * spread])
        a, b = (replace(A, value=v, interval_low=low, interval_high=high) for v, low, high in ends)
        held += not difference(a, b).excludes_zero
    assert held / trials == pytest.approx(0.95, abs=0.01)


@pytest.mark.parametrize(
    ("first", "second", "how"),
    [
        ({"a": "1", "b": "2"}, {"a": "3"}, "none"),
        ({"a": "1"}, {"z": "1"}, "all"),
        ({"a": "1", "b": "2"}, {"a": "1"}, "some"),
        (None, {"a": "1"}, "unknown"),
    ],
)
def test_recordings_are_the_same_by_checksum(first, second, how):
    assert overlap(side(A, recordings=first), side(B, recordings=second)) == how


@pytest.mark.parametrize(
    ("a", "b", "second", "why"),
    [
        (A, B, {"a": "1"}, "the same recordings"),
        (A, B, None, "not known to be independent"),
        (A, replace(B, at_bound=True), {"a": "2"}, "at its bound"),
        (replace(A, **NO_INTERVAL), B, {"a": "2"}, "not estimated on both sides"),
    ],
)
def test_no_interval_where_none_may_be_claimed(a, b, second, why):
    (pair,) = pairs(side(a, recordings={"a": "1"}), side(b, recordings=second))
    assert pair.difference.value == pytest.approx(0.025)
    assert (pair.difference.low, pair.difference.high) == (None, None)
    assert pair.difference.excludes_zero is None
    assert pair.difference.why_none == why


def test_a_value_of_one_run_is_paired_by_the_recording_not_by_the_name():
    a = side(PRELOAD, recordings={"a": "1"})
    same_name = pairs(a, side(PRELOAD, recordings={"a": "2"}))
    assert [(p.a is None, p.b is None) for p in same_name] == [(False, True), (True, False)]
    renamed = replace(PRELOAD, run="first")
    (pair,) = pairs(a, side(renamed, recordings={"first": "1"}))
    assert (pair.run, pair.difference.value) == ("a = first", 0.0)


def test_what_only_one_model_holds_is_listed_after_what_both_hold():
    length = Estimate("free_tendon.proximal_length_mm", 150.0, "mm", "fitted")
    found = pairs(side(A, length), side(replace(length, name="backlash.play_mm"), B))
    assert [p.name for p in found] == [A.name, length.name, "backlash.play_mm"]
    assert [p.difference is None for p in found] == [False, True, True]


def test_a_recording_that_is_there_twice_goes_with_its_name():
    assert same_runs({"a": "1", "b": "1"}, {"b": "1", "c": "1"}) == {"a": "b", "b": "c"}
    assert same_runs({"b": "1"}, {"a": "1", "b": "1"}) == {"b": "b"}
