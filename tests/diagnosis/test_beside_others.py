"""What refuses a cause beside others; the causes are made up."""

import pytest

from tests.diagnosis.test_proof import estimate
from tsas_cli.diagnosis.beside_others import (
    beside_a_wave,
    beside_another_law,
    beside_its_opposite,
    beside_others_of_its_sensor,
    beside_what_is_left,
    may_be_anywhere,
)
from tsas_cli.diagnosis.proof import FoundCause
from tsas_cli.diagnosis.remainder import Remainder
from tsas_cli.identification.estimate import Estimate


@pytest.mark.parametrize(
    ("first", "second", "law", "refused"),
    [
        ("load_spring_nonlinearity", "load_ripple", "over the tension", True),
        ("load_spring_nonlinearity", "load_ripple", "", False),
        ("load_spring_nonlinearity", "drive_ripple", "over the tension", False),
        ("stribeck_friction", "sheath_compression", "over the speed", False),
        ("force_sensor_curvature", "force_sensor_tilt", "over the tension", True),
        ("force_sensor_curvature", "position_sensor_ripple", "over the tension", False),
    ],
)
def test_what_a_law_of_one_place_lacks_is_no_second_cause(first, second, law, refused):
    """Of two at one place the one that gains less is refused, where the other's law differs."""
    more = FoundCause(first, (), (), 60.0, (50.0, 70.0), law_differs=law)
    less = FoundCause(second, (), (), 40.0, (30.0, 50.0), law_differs=law)
    both = more, less
    assert beside_another_law(more, both) == more
    failed = beside_another_law(less, both).failed
    assert bool(failed) == refused
    assert not failed or "nonlinear load spring" in failed[0] or "curved scale" in failed[0]


@pytest.mark.parametrize(
    ("first", "last", "reducible", "structure", "refused"),
    [
        (401.0, 40.0, 39.0, 1.0, False),  # a tenth of 400, less a little
        (401.0, 42.0, 41.0, 1.0, True),
        (401.0, 1.0, 0.0, 1.0, False),
        (401.0, 42.0, 41.0, 0.0, False),
    ],
)
def test_where_much_is_left_no_effect_is_proven(first, last, reducible, structure, refused):
    """A lost motion at the drive passes for a gain of x_out that takes half of it."""
    start = Remainder(first, {"x_out_mm": 1.0}, ())
    after = Remainder(last, {"x_out_mm": structure}, (), reducible=reducible)
    cause = FoundCause("position_sensor_gain", (), (), 50.0, (40.0, 60.0))
    failed = beside_what_is_left(cause, start, after, 0.004).failed
    assert failed == (("leaves 10 % of what could be explained",) if refused else ())


@pytest.mark.parametrize(
    ("late_s", "complete", "refused"),
    [
        ((-0.0010, -0.0015), False, True),
        ((-0.0010, -0.0025), False, False),
        ((-0.0010, -0.0015), True, False),
    ],
)
def test_a_delay_within_half_a_sample_interval_is_no_cause_where_more_is_wrong(
    late_s, complete, refused
):
    names = ("f_in", "x_out")
    delays = tuple(
        Estimate(f"channel_delay.{name}_delay_s", late, "s", "fitted")
        for name, late in zip(names, late_s, strict=True)
    )
    cause = FoundCause("channel_delay", (), delays, 12.0, (8.0, 18.0))
    start, after = Remainder(9.0, {}, ()), Remainder(1.0, {"f_in_N": 0.0 if complete else 0.2}, ())
    assert bool(beside_what_is_left(cause, start, after, 0.004).failed) == refused


@pytest.mark.parametrize(
    ("period_mm", "gains", "refused"),
    [
        (2.345, 10.0, True),
        (1.6, 10.0, True),
        (3.4, 10.0, False),
        (4.8, 10.0, False),
        (2.1, 10.0, False),
        (2.345, 40.0, False),
    ],
)
def test_a_wave_of_half_the_period_of_a_larger_one_is_no_cause(period_mm, gains, refused):
    """A gear whose ripple has a harmonic passes for a position sensor off its centre."""

    def wave(effect, period, gain):
        periods = (estimate(f"{effect}.period_mm", period, period - 0.1, period + 0.1, unit="mm"),)
        return FoundCause(effect, (), periods, gain, (gain - 2.0, gain + 2.0))

    drive = wave("drive_ripple", 4.82, 30.0)
    cause = wave("position_sensor_ripple", period_mm, gains)
    plain = FoundCause("backlash", (), (), 50.0, (40.0, 60.0))
    failed = beside_a_wave(cause, (drive, cause, plain)).failed
    assert failed == (
        ("may be a harmonic of ripple of the drive's gear, or of its encoder",) * refused
    )


