"""What force sensors make of a tension, against the same made by hand: curve, loop, crosstalk."""

import numpy as np
import pytest

from tests.effects.runs import UP_AND_DOWN, run
from tests.physics.references import GROUP_A
from tsas_cli.effects.force_sensor_curvature import read_curved, straightened
from tsas_cli.effects.position_sensor_ripple import without_ripple
from tsas_cli.numerics.wave import Wave, rippled
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.response import simulate
from tsas_cli.physics.rig import with_values
from tsas_cli.physics.sensors import with_hysteresis

CHANNELS = ("x_in_mm", "f_in_N", "f_out_N", "x_out_mm")


def changed_alone(values, channel, law):
    """Hold one channel against a law of both true tensions, and all others against no change."""
    plain, read = run({}), run(values)
    for name in CHANNELS:
        true = getattr(plain, name)
        expected = law(plain.f_in_N, plain.f_out_N) if name == channel else true
        np.testing.assert_allclose(getattr(read, name), expected, atol=1e-9)


@pytest.mark.parametrize("channel", ["f_in", "f_out"])
def test_a_curved_scale_is_a_parabola(channel):
    def law(f_in, f_out):
        true = f_in if channel == "f_in" else f_out
        return true - 3e-4 * true**2

    changed_alone({f"force_sensor_curvature.{channel}_per_N": -3e-4}, f"{channel}_N", law)


def test_a_curved_scale_is_right_without_force_and_has_a_slope_of_one_there():
    assert read_curved(0.0, 1e-3) == 0.0
    assert (read_curved(1e-6, 1e-3) - read_curved(-1e-6, 1e-3)) / 2e-6 == pytest.approx(1.0)
    assert read_curved(50.0, 4e-4) == pytest.approx(51.0)


@pytest.mark.parametrize("curvature", [-2e-3, 0.0, 2e-3])
def test_a_reading_of_a_curved_scale_has_one_force(curvature):
    forces = np.array([-20.0, 0.0, 25.0, 120.0])
    back = straightened(read_curved(forces, curvature), curvature)
    np.testing.assert_allclose(back, forces, rtol=1e-12)
    assert straightened(1e3, -2e-3) == pytest.approx(2e3)  # beyond the vertex, which reads 125 N


@pytest.mark.parametrize(
    ("values", "channel", "law"),
    [
        ({"f_in_of_f_out": 0.04}, "f_in_N", lambda f_in, f_out: f_in + 0.04 * f_out),
        ({"f_out_of_f_in": -0.03}, "f_out_N", lambda f_in, f_out: f_out - 0.03 * f_in),
    ],
)
def test_a_sensor_picks_up_the_other_force(values, channel, law):
    changed_alone({f"force_crosstalk.{name}": v for name, v in values.items()}, channel, law)


def test_both_sensors_pick_up_the_true_force_of_the_other():
    values = {"force_crosstalk.f_in_of_f_out": 0.04, "force_crosstalk.f_out_of_f_in": -0.03}
    plain, read = run({}), run(values)
    np.testing.assert_allclose(read.f_in_N, plain.f_in_N + 0.04 * plain.f_out_N, rtol=1e-12)
    np.testing.assert_allclose(read.f_out_N, plain.f_out_N - 0.03 * plain.f_in_N, rtol=1e-12)


@pytest.mark.parametrize(
    ("load", "value"),
    [
        ("force", "force_crosstalk.f_out_of_f_in"),
        ("f_in", "force_crosstalk.f_in_of_f_out"),
        ("force", "force_sensor_tilt.f_out_per_mm"),
        ("f_in", "force_sensor_tilt.f_in_per_mm"),
    ],
)
def test_a_measured_tension_that_drives_the_model_is_taken_as_it_is(load, value):
    plain = run({})
    drive = DriveInput(UP_AND_DOWN, load="force", load_values=plain.f_out_N)
    if load == "f_in":
        drive = DriveInput(plain.f_in_N, kind="force")
    rig = with_values(GROUP_A, {value: 0.04})
    with_it, without = simulate(rig, drive), simulate(GROUP_A, drive)
    for name in CHANNELS:
        np.testing.assert_array_equal(getattr(with_it, name), getattr(without, name))


@pytest.mark.parametrize(("channel", "position"), [("f_in", "x_in_mm"), ("f_out", "x_out_mm")])
def test_a_sensor_that_tilts_reads_more_by_its_own_position(channel, position):
    where = getattr(run({}), position)

    def law(f_in, f_out):
        return (f_in if channel == "f_in" else f_out) * (1.0 - 7e-4 * where)

    changed_alone({f"force_sensor_tilt.{channel}_per_mm": -7e-4}, f"{channel}_N", law)


def test_a_wave_too_steep_has_no_position():
    gentle, steep = Wave(0.2, -0.1, 4.0), Wave(0.0, 0.9, 2.0)
    assert without_ripple(rippled(3.3, gentle), gentle) == pytest.approx(3.3, abs=1e-10)
    assert any(np.isnan(without_ripple(x, steep)) for x in np.linspace(-3.0, 3.0, 200))


def loop_by_branches(force, span, share):
    """Return the reading on a rise from rest, then on a fall: straight lines between kinks.

    The element rises with the force to its span; after the reversal it falls as far below it, over
    twice the span.
    """
    top = int(np.argmax(force))
    up = np.interp(force[: top + 1] - force[0], [0.0, span, 1e6], [0.0, span, span])
    down = np.interp(force[top] - force[top + 1 :], [0.0, 2.0 * span, 1e6], [span, -span, -span])
    return force - share * np.concatenate((up, down))


@pytest.mark.parametrize("channel", ["f_in", "f_out"])
def test_a_sensor_with_hysteresis_reads_less_on_the_pull_than_on_the_release(channel):
    def law(f_in, f_out):
        return loop_by_branches(f_in if channel == "f_in" else f_out, 6.0, 0.05)

    values = {f"{channel}_share": 0.05, "span_N": 6.0}
    named = {f"force_sensor_hysteresis.{name}": value for name, value in values.items()}
    changed_alone(named, f"{channel}_N", law)


@pytest.mark.parametrize("stroke", [3.0, 8.0, 9.0, 30.0])
def test_a_loop_costs_what_exceeds_twice_the_span(stroke):
    """The element dissipates 2·span·(stroke − 2·span) in a cycle, nothing in a small one."""
    span, share = 4.0, 0.05
    force = 40.0 - stroke * np.abs(np.linspace(-3.0, 3.0, 6001) % 2.0 - 1.0)
    read = with_hysteresis(force, share, span, np.full(5, np.nan))
    cycle = slice(4000, 6001)
    assert force[cycle][0] == pytest.approx(force[cycle][-1])
    loop = share * 2.0 * span * max(stroke - 2.0 * span, 0.0)
    assert np.trapezoid(read[cycle], force[cycle]) == pytest.approx(-loop, abs=1e-3)


def test_a_drive_by_force_is_taken_with_the_loop_that_it_has():
    drive = DriveInput(run({}).f_in_N, kind="force")
    rig = with_values(GROUP_A, {"force_sensor_hysteresis.f_in_share": 0.05})
    with_it, without = simulate(rig, drive), simulate(GROUP_A, drive)
    np.testing.assert_array_equal(with_it.x_in_mm, without.x_in_mm)
    np.testing.assert_array_equal(with_it.f_in_N, without.f_in_N)
