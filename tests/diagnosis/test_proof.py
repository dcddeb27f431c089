"""What an effect fails to prove."""

from dataclasses import replace

import numpy as np
import pytest

from tsas_cli.diagnosis.constancy import Split
from tsas_cli.diagnosis.evidence import Reduction
from tsas_cli.diagnosis.proof import BY_NAME, failures, may_be_zero, split_in_words
from tsas_cli.diagnosis.refitted import HeldOutFit
from tsas_cli.identification.estimate import Estimate

CLEAR, CHANCE = Reduction(0.5, 9.0), Reduction(0.5, 2.0)
NOISE = {"f_in_N": 0.05, "x_out_mm": 0.01}


def errors(rmse, noise=NOISE):
    return HeldOutFit(rmse, {n: v / noise[n] for n, v in rmse.items()}, np.zeros(0), {}, {})


SAME_N_mm = {"f_in_N": 0.1, "x_out_mm": 0.01}
SAME = errors(SAME_N_mm)


def estimate(name, value, low, high, *, unit="N", at_bound=False):
    return Estimate(name, value, unit, "fitted", None, 0.1, low, high, at_bound)


OFFSETS = (
    estimate("force_sensor_offset.f_in_offset_N", 1.0, 0.9, 1.1),
    estimate("force_sensor_offset.f_out_offset_N", 0.01, -0.1, 0.12),
)


def of(*offsets, gain=CLEAR, after=SAME_N_mm):
    zero = may_be_zero("force_sensor_offset", offsets)
    return failures("force_sensor_offset", offsets, gain, SAME, errors(after), zero=zero)


def test_one_size_that_is_not_neutral_and_a_gain_are_enough():
    assert of(*OFFSETS) == ()


def test_an_effect_whose_every_interval_holds_the_neutral_value_may_be_zero():
    zero = estimate("force_sensor_offset.f_in_offset_N", 0.05, -0.01, 0.11)
    (said,) = of(zero, OFFSETS[1])
    assert said.startswith("may not be there: f_in_offset_N 0.05 [-0.01, 0.11] N")


@pytest.mark.parametrize("known", [True, False])
def test_a_size_of_which_nothing_is_known_is_not_listed(known):
    parameter = BY_NAME["force_sensor_offset"].parameters[0]
    ends = (-0.01, 0.11) if known else (parameter.lower, parameter.upper)
    (said,) = of(estimate("force_sensor_offset.f_in_offset_N", 0.05, *ends))
    assert ("f_in_offset_N" in said) == known
    assert ("nothing is known" in said) != known


def test_an_effect_of_whose_size_nothing_is_known_is_refused_whatever_its_shape_tells():
    share = estimate("force_sensor_hysteresis.f_in_share", 0.28, 0.0, 0.5)
    (said,) = failures("force_sensor_hysteresis", [share], CLEAR, SAME, SAME)
    assert said == "may not be there: nothing is known of its size"


def test_two_offsets_of_which_only_the_sum_is_known_are_not_both_zero():
    sum_known = np.array([[1.0, -0.99], [-0.99, 1.0]])
    two = (
        estimate("force_sensor_offset.f_in_offset_N", 0.85, -0.15, 1.85),
        estimate("force_sensor_offset.f_out_offset_N", 0.75, -0.25, 1.75),
    )
    assert may_be_zero("force_sensor_offset", two)
    assert not may_be_zero("force_sensor_offset", two, sum_known)
    unknown = -sum_known + 2.0 * np.eye(2)
    assert may_be_zero("force_sensor_offset", two, unknown)


def test_a_gain_has_its_neutral_value_at_one():
    def gain(low, high):
        value = estimate("force_sensor_gain.f_out_gain", 1.02, low, high, unit="1")
        zero = may_be_zero("force_sensor_gain", (value,))
        return failures("force_sensor_gain", (value,), CLEAR, SAME, SAME, zero=zero)

    assert gain(1.01, 1.03) == ()
    assert gain(0.99, 1.05)


def test_the_gain_has_to_hold_with_a_new_fit():
    assert of(*OFFSETS, gain=CHANCE) == ("gains too little on held-out data with a new fit",)


def test_no_channel_may_become_worse():
    assert of(*OFFSETS, after={"f_in_N": 0.05, "x_out_mm": 0.0102}) == ()
    (said,) = of(*OFFSETS, after={"f_in_N": 0.05, "x_out_mm": 0.011})
    assert said == "makes x_out_mm worse on held-out data (0.01 to 0.011)"


def test_a_channel_may_become_a_little_worse_where_another_gains_far_more():
    before, after = {"f_in_N": 1.0, "x_out_mm": 0.01}, {"f_in_N": 0.05, "x_out_mm": 0.011}
    assert failures("force_sensor_offset", OFFSETS, CLEAR, errors(before), errors(after)) == ()
    after["x_out_mm"] = 0.04
    assert failures("force_sensor_offset", OFFSETS, CLEAR, errors(before), errors(after))


