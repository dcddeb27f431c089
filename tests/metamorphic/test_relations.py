"""What is done to recordings without changing what they say leaves every answer as it is."""

from dataclasses import replace

import numpy as np
import pyarrow.parquet as pq
import pytest

from tests.metamorphic.answers import Answers, apart, fitted
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
def of_nothing(tmp_path_factory):
    """Answers to recordings of a rig with nothing hidden; nothing is named."""
    answers = Answers(recorded(), tmp_path_factory.mktemp("nothing") / "x")
    assert answers.verdict == ("sufficient", [])
    assert answers.diagnose.record.faults == ()
    return answers


@pytest.fixture(scope="module")
def of_hidden(tmp_path_factory):
    """Answers to recordings of a rig with tendon outside its sheath; it is named."""
    answers = Answers(recorded("free_tendon"), tmp_path_factory.mktemp("hidden") / "x")
    assert answers.verdict == ("named", [("free_tendon", [])])
    assert answers.diagnose.record.faults == ()
    return answers


@pytest.fixture
def answers(tmp_path):
    """Return a function that gives the answers to recordings."""
    return lambda raw: Answers(raw, tmp_path / "x")


@pytest.mark.parametrize("stage", ["calibrate", pytest.param("diagnose", marks=LARGE)])
def test_signs_and_strangers_change_nothing_to_the_last_bit(of_hidden, answers, stage):
    # The map turns signs back, which is exact, and leaves columns that it does not name; one that
    # travels along is looked at by no stage.
    other = answers(with_strangers(turned_round(of_hidden.raw)))
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


def x_in_moved(by_mm):
    """Return a change of the zero of x_in: it moves the fitted zero alone."""
    return lambda raw: moved(raw, "x_in_mm", by_mm), ENDED, {"moved": {"x_in_zero_mm": by_mm}}


CALIBRATED = {
    "a clock that counts from 1970": (lambda raw: later(raw, UNIX_S), ROUNDING, {}),
    "other names, another order": (
        *(lambda raw: called(raw, OTHER_NAMES), ROUNDING),
        {"names": OTHER_NAMES},
    ),
    "inch, lbf and ms": (lambda raw: in_units(raw, IMPERIAL), ROUNDING, {}),
    "forces four times as large": (lambda raw: stronger(raw, 4.0), ROUNDING, {"times": 4.0}),
    **{f"x_in by {by_mm} mm": x_in_moved(by_mm) for by_mm in (-40.0, 5000.0)},
}


@pytest.mark.parametrize("relation", CALIBRATED)
def test_calibrate_gives_the_same(of_nothing, answers, relation):
    change, within, told = CALIBRATED[relation]
    other = answers(change(of_nothing.raw)).calibrate
    assert set(other.summary) == set(of_nothing.calibrate.summary)
    assert apart(of_nothing.calibrate, other, **told) < within
    assert not any(e.at_bound for e in fitted(other).values())


def test_diagnose_gives_the_same_to_rounding_after_all_of_them(of_hidden, answers):
    changed = later(called(stronger(of_hidden.raw, 4.0), OTHER_NAMES), UNIX_S)
    other = answers(in_units(changed, IMPERIAL))
    assert other.verdict == of_hidden.verdict
    told = {"names": OTHER_NAMES, "times": 4.0}
    assert apart(of_hidden.diagnose, other.diagnose, **told) < ROUNDING
    assert apart(of_hidden.calibrate, other.calibrate, **told) < ROUNDING


def test_units_come_back_to_the_last_digits(of_nothing, answers):
    other = answers(in_units(of_nothing.raw, IMPERIAL)).columns()
    for run, columns in of_nothing.columns().items():
        for name, values in columns.items():
            np.testing.assert_allclose(other[run][name], values, rtol=4e-16 * 4, atol=1e-300)


def at_half_the_rate(columns):
    slow = columns[CLOCK][::2]
    return columns | {"x_out_mm": np.interp(columns[CLOCK], slow, columns["x_out_mm"][::2])}


DIAGNOSED = {
    # The other half are other noise: three standard errors for each of seven values.
    "half of the samples": ("of_nothing", every_second, 3.0, {}),
    "a channel at half the rate": ("of_nothing", lambda raw: raw.each(at_half_the_rate), 2.0, {}),
    # Only what the rest tells of the preload, and other blocks for the intervals.
    "longer rests": (
        *("of_hidden", lambda raw: at_rest(at_rest(raw, 2.0, before=True), 2.0, before=False)),
        *(1.0, {}),
    ),
    # Each half has a preload and a zero of its own, and forgets its begin anew.
    "runs cut in two": ("of_hidden", cut, 2.0, {"shared_only": True}),
    "x_in from another zero": ("of_hidden", *x_in_moved(-40.0)),
}


@pytest.mark.parametrize(
    "relation",  # that of the zero holds for calibrate each time
    [pytest.param(r, marks=LARGE if r.startswith("x_in") else ()) for r in DIAGNOSED],
)
def test_diagnose_says_the_same(request, answers, relation):
    of, change, within, told = DIAGNOSED[relation]
    ours = request.getfixturevalue(of)
    other = answers(change(ours.raw))
    assert other.verdict == ours.verdict
    assert apart(ours.diagnose, other.diagnose, **told) < within


def test_a_faster_clock_adds_nothing(of_nothing, answers):
    # Samples between samples hold no noise of their own; the cleaned drive is as before, since it
    # is cleaned where it was recorded.
    other = answers(resampled(of_nothing.raw, 3))
    assert other.verdict == of_nothing.verdict
    assert apart(of_nothing.diagnose, other.diagnose) < ENDED
    for name, told in of_nothing.diagnose.summary["channels"].items():
        same = other.diagnose.summary["channels"][name]
        assert same["noise_floor"] == pytest.approx(told["noise_floor"], rel=1e-2)


@pytest.mark.parametrize("by_mm", [-40.0, pytest.param(40.0, marks=LARGE)])
def test_a_zero_of_x_out_elsewhere_leaves_what_runs_share(of_nothing, answers, by_mm):
    # It cannot be told from the preload: the tension at which both displacements are zero.
    other = answers(moved(of_nothing.raw, "x_out_mm", by_mm)).calibrate
    assert apart(of_nothing.calibrate, other, shared_only=True) < ENDED
    stiffness = fitted(other)["load_stiffness_N_per_mm", None].value
    for run in of_nothing.raw.runs:
        ours = fitted(of_nothing.calibrate)["preload_N", run].value
        theirs = fitted(other)["preload_N", run].value
        zero = other.model.value("x_out_zero_mm", run) or 0.0
        assert theirs + stiffness * (by_mm - zero) == pytest.approx(ours, abs=0.05)


def test_zeros_of_both_ends_need_not_know_of_each_other(of_nothing, answers, tmp_path):
    nothing = of_nothing.raw
    told = {run: {**c, "load": '"displacement"'} for run, c in nothing.conditions.items()}
    driven = replace(nothing, conditions=told)
    ours = Answers(driven, tmp_path / "ours").calibrate
    theirs = answers(moved(moved(driven, "x_in_mm", -3.0), "x_out_mm", 40.0)).calibrate
    assert apart(ours, theirs, moved={"x_in_zero_mm": -43.0}) < ENDED
