"""The scatter between strokes of the same motion is that which was made."""

import math
from dataclasses import replace

import numpy as np
import pytest

from tests.identification.recorded import ran
from tsas_cli.identification.fitted_to import fitted_to
from tsas_cli.identification.repeatability import StrokeAtTravel, _scatter, repeatability
from tsas_cli.recordings.manifest import RigSheet

RATE_HZ, NOISE_N, NOISE_MM = 193, 0.1, 0.005  # samples that fall between those of other strokes


def run(amplitudes_mm=(10.0,) * 8, *, offsets_N=None, seed=0, stroke_s=2.0, run_id="a", **told):
    """Return strokes up and down, of each amplitude in turn; f_in has a loop, noise and offsets."""
    rng = np.random.default_rng(seed)
    corners = [0.0]
    for number, amplitude in enumerate(amplitudes_mm):
        corners.append(corners[-1] + (amplitude if number % 2 == 0 else -amplitude))
    time_s = np.arange(int(len(amplitudes_mm) * stroke_s * RATE_HZ)) / RATE_HZ
    x_mm = np.interp(time_s, np.arange(len(corners)) * stroke_s, corners)
    stroke = np.minimum((time_s / stroke_s).astype(int), len(amplitudes_mm) - 1)
    offsets = np.zeros(len(amplitudes_mm)) if offsets_N is None else np.asarray(offsets_N)
    pulling = np.where(stroke % 2 == 0, 1.0, -1.0)
    f_N = 50.0 + 2.0 * x_mm + 10.0 * pulling + offsets[stroke]
    columns = {"time_s": time_s, "x_in_mm": x_mm, "f_in_N": f_N + rng.normal(0, NOISE_N, x_mm.size)}
    columns["x_out_mm"] = x_mm - 0.5 * pulling + rng.normal(0, NOISE_MM, x_mm.size)
    return ran(columns, run_id=run_id, **told)


def found(*runs):
    ranges = [fitted_to(RigSheet(), [one]) for one in runs]
    return [channels["f_in_N"] for channels in repeatability(runs, ranges)]


def test_noise_alone_is_the_repeatability_of_strokes_that_repeat():
    (one,) = found(run())
    assert one == pytest.approx(NOISE_N, rel=0.1)  # and not the loop of 20 N


def test_x_out_repeats_where_strokes_begin_and_end_a_little_apart():
    """By 0.1 mm, twenty times the noise of x_out."""
    one = run((10.0, 9.9, 10.0, 10.1) * 3)
    (channels,) = repeatability([one], [fitted_to(RigSheet(), [one])])
    assert channels["x_out_mm"] == pytest.approx(NOISE_MM, rel=0.3)


@pytest.mark.parametrize(
    "amplitudes", [(10.0,), (10.0, 10.0), (10.0, 10.0, 10.0), (10.0, 9.0, 8.0, 7.0, 6.0, 5.0)]
)
def test_where_no_motion_repeats_nothing_is_claimed(amplitudes):
    assert found(run(amplitudes)) == [None]


@pytest.mark.parametrize("changed", [("start_mm", 0.2), ("end_mm", 0.2), ("duration_s", 0.2)])
def test_a_stroke_repeats_another_within_a_fiftieth_of_its_way_and_a_tenth_of_its_time(changed):
    one, (name, room) = StrokeAtTravel(5.0, -5.0, 2.0, {}), changed
    for sign in (-1.0, 1.0):
        for share in (0.99, 1.01):
            other = replace(one, **{name: getattr(one, name) + sign * share * room})
            assert other.repeats(one) == (share < 1.0)


def stroke(start_mm, end_mm, *values, name="f_in_N"):
    """Return a stroke of 2 s whose channel goes straight between values, at even travels."""
    travel_mm = np.linspace(0.0, abs(end_mm - start_mm), len(values))
    return StrokeAtTravel(start_mm, end_mm, 2.0, {name: (travel_mm, np.array(values))})


def test_the_scatter_is_that_of_all_strokes_about_the_mean_of_their_own_way():
    """Three pull, by 1, 0 and -1 N, two release, 3 N apart: (2 + 4.5)/(2 + 1) N²."""
    pulls = [stroke(0.0, 8.0, 10.0 + d, 30.0 + d) for d in (1.0, 0.0, -1.0)]
    releases = [stroke(8.0, 0.0, 5.0 + d, 5.0 + d) for d in (1.5, -1.5)]
    others = [stroke(0.0, 9.0, 0.0, 0.0), stroke(8.0, 0.0, 7.0, 7.0, name="f_out_N")]
    variance = (2.0 + 4.5) / 3.0
    found = _scatter([*pulls, *others, *releases], [*pulls, *others, *releases], "f_in_N", math.nan)
    assert found == pytest.approx(math.sqrt(variance))
    # Of another run's strokes only those count that repeat one of this run.
    assert _scatter(pulls[:1], pulls + releases, "f_in_N", math.nan) == pytest.approx(1.0)
    assert _scatter(pulls[:1], releases, "f_in_N", math.nan) is None


def test_values_between_samples_scatter_less_by_two_thirds():
    """Noise σ between two samples w apart has (w² + (1 − w)²) σ², 2/3 σ² on average."""
    same = [stroke(0.0, 8.0, 10.0, 30.0)] * 3
    assert _scatter(same, same, "f_in_N", 0.6) == pytest.approx(0.6 / math.sqrt(3.0))


def test_runs_of_the_same_conditions_repeat_each_other():
    pair = [run((10.0,) * 3, seed=k, run_id=f"{k}", total_bend_rad=1.0) for k in (1, 2)]
    assert found(*pair) == pytest.approx([NOISE_N] * 2, rel=0.15)
    bent = run((10.0,) * 3, seed=3, total_bend_rad=2.0)
    faster = run((10.0,) * 3, seed=3, stroke_s=1.0, total_bend_rad=1.0)
    for other in (bent, faster):
        assert found(pair[0], other) == [None, None]


def test_strokes_within_a_run_count_alone_where_they_repeat():
    same = {"total_bend_rad": 1.0}
    higher = run(seed=2, run_id="b", offsets_N=[0.8] * 8, **same)
    assert found(run(seed=1, **same), higher) == pytest.approx([NOISE_N] * 2, rel=0.1)


def test_a_run_that_is_driven_by_force_has_none():
    one = run()
    columns = {"time_s": one.time_s, "f_in_N": one.measured["f_in_N"]}
    columns |= {"x_out_mm": one.conditioned["x_in_mm"].values}
    driven = ran(columns)
    assert repeatability([driven], [fitted_to(RigSheet(), [driven])]) == [{"x_out_mm": None}]