def test_a_channel_is_worse_where_its_normalised_residual_is_too():
    """At a steep reversal a small error of x_in is a large one of f_in, and weighs little."""
    before, after = errors({"f_in_N": 0.1, "x_out_mm": 0.01}), {"f_in_N": 0.2, "x_out_mm": 0.01}
    worse = errors(after)
    steep = replace(worse, normalised=before.normalised | {"f_in_N": 1.9})
    assert failures("force_sensor_offset", OFFSETS, CLEAR, before, worse)
    assert failures("force_sensor_offset", OFFSETS, CLEAR, before, steep) == ()


@pytest.mark.parametrize(("tolerance_N", "refused"), [(0.028, False), (0.026, True)])
def test_a_rise_within_a_load_cells_tolerance_is_none(tolerance_N, refused):
    """0.1036² − 0.1² is 0.0271²; one of another channel has no such tolerance."""
    before, after = {"f_in_N": 0.1, "x_out_mm": 0.01}, {"f_in_N": 0.1036, "x_out_mm": 0.01}
    noise = {"f_in_N": 0.01, "x_out_mm": 0.01}
    rest = "force_sensor_offset", OFFSETS, CLEAR, errors(before, noise), errors(after, noise)
    assert bool(failures(*rest, tolerance_N={"f_in_N": tolerance_N})) == refused
    assert failures(*rest, tolerance_N={"f_out_N": 1.0})


@pytest.mark.parametrize(("value", "refused"), [(1e-6, False), (1e9, True)])
def test_a_size_at_the_limit_is_refused_and_one_near_nothing_is_not(value, refused):
    friction = estimate("drive_friction.friction_N", value, value / 2, value, at_bound=True)
    said = failures("drive_friction", (friction,), CLEAR, SAME, SAME)
    assert bool(said) == refused


@pytest.mark.parametrize(("low", "high", "refused"), [(-1.9, -0.9, True), (-1.8, -0.9, False)])
def test_a_size_that_is_known_up_to_the_limit_alone_is_refused(low, high, refused):
    slope = estimate("uneven_friction.slope", -1.5, low, high, unit="1")
    said = failures("uneven_friction", (slope,), CLEAR, SAME, SAME)
    assert said == (
        ("has slope up to the limit of what is plausible: -1.5 [-1.9, -0.9]",) * refused
    )


@pytest.mark.parametrize(("f_out", "refused"), [(1.09, True), (1.12, False), (-1.0, False)])
def test_an_offset_that_is_the_same_for_both_sensors_may_be_friction(f_out, refused):
    """A friction of μ(T + c) is the capstan's with c added to both forces."""
    f_in = estimate("force_sensor_offset.f_in_offset_N", 1.0, 0.99, 1.01)
    both = f_in, estimate("force_sensor_offset.f_out_offset_N", f_out, f_out - 0.01, f_out + 0.01)
    said = of(*both)
    assert bool(said) == refused
    if refused:
        assert said[0].startswith("is the same for both sensors (1 and 1.09 N), which friction")
    assert of(f_in) == ()


@pytest.mark.parametrize(
    ("effect", "parameter", "refused"),
    [
        ("tilt", "per_mm", True),
        ("gain_drift", "rate_per_s", True),
        ("hysteresis", "share", True),
        ("curvature", "per_N", False),
    ],
)
def test_what_is_the_same_for_both_sensors_may_be_of_the_tendon(effect, parameter, refused):
    """A force along the way is a tilt of both; a load that softens takes a share of both."""
    name = f"force_sensor_{effect}"
    both = [estimate(f"{name}.{f}_{parameter}", 0.01, 0.009, 0.011) for f in ("f_in", "f_out")]
    assert bool(failures(name, both, CLEAR, SAME, SAME)) == refused
    apart = [replace(both[0], value=0.0099), replace(both[1], value=0.0085)]
    assert failures(name, apart, CLEAR, SAME, SAME) == ()
    unsure = [replace(e, interval_low=0.004, interval_high=0.012) for e in apart]
    failed = failures(name, unsure, CLEAR, SAME, SAME)
    assert bool(failed) == refused
    far = [unsure[0], replace(unsure[1], value=0.0079)]
    assert failures(name, far, CLEAR, SAME, SAME) == ()
    assert not failed or failed[0].startswith("may be the same for both sensors (0.0099 and 0.0085")


