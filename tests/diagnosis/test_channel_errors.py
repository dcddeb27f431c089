"""The errors of each channel beside their noise floor, on runs whose noise is known."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from tsas_cli.diagnosis.channel_errors import HeldOutErrors, channel_errors, is_far_off, noise_floor
from tsas_cli.diagnosis.remainder import Remainder, SlowPart

ROWS = 1000


def bench(*of_drive):
    """Return runs with 0.1 N of noise; in one sample in ten the drive's error moves f_in."""
    run = SimpleNamespace(
        samples={"f_in_N": np.arange(ROWS)}, run=SimpleNamespace(noise={"f_in_N": 0.1})
    )
    at = np.arange(ROWS) % 10 == 0
    by_driven_ends = [{"f_in_N": np.where(at, moved, 0.0)} for moved in of_drive]
    return SimpleNamespace(
        channels=["f_in_N"], closed=[run] * len(of_drive), by_driven_ends=by_driven_ends
    )


def test_the_floor_has_white_noise_slow_noise_and_what_the_drive_does():
    assert noise_floor(bench(0.0), "f_in_N", 0.0) == pytest.approx(0.1)
    assert noise_floor(bench(0.0), "f_in_N", 1.0) == pytest.approx(0.1 * math.sqrt(2.0))
    both = noise_floor(bench(0.8, 0.0), "f_in_N", 0.0)
    assert both == pytest.approx(math.sqrt(0.01 + 0.5 * 0.1 * 0.8**2))


@pytest.mark.parametrize(
    ("channel", "left", "far"),
    [
        ("f_out_N", 0.49, False),
        ("f_out_N", 0.51, True),
        ("x_out_mm", 0.51, True),
        ("f_in_N", 9.0, False),
    ],
)
def test_a_distal_channel_is_far_off_beyond_five_times_its_noise_floor(channel, left, far):
    assert is_far_off(channel, HeldOutErrors(10.0, left, noise_floor=0.1, attainable=0.1)) is far


def found(before, after, start, rest, slow=None):
    left = [Remainder(1.0, {"f_in_N": part}, (), shares={"f_in_N": part}) for part in (start, rest)]
    if slow is not None:
        left[1] = replace(left[1], slow={"f_in_N": SlowPart(slow, 1.0)})
    return channel_errors(bench(0.0), {"f_in_N": before}, {"f_in_N": after}, *left)["f_in_N"]


@pytest.mark.parametrize(
    ("errors", "explained", "attainable"),
    [
        ((1.0, 0.5), (0.0, 0.64), 0.5 * 0.6),
        ((1.0, 0.5), (0.96, 0.0), 0.2),
        ((1.0, 0.5), (0.0, 0.999), 0.1),  # no less than the noise
        ((1.0, 0.09), (0.0, 0.0), 0.09),  # and no more than what is reached
    ],
)
def test_attainable_is_the_better_of_both_without_what_a_regression_explains(
    errors, explained, attainable
):
    """The noise level is an estimate: a residual may be below it."""
    one = found(*errors, *explained)
    assert (one.rmse_before, one.rmse_after) == errors
    assert one.attainable == pytest.approx(attainable)
    assert one.noise_floor == pytest.approx(0.1)


def test_slow_noise_belongs_to_the_floor():
    one = found(1.0, 0.2, 0.0, 0.0, slow=1.2)
    assert one.noise_floor == pytest.approx(0.1 * math.sqrt(1.0 + 1.2**2))
    assert found(1.0, 0.2, 0.0, 0.3, slow=1.2).noise_floor == pytest.approx(0.1)  # an error
