"""What is done to recordings without changing what they say leaves every answer as it is.

Each relation says which outputs must be the same to the last bit, which to rounding, and which
within a part of their standard errors, and why.
"""

from dataclasses import replace

import numpy as np
import pyarrow.parquet as pq
import pytest

from tests.metamorphic.answers import Answers, apart, fitted, largest
from tests.metamorphic.raw import (
    CLOCK,
    IMPERIAL,
    at_rest,
    called,
    cut,
    every_second,
    in_units,
    later,
    moved,
    recorded,
    resampled,
    stronger,
    turned_round,
    with_strangers,
)

UNIX_S = 1.7e9  # a clock that counts from 1970 has steps of 0.24 µs
ROUNDING = 1e-3  # of a standard error: what differences in the last bits of a recording come to
ENDED = 0.3  # the fit ends where no step would save a millionth of the squares
LARGE = pytest.mark.large
OTHER_NAMES = {"b": "y", "d": "w"}


@pytest.fixture(scope="module")
def nothing():
    """Recordings of a rig with nothing hidden."""
    return recorded()


@pytest.fixture(scope="module")
def hidden():
    """Recordings of a rig with tendon outside its sheath."""
    return recorded("free_tendon")


@pytest.fixture(scope="module")
def of_nothing(nothing, tmp_path_factory):
    """Answers to them; nothing is named."""
    answers = Answers(nothing, tmp_path_factory.mktemp("nothing") / "x")
    assert answers.verdict == ("sufficient", [])
    return answers


@pytest.fixture(scope="module")
def of_hidden(hidden, tmp_path_factory):
    """Answers to them; it is named."""
    answers = Answers(hidden, tmp_path_factory.mktemp("hidden") / "x")
    assert answers.verdict == ("named", [("free_tendon", [])])
    return answers


@pytest.fixture
def answers(tmp_path):
    """Return a function that gives the answers to recordings."""
    return lambda raw: Answers(raw, tmp_path / "x")


@pytest.mark.parametrize("stage", ["calibrate", pytest.param("diagnose", marks=LARGE)])
def test_signs_and_strangers_change_nothing_to_the_last_bit(hidden, of_hidden, answers, stage):
    # The map turns signs back, which is exact, and leaves columns that it does not name; one that
    # travels along is looked at by no stage.
    other = answers(with_strangers(turned_round(hidden)))
    for run, columns in of_hidden.columns().items():
        same = other.columns()[run]
        assert list(same) == list(columns)
        for name, values in columns.items():
            np.testing.assert_array_equal(values, same[name])
    file = other.dataset.folder / other.dataset.manifest.run[0].file
    assert "noise" in pq.read_schema(file).names
    ours, theirs = getattr(of_hidden, stage), getattr(other, stage)
    assert ours.model == theirs.model
    differing = {key for key in ours.summary if ours.summary[key] != theirs.summary[key]}
    assert differing == {"dataset"}  # its checksums


RELATIONS = {
    "a clock that counts from 1970": (lambda raw: later(raw, UNIX_S), {}),
    "other names, another order": (lambda raw: called(raw, OTHER_NAMES), {"names": OTHER_NAMES}),
    "inch, lbf and ms": (lambda raw: in_units(raw, IMPERIAL), {}),
    "forces four times as large": (lambda raw: stronger(raw, 4.0), {"times": 4.0}),
}


@pytest.mark.parametrize("relation", RELATIONS)
def test_calibrate_gives_the_same_to_rounding(nothing, of_nothing, answers, relation):
    change, told = RELATIONS[relation]
    other = answers(change(nothing)).calibrate
    assert set(other.summary) == set(of_nothing.calibrate.summary)
    assert largest(apart(of_nothing.calibrate, other, **told)) < ROUNDING


def test_diagnose_gives_the_same_to_rounding_after_all_of_them(hidden, of_hidden, answers):
    changed = later(called(stronger(hidden, 4.0), OTHER_NAMES), UNIX_S)
    other = answers(in_units(changed, IMPERIAL))
    assert other.verdict == of_hidden.verdict
    told = {"names": OTHER_NAMES, "times": 4.0}
    assert largest(apart(of_hidden.diagnose, other.diagnose, **told)) < ROUNDING
    assert largest(apart(of_hidden.calibrate, other.calibrate, **told)) < ROUNDING


def test_units_come_back_to_the_last_digits(nothing, of_nothing, answers):
    other = answers(in_units(nothing, IMPERIAL)).columns()
    for run, columns in of_nothing.columns().items():
        for name, values in columns.items():
            np.testing.assert_allclose(other[run][name], values, rtol=4e-16 * 4, atol=1e-300)


