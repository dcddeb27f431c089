"""Each check's limits, by its own definition: nothing just below, a finding just above."""

from dataclasses import replace

import numpy as np
import pytest

from tests.recordings.quality.bench import trial
from tests.recordings.quality.even_runs import FINE, WAY, WHITE, N, X, are, fine, of
from tsas_cli.recordings.quality.checks import delay, extremes, motion, pairs, signs
from tsas_cli.recordings.quality.finding import Finding


@pytest.mark.parametrize(
    ("step", "said"), [(0.0199, None), (0.0201, "note"), (0.199, "note"), (0.201, "warning")]
)
def test_steps_are_coarse_from_a_500th_of_the_span_on(step, said):
    size = replace(FINE, step=step)
    told = of(extremes.quantised, sizes={"f_out_N": size}, f_out_N=WHITE)
    assert [f.severity for f in told] == [said] * bool(said)
    for noise_N, found in ((0.49 * step, bool(said)), (0.51 * step, False)):
        sizes = {"f_out_N": replace(size, noise=noise_N)}
        assert bool(of(extremes.quantised, sizes=sizes, f_out_N=WHITE)) == found
    forced = of(extremes.quantised, sizes={"f_out_N": size}, load="force", f_out_N=WHITE)
    assert [f.severity for f in forced] == ["note"] * bool(said)
    are(told, bool(said), f"steps of {step:.4g} N, {10 * step:.2g} % of its range of 10 N")


@pytest.mark.parametrize(
    ("low", "high", "noise_N", "found"),
    [
        (-0.21, 9.0, 0.0, True),
        (-0.19, 9.0, 0.0, False),
        (-0.59, 9.0, 0.1, False),
        (-0.61, 9.0, 0.1, True),
        (-5.0, -0.61, 0.1, False),  # it has the wrong sign
        (-5.0, -0.59, 0.1, True),
    ],
)
def test_a_tension_is_negative_beyond_what_a_slack_tendon_reads(low, high, noise_N, found):
    values = np.where(np.arange(N) < 100, low, high)
    sizes = {"f_in_N": replace(FINE, noise=noise_N)}
    told = of(signs.negative_tension, sizes=sizes, f_in_N=values)
    are(told, found, *(["negative in 25 % of the samples"] if high > 0.0 else []))


@pytest.mark.parametrize(("rig", "found"), [({}, 1), ({"antagonist_preload_N": 20.0}, 0)])
def test_a_difference_of_two_tendons_may_be_negative(rig, found):
    time_s = np.arange(N) / 100.0
    values = {"time_s": time_s, "x_in_mm": time_s, "f_in_N": 2.0 + 7.0 * np.sin(time_s)}
    told = signs.negative_tension(trial(values, rig))
    assert sum(isinstance(one, Finding) for one in told) == found


@pytest.mark.parametrize(("friction", "found"), [(0.31, False), (-0.29, False), (-0.31, True)])
def test_tensions_are_exchanged_where_friction_is_negative_by_a_thirtieth(friction, found):
    """f_in = 3 + 1.5 f_out ± half of it; a gain and an offset do not matter."""
    f_out = 20.0 + X + 0.3 * np.sin(0.7 * np.arange(N))
    f_in = 3.0 + 1.5 * f_out + 0.5 * friction * WAY
    told = of(signs.exchanged, x_in_mm=X, f_in_N=f_in, f_out_N=f_out)
    are(told, found, f"f_in_N is {-friction:.3g} N lower in contraction")


@pytest.mark.parametrize(("part", "found"), [(0.77, 0), (0.79, 2)])
def test_motion_is_steady_where_the_load_moves_in_a_fifth_of_a_stroke(part, found):
    """It rests over a part of each stroke."""
    up, down = np.maximum(X - 10.0 * part, 0.0), np.minimum(X, 10.0 * (1.0 - part))
    told = of(motion.no_steady_motion, x_in_mm=X, x_out_mm=np.where(WAY > 0.0, up, down))
    both = ["no steady contraction", "no steady loosening"]
    assert [f.sentence.split(":")[0] for f in told] == both[:found]


def test_the_share_of_a_stroke_in_which_the_load_moves():
    for x_out, share in ((X, 0.98), (np.maximum(X - 4.0, 0.0), 0.58)):
        one = fine(x_in_mm=X, x_out_mm=x_out)
        assert motion._moving(one, "x_out_mm", one.strokes[0]) == pytest.approx(share, abs=0.011)


def turning(samples):
    """Return time, x_in, its direction, and a load that rests while the drive turns."""
    t = 0.002 * np.arange(samples)
    x = 5.0 + 5.0 * np.interp(np.mod(t, 2.0), [0.0, 1.0, 2.0], [-1.0, 1.0, -1.0])
    way = np.where(np.mod(t, 2.0) < 1.0, 1.0, -1.0)
    return t, x, way, np.where(way > 0.0, np.maximum(x - 2.0, 0.0), np.minimum(x, 8.0))


@pytest.mark.parametrize("size", [0.5, -0.5])
def test_an_interference_is_the_jump_at_each_reversal_with_the_drive(size):
    """The load rests while the drive turns, on a straight line before."""
    t, x, way, load = turning(3001)
    found = fine(t, x_in_mm=x, f_out_N=load + 0.5 * size * way)
    jumps = motion._jumps(found, found.channels["f_out_N"], 0.0)
    assert jumps == pytest.approx(np.full(5, size), abs=1e-9)


