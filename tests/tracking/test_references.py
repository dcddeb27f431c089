"""Every shape has the range and the period that it says; recorded ones are what was recorded."""

import math

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from tsas_cli.support.errors import InputError
from tsas_cli.tracking.references import SHAPES, reference
from tsas_cli.tracking.settings import ReferenceSettings

H = 0.001
W = 2.5
PERIOD_S = 2.0 * math.pi / W
FORM = ReferenceSettings(
    mean_N=40.0, amplitude_N=7.0, angular_frequency_rad_per_s=W, duration_s=4.0 * PERIOD_S
)
T = H * np.arange(round(4.0 * PERIOD_S / H) + 1)


@pytest.mark.parametrize("name", SHAPES)
def test_every_shape_has_its_range_and_begins_low(name):
    wanted = reference(name, FORM, H)
    assert wanted.shape == T.shape
    assert (wanted.min(), wanted.max()) == pytest.approx((33.0, 47.0), abs=0.02)
    assert wanted[0] == pytest.approx(33.0)


@pytest.mark.parametrize("name", SHAPES)
def test_every_shape_has_its_period(name):
    """And no shorter one; the two-frequency one after its first period."""
    wanted = reference(name, FORM, H)[round(PERIOD_S / H) + 1 :]
    late = T[: wanted.size - round(1.1 * PERIOD_S / H)]

    def off(shift_s):
        moved = np.interp(late + shift_s, H * np.arange(wanted.size), wanted)
        return np.mean(np.abs(moved - wanted[: late.size]))

    assert off(PERIOD_S) < 0.05 < 2.0 < min(off(PERIOD_S / 2.0), off(PERIOD_S / 3.0))


def test_the_sine_is_that_of_the_paper():
    np.testing.assert_allclose(
        reference("sine", FORM, H), 7.0 * np.sin(W * T - math.pi / 2.0) + 40.0, rtol=1e-12
    )


def test_two_frequencies_are_two_fast_periods_then_slow_ones():
    wanted = reference("two-frequency", FORM, H)
    first = T < PERIOD_S
    fast = 7.0 * np.sin(2.0 * W * T - math.pi / 2.0) + 40.0
    np.testing.assert_allclose(wanted[first], fast[first])
    np.testing.assert_allclose(wanted[~first], reference("sine", FORM, H)[~first])
    assert np.abs(np.diff(wanted)).max() < 7.0 * 2.0 * W * H * 1.01


def test_steps_hold_four_levels_of_a_quarter_period():
    wanted = reference("steps", FORM, H)
    quarters = [wanted[round((k + 0.5) * PERIOD_S / 4.0 / H)] for k in range(5)]
    assert quarters == [33.0, 40.0, 47.0, 40.0, 33.0]
    assert set(wanted) == {33.0, 40.0, 47.0}


def test_ramps_rise_and_fall_alike():
    wanted = reference("ramps", FORM, H)
    slopes = np.diff(wanted) / H
    assert np.quantile(slopes, [0.2, 0.8]) == pytest.approx([-28.0 / PERIOD_S, 28.0 / PERIOD_S])
    assert wanted[round(PERIOD_S / 2.0 / H)] == pytest.approx(47.0, abs=0.02)


def recorded(folder, **columns):
    path = folder / "wanted.parquet"
    pq.write_table(pa.table({"time_s": [2.0, 2.5, 4.0], **columns}), path)
    return str(path)


def test_a_recording_is_followed_linearly_between_its_samples(tmp_path):
    """From its first sample on, at the rate of the loop; the wanted force goes before f_out."""
    name = recorded(tmp_path, f_out_ref_N=[30.0, 40.0, 25.0], f_out_N=[1.0, 1.0, 1.0])
    wanted = reference(name, FORM, 0.25)
    np.testing.assert_allclose(wanted, [30, 35, 40, 37.5, 35, 32.5, 30, 27.5, 25])
    name = recorded(tmp_path, f_out_N=[30.0, 40.0, 25.0])
    np.testing.assert_allclose(reference(name, FORM, 0.25), wanted)


def test_a_recording_without_a_force_or_with_a_gap_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"column f_out_ref_N is missing.*or f_out_N"):
        reference(recorded(tmp_path, x_in_mm=[1.0, 2.0, 3.0]), FORM, H)
    with pytest.raises(InputError, match=r"row 1: f_out_N has a gap"):
        reference(recorded(tmp_path, f_out_N=[30.0, None, 31.0]), FORM, H)


def test_a_tendon_cannot_push(tmp_path):
    low = FORM.model_copy(update={"amplitude_N": 50.0})
    with pytest.raises(InputError, match=r"sine: asks for -10 N at 0 s; expected a tension above"):
        reference("sine", low, H)
    name = recorded(tmp_path, f_out_N=[30.0, 40.0, -20.0])
    with pytest.raises(InputError, match=r"asks for 0 N at 1\.5 s"):
        reference(name, FORM, 0.25)


def test_a_period_of_few_samples_is_refused():
    """Else the samples are those of a slower wave."""
    most = 2.0 * math.pi / (10.0 * H)
    for name, share in (("sine", 1.0), ("two-frequency", 0.5)):
        form = FORM.model_copy(update={"angular_frequency_rad_per_s": 0.99 * share * most})
        reference(name, form, H)
        form = FORM.model_copy(update={"angular_frequency_rad_per_s": 1.02 * share * most})
        with pytest.raises(InputError, match=r"have 9\.8 samples a period; expected at least 10"):
            reference(name, form, H)


def test_a_loop_of_more_samples_than_anyone_waits_for_is_refused(tmp_path):
    """An hour at 20 kHz: minutes of silence, and 6 GB."""
    form = ReferenceSettings(duration_s=3600.0)
    with pytest.raises(InputError, match="72000001 samples at 20000 Hz; expected at most 10000000"):
        reference("sine", form, 1.0 / 20_000.0)
    path = tmp_path / "wanted.parquet"
    pq.write_table(pa.table({"time_s": [0.0, 3600.0], "f_out_ref_N": [20.0, 20.0]}), path)
    with pytest.raises(InputError, match="has 72000001 samples"):
        reference(str(path), form, 1.0 / 20_000.0)


def test_an_unknown_shape_names_the_nearest():
    with pytest.raises(InputError, match=r"unknown reference sines.*did you mean sine\?"):
        reference("sines", FORM, H)
    with pytest.raises(InputError, match="does not exist"):
        reference("nowhere.parquet", FORM, H)
