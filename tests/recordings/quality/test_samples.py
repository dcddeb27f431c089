"""What the checks know of one channel, and of the strokes of a run: by formula."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from tests.recordings.quality.bench import trial
from tsas_cli.recordings.quality.batches import batches_of
from tsas_cli.recordings.quality.checks import pairs, rows
from tsas_cli.recordings.quality.samples import (
    Size,
    _bands,
    alternates,
    is_held,
    noise_spectrum,
    plateaus,
    rows_between_changes,
    size_of,
    smallest_change,
    span_of,
    step_of,
)

RNG = np.random.default_rng(8)
WHITE = RNG.standard_normal(20_000)


def test_a_span_leaves_out_the_outermost_thousandths():
    values = np.arange(1001.0)
    values[[0, -1]] = -1e9, 1e9
    assert span_of(RNG.permutation(values)) == pytest.approx(998.0)
    size = size_of(values, np.arange(values.size, dtype=float))
    assert (size.lowest, size.highest) == (-1e9, 1e9)


def test_a_step_shows_in_the_levels_or_in_the_increments():
    """A ramp of half steps and more never repeats a level."""
    levels = 0.25 * np.round(4.0 * np.sin(np.arange(400) / 9.0))
    assert step_of(levels) == pytest.approx(0.25)
    ramp = 0.1 + 0.5 * np.cumsum(1.0 + (np.arange(400) % 3))
    assert step_of(ramp) == pytest.approx(0.5)
    assert step_of(WHITE[:400]) == 0.0


def test_noise_alternates_and_motion_does_not():
    assert alternates(WHITE[:19])  # 16 third differences
    assert not alternates(WHITE[:18])
    assert not alternates(np.sin(np.arange(400) / 9.0))
    assert not alternates(np.zeros(400))


def test_changes_and_what_lies_between_them():
    values = np.array([0.0, 0.0, 1.0, 1.0, 1.0, 2.0, np.nan, np.nan, 3.0, 3.0])
    assert rows_between_changes(values[:6]).tolist() == [3]
    assert plateaus(values, 2) == [slice(0, 2), slice(2, 5), slice(8, 10)]
    assert plateaus(values, 3) == [slice(2, 5)]
    assert smallest_change(np.array([1e3, 1e3 + 1e-7, 1e3 + 0.5, 1e3 - 3.0])) == pytest.approx(0.5)
    assert smallest_change(np.ones(5)) == math.inf


@pytest.mark.parametrize(
    ("held", "changes", "expected"), [(2, 21, True), (2, 20, False), (1, 99, False), (3, 40, True)]
)
def test_a_channel_is_held_that_changes_in_every_second_row_at_most(held, changes, expected):
    values = np.repeat(np.arange(changes + 1.0), held)
    assert is_held(values) == expected


@pytest.mark.parametrize("rate_Hz", [100.0, 400.0])
def test_the_spectrum_of_white_noise_is_even_and_has_its_power(rate_Hz):
    """2 σ² over the rate, in the band up to half of it, whatever the polynomial of a segment is."""
    t = np.arange(WHITE.size) / rate_Hz
    spectrum = noise_spectrum(t, 3.0 * WHITE + 50.0 * t - 0.2 * t**2, 1024.0 / rate_Hz)
    share = spectrum.frequency_Hz / rate_Hz
    wide = (share > 0.2) & (share < 0.45)  # many frequencies, whose quantile is near the mean
    assert np.count_nonzero(wide) > 4
    assert spectrum.power[wide] == pytest.approx(np.full(wide.sum(), 18.0 / rate_Hz), rel=0.2)
    assert spectrum.is_noise[wide].all()
    assert not spectrum.is_steady[share < 0.05].all()
    assert (share[0], share[-1]) == pytest.approx((2.5 / 1024.0, 0.47), rel=0.05)


def test_a_line_is_steady_and_a_motion_is_no_noise():
    t = np.arange(8000) / 200.0
    line = noise_spectrum(t, 0.1 * WHITE[:8000] + np.sin(2.0 * np.pi * 31.25 * t), 0.64)
    at = int(np.argmax(line.power))
    assert line.frequency_Hz[at] == pytest.approx(31.25, rel=0.1)
    assert line.is_steady[at]
    grows = t / 40.0 * np.sin(2.0 * np.pi * 5.0 * t)
    moved = noise_spectrum(t, 1e-4 * WHITE[:8000] + grows, 0.64)
    assert not moved.is_noise[moved.frequency_Hz < 7.0].any()
    assert moved.is_noise[moved.frequency_Hz > 30.0].all()


@pytest.mark.parametrize(("samples", "known"), [(176, True), (175, False)])
def test_a_spectrum_needs_ten_segments_of_32_rows_that_overlap_by_half(samples, known):
    found = noise_spectrum(np.arange(samples) / 100.0, WHITE[:samples], 0.1)
    assert (found is not None) == known


@pytest.mark.parametrize("count", [17, 60, 400])
def test_bands_are_a_quarter_of_an_octave_or_two_frequencies_and_overlap_by_half(count):
    bands = _bands(count)
    assert (bands[0].start, bands[-1].stop) == (2, count)
    for band, following in pairwise(bands):
        width = max(2, round(0.25 * band.start))
        assert band.stop == min(band.start + width, count)
        assert following.start - band.start == width // 2


# Up 10, back by a part, up again, down: a corner each second.
def signals(back=1.9, noise=0.0, load="spring", zero=0.0, **channels):
    corners = np.array([0.0, 10.0, 10.0 - back, 10.0, 0.0, 10.0])
    t = np.arange(501) / 100.0
    x = np.interp(t, np.arange(6.0), corners) + zero
    columns = {"time_s": t, "x_in_mm": x} | {n: of(x) for n, of in channels.items()}
    found = trial(columns, load=load)
    sizes = {n: replace(s, noise=noise, step=0.0) for n, s in found.sizes.items()}
    return replace(found, overall=sizes)


@pytest.mark.parametrize(
    ("back", "corners"), [(1.9, [0, 100, 400, 500]), (2.1, [*range(0, 501, 100)])]
)
def test_a_stroke_ends_where_the_drive_goes_back_by_a_fifth(back, corners):
    found = signals(back, zero=-5.0)
    assert [(s.start, s.stop) for s in found.strokes] == list(pairwise(corners))
    assert [s.direction for s in found.strokes] == [1, -1, 1, -1, 1][-len(corners) + 1 :]
    assert found.strokes[-1].rows == slice(400, 501)
    assert found.stroke_s == pytest.approx(1.0)


def test_the_direction_is_told_between_three_tenths_and_the_end_of_a_stroke():
    direction = signals(5.0).direction
    assert np.flatnonzero(direction[:101]).tolist() == list(range(31, 95))
    assert (direction[131:195] == -1.0).all()
    assert np.count_nonzero(direction[:301]) == 3 * 64


def test_a_channel_follows_by_the_share_of_its_changes():
    found = signals(
        5.0, x_out_mm=lambda x: 3.0 * x, f_in_N=lambda x: -x, f_out_N=lambda x: np.abs(x - 5.0)
    )
    assert found.follows("x_out_mm") == pytest.approx(1.0)
    assert found.follows("f_in_N") == pytest.approx(-1.0)
    # Of |x − 5| the strokes 0 to 10 end where they begin, the two between go by 5 with it.
    assert found.follows("f_out_N") == pytest.approx(1.0)
    # Changes of 10, 5, 5, 10 and 10 mm: a mean of 8; visible is six times the noise.
    for noise, seen in ((8.0 / 6.0 - 0.01, True), (8.0 / 6.0 + 0.01, False)):
        loud = replace(found, overall={"x_in_mm": found.sizes["x_in_mm"]} | {
            n: Size(noise, 0.0, 10.0, 0.0, 10.0) for n in ("x_out_mm", "f_in_N", "f_out_N")
        })  # fmt: skip
        assert (loud.follows("f_in_N") is not None) == seen
        assert loud.visible("f_in_N") == pytest.approx(6.0 * noise)


@pytest.mark.parametrize(
    ("size", "moves", "noisy"),
    [
        (Size(0.1, 0.0, 1.21, 0.0, 1.0), True, True),
        (Size(0.1, 0.0, 1.19, 0.0, 1.0), False, True),
        (Size(0.1, 0.0499, 1.41, 0.0, 1.0), True, True),
        (Size(0.1, 0.0501, 1.39, 0.0, 1.0), False, False),
        (Size(1.1e-5, 0.0, 1.0, 0.0, 1.0), True, True),
        (Size(0.9e-5, 0.0, 1.0, 0.0, 1.0), True, False),
    ],
)
def test_what_moves_and_what_has_the_noise_of_a_sensor(size, moves, noisy):
    """Twice what is visible, six noise levels and two steps; twice a step, and no rounding."""
    columns = {"time_s": np.arange(99.0), "x_in_mm": WHITE[:99]}
    found = replace(trial(columns), overall={"x_in_mm": size})
    assert (found.moves("x_in_mm"), found.is_noisy("x_in_mm")) == (moves, noisy)


CURVE = np.arange(60.0)


@pytest.mark.parametrize("step_s", [1.0, 0.01])
def test_jumps_are_those_between_two_parabolas(step_s):
    """Of 4 from row 30 on, beside a parabola: to the last digit, and none elsewhere.

    What it changes by at once is beyond the larger change beside it: of the parabola, 0.04 less.
    """
    smooth = 3.0 + 0.7 * CURVE - 0.02 * CURVE**2
    found = rows._jumps(smooth + 4.0 * (CURVE >= 30.0), 6, step_s)
    expected = np.zeros(60 - 11)
    expected[30 - 6] = 4.0
    far = np.abs(np.arange(49) - 24) >= 6
    assert found.jump[24] == pytest.approx(4.0)
    assert found.at_once[24] == pytest.approx(4.0 - 0.04)
    assert found.at_once[far] == pytest.approx(0.0, abs=1e-9)
    assert found.jump[far] == pytest.approx(expected[far], abs=1e-9)
    slope = (0.7 - 0.04 * (5.5 + np.arange(49.0))) / step_s  # between two rows
    for side in (found.before, found.after):
        assert side[far] == pytest.approx(slope[far])
        assert side[24] == pytest.approx(slope[24])
    assert found.usual == 1e-12
    noisy = rows._jumps(WHITE[:4000], 6, step_s)
    assert noisy.usual == pytest.approx(float(np.std(noisy.jump)), rel=0.1)
    assert noisy.slope_sd == pytest.approx(float(np.std(noisy.before)), rel=0.1)


@pytest.mark.parametrize("step", [0.3, 0.5])
def test_the_chance_that_a_row_repeats_is_the_share_that_does(step):
    """Of two channels: the product of both."""
    a, b = (np.round(RNG.standard_normal(60_000) / step) * step for _ in range(2))
    columns = {"time_s": np.arange(a.size) / 100.0, "x_in_mm": a, "f_in_N": b}
    same = (np.diff(a) == 0.0) & (np.diff(b) == 0.0)
    chances = rows._chances(trial(columns), np.ones(a.size, dtype=bool))
    assert chances.size == a.size // 32
    # The largest of three neighbouring blocks is somewhat above the mean.
    assert 1.0 < float(np.median(chances)) / float(same.mean()) < 2.2
    quiet = columns | {"x_in_mm": np.round(0.2 * a), "f_in_N": np.round(0.2 * b)}
    assert (rows._chances(trial(quiet), np.ones(a.size, dtype=bool)) == 1.0).mean() > 0.9


@pytest.mark.parametrize(("factor", "near"), [(1.39, True), (1.41, False), (1 / 1.39, True)])
@pytest.mark.parametrize("unit", [1 / 25.4, 10.0])
def test_a_ratio_is_near_that_of_two_units(factor, unit, near):
    found = list(pairs._suspect_unit(factor * unit, "is {:.3g}", pairs._TRAVEL, 1.4))
    expected = pairs._TRAVEL[unit]
    assert [f.sentence for f in found] == [f"is {factor * unit:.3g}; {expected}"] * near
    assert [f.column for f in found] == [expected.split()[0]] * near
    for nothing in (None, 0.0, -1.0, math.inf, math.nan):
        assert not list(pairs._suspect_unit(nothing, "is {}", pairs._TRAVEL, 1.4))


@pytest.mark.parametrize(("force_N", "halved"), [(90.0, True), (110.0, False)])
def test_a_drive_moves_twice_as_far_as_its_tendon_can_stretch(force_N, halved):
    """5 of 10 mm are lost: ten times what 200 mm of 1 mm² and 40 GPa stretch by at 100 N."""
    found = signals(5.0, x_out_mm=lambda x: 0.5 * x, f_in_N=lambda x: 30.0 + force_N / 10.0 * x)
    sheet = {"tendon_modulus_GPa": 40.0, "tendon_diameter_mm": 2.0 / math.sqrt(math.pi)}
    for changes, said in (({}, halved), ({"tendon_diameter_mm": None}, False)):
        rig = found.rig.model_copy(update=sheet | changes)
        run = found.recording.run.model_copy(update={"sheath_length_mm": 200.0})
        one = replace(found, rig=rig, recording=replace(found.recording, run=run))
        for travel, likely in ((0.5, said), (0.59, said), (0.61, False), (0.41, False)):
            lost = 10.0 * (1.0 - travel)
            far = lost > 10.0 * force_N * 200.0 / 40e3
            remarks = list(pairs._halved(one, travel))
            assert len(remarks) == (likely and far)
            assert all(f"the {lost:.3g} mm that are lost" in r.sentence for r in remarks)
        assert list(pairs._halved(one, None)) == []


@pytest.mark.parametrize(("up", "down"), [(0.5, 1.25), (0.8, 0.8), (2.0, 0.5)])
def test_the_level_of_the_tensions_is_the_geometric_mean_of_both_ways(up, down):
    found = signals(5.0, f_in_N=lambda x: 20.0 + x, f_out_N=lambda x: 20.0 + x)
    way = np.where(np.gradient(found.channels["x_in_mm"]) > 0.0, up, down)
    columns = found.recording.columns
    changed = {**columns, "f_out_N": columns["f_out_N"] * way}
    one = trial(changed)
    assert pairs._tension_ratio(one) == pytest.approx(math.sqrt(up * down))
    assert pairs._tension_ratio(trial({**changed, "f_out_N": -changed["f_out_N"]})) is None


def test_a_slope_is_that_of_a_scaled_copy_alone():
    found = signals(5.0, x_out_mm=lambda x: 4.0 - 0.3 * x, f_out_N=lambda x: (x - 5.0) ** 2)
    assert pairs._slope(found, "x_in_mm", "x_out_mm") == pytest.approx(0.3)
    assert pairs._slope(found, "x_in_mm", "f_out_N") is None


@pytest.mark.parametrize(
    ("batches", "ratio", "found"),
    [(5, 9.0, True), (4, 9.0, False), (9, 2.6, True), (9, 2.4, False)],
)
def test_five_long_intervals_are_batches_if_the_motion_goes_on_evenly(batches, ratio, found):
    """Of four rows each, 1 ms apart: the wrong times are those of the rows within a batch."""
    interval = 1e-3 * np.append(np.tile([1.0, 1.0, 1.0, ratio], batches), [1.0, 1.0, 1.0])
    time_s = np.append(0.0, np.cumsum(interval))
    even = 2.0 * np.arange(time_s.size)
    told = batches_of(time_s, {"x_in_mm": even})
    assert (told is not None) == found
    if told is not None:
        assert (told.rows, told.within_s, told.between_s) == pytest.approx((4, 1e-3, ratio * 1e-3))
        assert told.row_s == pytest.approx(1e-3 * (3.0 + ratio) / 4.0)
        off = told.error_s[4:-4] - told.error_s[4:-4].mean()
        assert np.ptp(off) == pytest.approx(3.0 * (told.row_s - told.within_s), rel=1e-6)
    jumping = even + 9.0 * np.cumsum(np.append(0.0, interval > 2e-3))
    assert batches_of(time_s, {"x_in_mm": jumping}) is None
    assert batches_of(time_s, {}) is None
    assert batches_of(time_s[::-1], {"x_in_mm": even}) is None