@pytest.mark.parametrize(("rests", "said"), [(4, True), (3, False)])
def test_an_interference_shows_at_half_of_the_reversals(rests, said):
    """Of seven; from some time on the load follows the drive at once, so that no jump is seen."""
    t, x, way, load = turning(4001)
    jumping = np.where(t < rests + 0.7, load + 0.5 * way, x)
    read = jumping + 0.01 * np.random.default_rng(3).standard_normal(t.size)
    found = replace(fine(t, x_in_mm=x, f_out_N=read), overall={})  # sizes of its own
    assert (list(motion.interference(found)) != []) == said


@pytest.mark.parametrize(
    ("step_s", "stroke_s", "said"),
    [
        (0.21, 501.0, "millisecond"),
        (0.19, 501.0, None),
        (0.21, 499.0, None),
        (200.0, 9e5, "microsecond"),
        (199.0, 9e5, "millisecond"),
    ],
)
def test_times_look_like_another_unit_where_steps_and_strokes_are_long(step_s, stroke_s, said):
    turn = round(stroke_s / step_s)
    k = np.arange(2 * turn + 1)
    x = 10.0 * np.minimum(k, 2 * turn - k) / turn
    stroke_s = turn * step_s
    told = [f for f in of(pairs.unit, step_s * k, x_in_mm=x) if f.column == "time_s"]
    expected = said if stroke_s > 500.0 else None
    assert [f.sentence.rpartition(" ")[2] for f in told] == [expected] * bool(expected)


@pytest.mark.parametrize(
    ("step_s", "rows", "said"), [(4.9e-5, 390, 1), (5.1e-5, 380, 0), (4e-5, 501, 0)]
)
def test_times_look_divided_where_steps_and_strokes_are_short(step_s, rows, said):
    k = np.arange(2 * rows + 1)
    x = 10.0 * np.minimum(k, 2 * rows - k) / rows
    told = [f for f in of(pairs.unit, step_s * k, x_in_mm=x) if f.column == "time_s"]
    assert len(told) == said


@pytest.mark.parametrize(("late", "found"), [(0.16, False), (0.14, True)])
def test_a_tension_is_coupled_to_ac_where_its_mean_falls_to_a_seventh_of_its_span(late, found):
    swing = 3.0 * (-1.0) ** np.arange(N)
    f_in = np.where(np.arange(N) < 150, 6.0, 10.0 * late) + swing
    told = of(extremes.ac_coupled, x_in_mm=X, f_in_N=f_in, preload_N=25.0)
    are(told, found, f"a mean of {10.0 * late:.2g} N")


@pytest.mark.parametrize("gain", [1.5, -0.5])
def test_friction_beside_any_gain_is_told_and_a_negative_gain_is_none(gain):
    f_out = 20.0 + X
    made = fine(x_in_mm=X, f_out_N=f_out, f_in_N=40.0 + gain * f_out + 0.35 * WAY)
    travel = np.abs(np.gradient(X))
    up, down = (
        np.average(f_out[at], weights=travel[at])
        for at in (made.direction == 1.0, made.direction == -1.0)
    )
    shift = gain * (up - down) if gain < 0.0 else 0.0  # what the directions differ by themselves
    assert signs._excess_while_pulling(made, "f_in_N", "f_out_N") == pytest.approx(
        0.7 + shift, abs=1e-9
    )


@pytest.mark.parametrize("delay_s", [-0.02, 0.0, 0.05])
def test_a_delay_is_what_follows_the_speed_beside_a_bent_spring_and_friction(delay_s):
    """y = 3 + 2 x + 0.1 x² + 0.4 sgn(v) − 2 τ v, x from the middle of what is moving."""
    t = np.linspace(0.0, 6.0, 600)
    x = 4.0 * np.sin(t) + 0.5 * np.sin(2.7 * t)
    v = np.gradient(x, t)
    x -= x[np.abs(v) > 0.3 * np.sqrt(np.mean(v**2))].mean()
    y = 3.0 + 2.0 * x + 0.1 * x**2 + 0.4 * np.sign(v) - 2.0 * delay_s * v
    assert delay._remaining_delay(t, x, y) == pytest.approx(delay_s, abs=1e-9)
    loud = np.random.default_rng(3).standard_normal(600) * np.std(y)
    assert delay._remaining_delay(t, x, y + 0.03 * loud) == pytest.approx(delay_s, abs=0.01)
    assert np.isnan(delay._remaining_delay(t, x, y + 0.06 * loud))
    ramp = 2.0 * t  # its speed is the constant
    assert np.isnan(delay._remaining_delay(t, ramp, 3.0 * ramp))


@pytest.mark.parametrize(("held", "found"), [(19, 0), (20, 1)])
def test_a_noisy_channel_is_stuck_that_misses_twenty_updates(held, found):
    f_in = 2.0 * X + 0.1 * WHITE
    f_in[40 : 40 + held] = f_in[40]
    sizes = {"f_in_N": replace(FINE, highest=30.0, lowest=-9.0)}
    told = of(extremes.stuck, sizes=sizes, x_in_mm=X, f_in_N=f_in)
    assert [f.column for f in told] == ["f_in_N"] * found
    assert [f.first_s for f in told] == pytest.approx([0.4] * found)


@pytest.mark.parametrize(("back", "found"), [(3.0, 1), (4.0, 0)])
def test_a_sign_is_wrong_where_most_of_the_way_is_against_the_drive(back, found):
    """Three strokes of 10 mm against it, one with it: (30 − 3.3)/(30 + 3.3) is 0.8."""
    rate = np.where(np.arange(N) < 300, -1.0, 0.1 * back)
    x_out = np.cumsum(rate * np.diff(X, prepend=X[0]))
    told = of(signs.sign, x_in_mm=X, x_out_mm=x_out)
    assert [f.column for f in told] == ["x_out_mm"] * found
