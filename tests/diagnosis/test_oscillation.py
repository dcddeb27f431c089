"""Errors that swing by themselves, or repeat with a displacement."""

import math

import numpy as np
import pytest
from scipy.signal import lfilter

from tests.diagnosis.test_remainder import NOISE, ROWS, SHORT_S, SIZE, Run, X, one_stroke, phrase
from tsas_cli.diagnosis.moments import oscillation, ripple


def swing(frequency_Hz, size=1.0):
    return size * np.sin(2.0 * np.pi * frequency_Hz * (SHORT_S - SHORT_S[0]))


@pytest.mark.parametrize(
    ("runs", "of", "said"),
    [(2, 2, True), (1, 2, False), (1, 1, False), (2, 5, True), (2, 6, False), (3, 6, True)],
)
def test_half_of_the_runs_have_to_swing_and_two_at_the_least(runs, of, said):
    made = [one_stroke({"f_in_N": swing(5.0, 3.0) + NOISE[k]}) for k in range(runs)]
    made += [one_stroke({"f_in_N": NOISE[4 + k % 4]}) for k in range(of - runs)]
    assert (phrase(oscillation, *made) is not None) == said


def test_the_frequency_is_the_median_and_the_channels_are_named():
    made = [
        one_stroke({"x_out_mm": swing(5.0), "f_in_N": swing(5.0)}),
        one_stroke({"f_in_N": swing(9.0)}),
        one_stroke({"f_in_N": NOISE[0]}),
    ]
    # 400 samples of 20 ms: a bin is 1/7.98 Hz wide.
    assert phrase(oscillation, *made) == "time_s (f_in_N and x_out_mm oscillate at 5.01 Hz)"


@pytest.mark.parametrize(("strokes", "said"), [((1, 1), True), ((8, 9), False), ((9, 9), True)])
def test_a_frequency_that_goes_with_the_strokes_of_each_run_is_none_of_the_rig(strokes, said):
    """40 and 45 periods; of 8 and 9 strokes five each, of as many strokes a little apart."""
    turn = 2.0 * np.pi * np.arange(ROWS) / ROWS
    made = []
    for periods, count, noise in zip((40, 45), strokes, NOISE, strict=False):
        edges = np.linspace(0, ROWS - 1, count + 1).astype(int)
        errors = {"f_in_N": np.sin(periods * turn) + 0.1 * noise}
        made.append(Run(errors, SHORT_S, np.arange(float(ROWS)), edges))
    assert (phrase(oscillation, *made) is not None) == said


def test_runs_that_swing_at_frequencies_far_apart_have_none_in_common():
    made = [one_stroke({"f_in_N": swing(f, 3.0) + NOISE[0]}) for f in (3.0, 5.0, 9.0)]
    assert phrase(oscillation, *made) is None


@pytest.mark.parametrize(("cycles", "said"), [(1, False), (2, True)])
def test_an_oscillation_with_the_motion_is_not_its_own(cycles, said):
    """The drive makes one stroke, half a cycle: 2.5 of that is more than one cycle."""
    turn = 2.0 * np.pi * np.arange(ROWS) / ROWS
    swing = np.cos(cycles * turn) + 0.1 * NOISE[0]
    assert (phrase(oscillation, *[one_stroke({"f_in_N": swing})] * 2) is not None) == said


@pytest.mark.parametrize(
    ("period_mm", "size", "said"),
    [
        (1.3, 1.0, "x_in_mm (x_out_mm repeats every 1.3 mm)"),
        (2.7, 1.0, "x_in_mm (x_out_mm repeats every 2.7 mm)"),
        (1.3, 0.3, None),  # as small as slow noise may be
        (15.0, 1.0, None),  # what hat functions follow
    ],
)
def test_an_error_that_repeats_with_a_displacement_is_said(period_mm, size, said):
    """Of a stroke of 20 mm, at a phase of each run's own, beside noise."""
    made = []
    for phase in range(3):
        noise = np.random.default_rng(phase).standard_normal(SIZE)
        wave = size * np.sin(2.0 * np.pi * X / period_mm + phase)
        made.append(Run({"x_out_mm": noise + wave, "f_in_N": noise}))
    assert phrase(ripple, *made) == said


def test_slow_noise_does_not_repeat_with_a_displacement():
    """Of a memory of 1 s and the size of the white noise."""
    made = []
    for seed in range(3):
        fresh = np.random.default_rng(seed).standard_normal((2, SIZE))
        slow = lfilter([math.sqrt(1.0 - 0.95**2)], [1.0, -0.95], fresh[1])
        made.append(Run({"x_out_mm": fresh[0] + 1.4 * slow}))
    assert phrase(ripple, *made) is None