@pytest.mark.parametrize(("f_out", "refused"), [(0.0104, True), (0.02, False)])
def test_of_two_drifts_only_one_that_is_there_is_compared_between_sensors(f_out, refused):
    """Within the runs nothing is known of either; over the session both are."""
    drifts = [
        estimate(f"force_sensor_drift.{name}_N_per_s", size, size - apart, size + apart)
        for name, size, apart in (
            *(("f_in_rate", 0.001, 1.0), ("f_out_rate", 0.001, 1.0)),
            *(("f_in_session_rate", 0.01, 0.001), ("f_out_session_rate", f_out, 0.001)),
        )
    ]
    assert bool(failures("force_sensor_drift", drifts, CLEAR, SAME, SAME)) == refused


@pytest.mark.parametrize("effect", ["drive_ripple", "load_ripple", "position_sensor_ripple"])
def test_a_wave_that_may_not_repeat_within_the_strokes_is_refused(effect):
    sine = estimate(f"{effect}.sine_mm", 0.1, 0.09, 0.11, unit="mm")
    period = estimate(f"{effect}.period_mm", 8.0, 7.9, 8.1, unit="mm")
    rest = (sine, period), CLEAR, SAME, SAME
    assert failures(effect, *rest) == failures(effect, *rest, stroke_mm=12.2) == ()
    (said,) = failures(effect, *rest, stroke_mm=12.1)
    assert said == "has a period of up to 8.1 mm, which strokes of 12.1 mm hardly repeat"
    at_bound = replace(period, at_bound=True)
    (said,) = failures(effect, (sine, at_bound), CLEAR, SAME, SAME)
    assert said == "has period_mm at the limit of what is plausible (8 mm)"


def test_a_split_is_said_with_its_values():
    over = Split("drive_friction.friction_N", "direction", CLEAR, (("pulling", 0.8), ("x", 2.1)))
    assert split_in_words(over) == "over the direction: friction_N 0.8 (pulling) and 2.1 (x) N"
    near = replace(over, values=(("pulling", 0.99612), ("x", 0.99648)))
    assert "0.9961 (pulling) and 0.9965 (x)" in split_in_words(near)
    runs = Split("force_sensor_gain.f_out_gain", "run", CLEAR, (("run a", 1.0), ("run b", 1.04)))
    assert split_in_words(runs) == "from run to run: f_out_gain 1 (run a) and 1.04 (run b)"
    five = tuple(zip("abcde", (3.0, 1.0, 2.0, 5.0, 4.0), strict=True))
    assert split_in_words(replace(runs, values=five)).endswith("f_out_gain 1 (b) and 5 (d)")
    assert split_in_words(replace(runs, values=five[:4])).endswith("3 (a), 1 (b), 2 (c) and 5 (d)")


def test_only_an_effect_with_a_size_may_be_zero_also_where_its_interval_is_cut_there():
    assert may_be_zero("drive_friction", [estimate("drive_friction.friction_N", 0.5, 0.0, 1.7)])
    assert not may_be_zero("drive_friction", [estimate("drive_friction.friction_N", 0.5, 0.1, 0.9)])
    assert not may_be_zero("drive_friction", [estimate("drive_friction.friction_N", 0.5, 0.5, 0.9)])
    assert not may_be_zero("drive_friction", [estimate("preload_N", 0.0, -1.0, 1.0)])


def test_a_size_that_is_known_at_each_shape_is_not_zero():
    """Only the product of share and rate is known: neither alone, and not zero."""
    known = [
        estimate("load_relaxation.share", 0.9, 0.0, 3.3),
        estimate("load_relaxation.time_s", 20.0, 1.0, 80.0),
    ]
    assert may_be_zero("load_relaxation", known)
    assert may_be_zero("load_relaxation", known, np.array([[1.0, 0.5], [0.5, 1.0]]))
    assert not may_be_zero("load_relaxation", known, np.array([[1.0, 0.99], [0.99, 1.0]]))


@pytest.mark.parametrize(
    ("parameter", "values", "of_one"),
    [
        ("load_inertia.mass_kg", (1.33, 0.76, 0.48), False),
        ("drive_friction.friction_N", (27.5, 36.6, 45.6), True),
        ("force_sensor_offset.f_in_offset_N", (-25.0, -23.5, -21.7), True),
        ("force_sensor_offset.f_in_offset_N", (-0.1, 0.1, 0.11), False),
        ("position_sensor_gain.x_out_gain", (0.95, 0.99), False),  # from 1: 5 % and 1 %
        ("stribeck_friction.velocity_mm_per_s", (5.1, 7.4, 9.1), True),  # its size is the excess
    ],
)
def test_an_effect_of_another_law_is_about_as_large_everywhere(parameter, values, of_one):
    parts = tuple(zip("abc", values, strict=False))
    assert Split(parameter, "speed", CLEAR, parts).of_one_size() == of_one