def sensor_error(effect, **values):
    """Return an error of sensors, by parameter whether it differs from none."""
    return FoundCause(
        *(effect, ()),
        tuple(
            estimate(f"{effect}.{name}", v, *sorted((0.9 * v, 1.1 * v)), unit="1")
            if v
            else estimate(f"{effect}.{name}", 0.0, -0.1, 0.1, unit="1")
            for name, v in values.items()
        ),
        *(40.0, (30.0, 50.0)),
    )


@pytest.mark.parametrize(("third", "refused"), [("f_out", True), ("f_in", False)])
def test_three_errors_of_one_sensor_may_be_one_law_of_it(third, refused):
    """A force sensor that creeps passes for one with a gain, hysteresis and a low pass."""
    gain = sensor_error("force_sensor_gain", f_out_gain=1.2)
    hysteresis = sensor_error("force_sensor_hysteresis", f_in_share=0.0, f_out_share=0.1)
    lag = sensor_error("sensor_lag", **{f"{third}_lag_s": 0.02})
    plain = FoundCause(
        "backlash", (), (estimate("backlash.play_mm", 0.1, 0.08, 0.12),), 50.0, (40.0, 60.0)
    )
    for cause in (gain, hysteresis, lag, plain):
        failed = beside_others_of_its_sensor(cause, (gain, hysteresis, lag, plain)).failed
        of_it = refused and cause is not plain
        assert failed == (
            ("is one of 3 errors of the f_out sensor, which may be one law of it",) * of_it
        )


@pytest.mark.parametrize(
    ("delay_s", "lag_s", "refused"),
    [(-0.031, 0.030, True), (0.031, 0.030, False), (-0.005, 0.030, False), (-0.031, 0.0, False)],
)
def test_a_channel_that_leads_by_as_much_as_it_lags_does_neither(delay_s, lag_s, refused):
    delay = sensor_error("channel_delay", f_in_delay_s=delay_s, x_out_delay_s=0.0)
    lag = sensor_error("sensor_lag", f_in_lag_s=lag_s, x_out_lag_s=0.0)
    for cause in (delay, lag):
        assert bool(beside_its_opposite(cause, (delay, lag)).failed) == refused
    gain = sensor_error("force_sensor_gain", f_out_gain=1.2)
    assert beside_its_opposite(gain, (delay, lag, gain)) == gain


@pytest.mark.parametrize(
    ("rivals", "left", "refused"),
    [
        (("free_tendon", "force_sensor_tilt"), {"f_in_N": 0.2, "x_out_mm": 0.0}, True),
        (("free_tendon", "force_sensor_tilt"), {"f_in_N": 0.0, "x_out_mm": 0.0}, False),
        (("free_tendon", "uneven_friction"), {"f_in_N": 0.2, "x_out_mm": 0.0}, False),
        (("free_tendon", "force_sensor_tilt"), {"f_in_N": 0.2}, False),  # no channel tells where
    ],
)
def test_what_three_parts_of_a_rig_do_is_no_cause_where_more_is_wrong(rivals, left, refused):
    cause = FoundCause("drive_compliance", rivals, (), 50.0, (40.0, 60.0))
    start, after = Remainder(9.0, {}, ()), Remainder(1.0, left, ())
    failed = beside_what_is_left(cause, start, after, 0.004).failed
    said = "does what effects of the drive, sensor and tendon do as well, and more is wrong"
    assert failed == ((said,) if refused else ())


def test_what_effects_of_every_part_of_a_rig_do_as_well_may_be_anywhere():
    three = ("viscous_friction", "drive_damping", "load_friction")
    assert not may_be_anywhere(three)
    assert not may_be_anywhere((*three, "sheath_drag"))
    assert may_be_anywhere((*three, "channel_delay"))
