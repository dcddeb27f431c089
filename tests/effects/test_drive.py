"""What acts at the drive, against the same motion or force made by hand."""

import numpy as np
import pytest

from tests.effects.runs import UP_AND_DOWN, run
from tests.physics.references import GROUP_A

PULLING = np.arange(UP_AND_DOWN.size) <= 700


def test_backlash_is_the_motion_that_the_play_leaves():
    x = UP_AND_DOWN
    left = np.where(PULLING, np.maximum(x - 0.2, 0.0), np.minimum(13.8, x + 0.2))
    loose = run({"backlash.play_mm": 0.4})
    by_hand = run({}, left, time_s=np.arange(float(left.size)))
    np.testing.assert_allclose(loose.f_in_N, by_hand.f_in_N, atol=1e-9)
    np.testing.assert_allclose(loose.x_out_mm, by_hand.x_out_mm, atol=1e-9)
    assert not np.diff(loose.f_in_N[700:720]).any()
    assert loose.f_in_N[722] < loose.f_in_N[700]


def test_ripple_is_the_motion_that_the_gear_makes():
    angle = 2.0 * np.pi * UP_AND_DOWN / 2.0
    moved = UP_AND_DOWN + 0.03 * np.sin(angle) + 0.02 * np.cos(angle) - 0.02
    ripple = {"sine_mm": 0.03, "cosine_mm": 0.02, "period_mm": 2.0}
    rippled = run({f"drive_ripple.{name}": value for name, value in ripple.items()})
    np.testing.assert_array_equal(rippled.x_in_mm, UP_AND_DOWN)
    np.testing.assert_allclose(rippled.f_in_N, run({}, moved).f_in_N, atol=1e-9)


@pytest.mark.parametrize("preload", [10.0, 40.0])
def test_friction_at_the_drive_is_the_same_at_any_tension(preload):
    rig = GROUP_A._replace(preload_N=preload)
    rubbing, plain = run({"drive_friction.friction_N": 1.5}, rig=rig), run({}, rig=rig)
    np.testing.assert_allclose((rubbing.f_in_N - plain.f_in_N)[1:701], 1.5, rtol=1e-9)
    np.testing.assert_allclose((rubbing.f_in_N - plain.f_in_N)[701:], -1.5, rtol=1e-9)
    np.testing.assert_array_equal(rubbing.f_out_N, plain.f_out_N)


def test_a_spring_to_ground_pulls_with_the_travel():
    sprung, plain = run({"proximal_spring.stiffness_N_per_mm": 12.5}), run({})
    np.testing.assert_allclose(sprung.f_in_N - plain.f_in_N, 12.5 * UP_AND_DOWN, atol=1e-9)
    np.testing.assert_array_equal(sprung.f_out_N, plain.f_out_N)


def test_a_drive_that_gives_is_moved_on_by_its_force():
    give = 0.004
    soft = run({"drive_compliance.compliance_mm_per_N": give})
    stiff = run({}, UP_AND_DOWN - give * (soft.f_in_N - 25.0))
    np.testing.assert_allclose(soft.f_in_N, stiff.f_in_N, rtol=1e-6)
    np.testing.assert_allclose(soft.x_out_mm, stiff.x_out_mm, atol=1e-6)


def test_a_drive_by_force_moves_once_its_friction_is_overcome():
    """Held by 1 N of friction: nothing moves until the force has turned by 2 N."""
    f_in = np.concatenate((np.linspace(25.0, 60.0, 701), np.linspace(60.0, 50.0, 201)[1:]))
    time_s = np.arange(f_in.size) / 100.0
    values = {"drive_friction.friction_N": 1.0, "proximal_spring.stiffness_N_per_mm": 0.5}
    x = run(values, f_in, kind="force", time_s=time_s).x_in_mm
    assert not x[f_in[:701].searchsorted(25.0) : f_in[:701].searchsorted(26.0)].any()
    assert x[700] > 5.0
    turned = 700 + int(np.argmax(f_in[700:] < 58.0))
    np.testing.assert_array_equal(x[700 : turned - 1], x[700])
    assert x[turned + 20] < x[700]
    back = run(values, x, time_s=time_s)
    moving = np.diff(x, prepend=0.0) != 0.0
    np.testing.assert_allclose(back.f_in_N[moving], f_in[moving], rtol=1e-6)