def test_a_faster_clock_adds_nothing(nothing, of_nothing, answers):
    # Samples between samples hold no noise of their own; the cleaned drive is as before, since it
    # is cleaned where it was recorded.
    other = answers(resampled(nothing, 3))
    assert other.verdict == of_nothing.verdict
    assert largest(apart(of_nothing.diagnose, other.diagnose)) < ENDED
    for name, told in of_nothing.diagnose.summary["channels"].items():
        same = other.diagnose.summary["channels"][name]
        assert same["noise_floor"] == pytest.approx(told["noise_floor"], rel=1e-2)


def test_half_of_the_samples_say_the_same_less_surely(nothing, of_nothing, answers):
    # The other half are other noise: three standard errors for each of seven values.
    other = answers(every_second(nothing))
    assert other.verdict == of_nothing.verdict
    assert largest(apart(of_nothing.diagnose, other.diagnose)) < 3.0


def test_longer_rests_say_nothing_new(hidden, of_hidden, answers):
    # Only what the rest tells of the preload, and other blocks for the intervals.
    other = answers(at_rest(at_rest(hidden, 2.0, before=True), 2.0, before=False))
    assert other.verdict == of_hidden.verdict
    assert largest(apart(of_hidden.diagnose, other.diagnose)) < 1.0


def test_a_run_cut_in_two_says_the_same(hidden, of_hidden, answers):
    # Each half has a preload and a zero of its own, and forgets its begin anew.
    other = answers(cut(hidden))
    assert other.verdict == of_hidden.verdict
    assert largest(apart(of_hidden.diagnose, other.diagnose, shared_only=True)) < 2.0


@pytest.mark.parametrize("by_mm", [pytest.param(3.0, marks=LARGE), -40.0, 5000.0])
def test_a_zero_of_x_in_elsewhere_moves_the_fitted_zero_alone(nothing, of_nothing, answers, by_mm):
    other = answers(moved(nothing, "x_in_mm", by_mm)).calibrate
    told = {"moved": {"x_in_zero_mm": by_mm}}
    assert largest(apart(of_nothing.calibrate, other, **told)) < ENDED
    assert not any(e.at_bound for e in fitted(other).values())


def test_nor_does_it_hide_a_cause(hidden, of_hidden, answers):
    other = answers(moved(hidden, "x_in_mm", -40.0))
    assert other.verdict == of_hidden.verdict
    told = {"moved": {"x_in_zero_mm": -40.0}}
    assert largest(apart(of_hidden.diagnose, other.diagnose, **told)) < ENDED


@pytest.mark.parametrize("by_mm", [-40.0, pytest.param(40.0, marks=LARGE)])
def test_a_zero_of_x_out_elsewhere_leaves_what_runs_share(nothing, of_nothing, answers, by_mm):
    # It cannot be told from the preload: the tension at which both displacements are zero.
    other = answers(moved(nothing, "x_out_mm", by_mm)).calibrate
    assert largest(apart(of_nothing.calibrate, other, shared_only=True)) < ENDED
    stiffness = fitted(other)["load_stiffness_N_per_mm", None].value
    for run in nothing.runs:
        ours = fitted(of_nothing.calibrate)["preload_N", run].value
        theirs = fitted(other)["preload_N", run].value
        zero = other.model.value("x_out_zero_mm", run) or 0.0
        assert theirs + stiffness * (by_mm - zero) == pytest.approx(ours, abs=0.05)


def test_zeros_of_both_ends_need_not_know_of_each_other(nothing, answers, tmp_path):
    told = {run: {**c, "load": '"displacement"'} for run, c in nothing.conditions.items()}
    driven = replace(nothing, conditions=told)
    ours = Answers(driven, tmp_path / "ours").calibrate
    theirs = answers(moved(moved(driven, "x_in_mm", -3.0), "x_out_mm", 40.0)).calibrate
    assert largest(apart(ours, theirs, moved={"x_in_zero_mm": -43.0})) < ENDED


def test_a_channel_at_half_the_rate_leaves_the_verdict(nothing, of_nothing, answers):
    def laid(columns):
        slow = columns[CLOCK][::2]
        return columns | {"x_out_mm": np.interp(columns[CLOCK], slow, columns["x_out_mm"][::2])}

    other = answers(nothing.each(laid))
    assert other.verdict == of_nothing.verdict
    assert largest(apart(of_nothing.diagnose, other.diagnose)) < 2.0
