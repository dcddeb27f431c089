"""The slip chain against the closed form and against a profile on a fine grid."""

import math
from itertools import pairwise

import numpy as np
import pytest

from tests.physics.references import (
    FREE,
    GROUP_A,
    branches,
    course_of,
    follow,
    slip_chain,
    through,
    wrap_of,
)
from tests.physics.slip.laws_by_hand import SPRINGY, N, gives, hold_everywhere
from tsas_cli.physics.boundary import DISPLACEMENT, FORCE, SPRING, Boundary
from tsas_cli.physics.phases import SLACK, UNCONVERGED
from tsas_studies.challenge.rig import tendon
from tsas_studies.challenge.rig.motions import Motion


@pytest.mark.parametrize(
    ("motion", "rms_order"),
    [
        pytest.param(np.linspace(20.0, 19.75, 50001), 1.8, id="constant speed"),
        pytest.param(10.0 + 10.0 * np.cos(np.linspace(0.0, 2.0 * np.pi, 40001)), 1.45, id="sine"),
    ],
)
def test_order_of_the_mesh(motion, rms_order):
    """At reversals, where the exact slope is infinite, it is first; a sine lingers there."""
    exact = branches(motion, GROUP_A)[0]
    errors = [follow(motion, n=n)[2] - exact for n in (10, 20, 40, 80, 160)]
    rms = [math.sqrt(np.mean(e**2)) for e in errors]
    largest = [np.abs(e).max() for e in errors]
    assert math.log2(rms[0] / rms[-1]) / 4.0 > rms_order
    assert 0.95 < math.log2(largest[0] / largest[-1]) / 4.0 < 1.1


def test_full_slip_is_second_order():
    exact = branches(np.array([20.0]), GROUP_A)[0][0]
    errors = [abs(follow([20.0], n=n)[2][0] - exact) for n in (10, 20, 40, 80, 160)]
    assert errors[0] < 1e-3
    for coarse, fine in pairwise(errors):
        assert math.log2(coarse / fine) == pytest.approx(2.0, abs=0.05)


def test_one_large_step_is_many_small_ones():
    turns = np.array([14.0, 13.93, 13.96, 13.2, 13.3, -5.0, 13.0])
    fine = follow(through(*turns, samples=1000), rig=FREE)
    for coarse, small in zip(follow(turns, rig=FREE), fine, strict=True):
        np.testing.assert_allclose(coarse, small[999::1000], rtol=1e-7)


A = wrap_of(GROUP_A)
PUSHING = -1  # a force of the antagonist too
LIGHT = SPRINGY._replace(effects=FREE.effects)


def wandering(rng, scale, samples=80):
    """A motion about zero with reversals of many sizes."""
    knots = scale * rng.uniform(-1.0, 1.0, samples // 4)
    return np.interp(np.linspace(0.0, knots.size - 1.0, samples), np.arange(knots.size), knots)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    ("drive", "load"),
    [
        *((DISPLACEMENT, kind) for kind in (SPRING, FORCE, DISPLACEMENT, PUSHING)),
        *((FORCE, kind) for kind in (SPRING, DISPLACEMENT)),
    ],
)
def test_every_law_holds_while_everything_varies_at_once(drive, load, seed):
    """Friction of both directions and the anchor change with what is given at both ends."""
    rng = np.random.default_rng(seed)
    at_load = {
        SPRING: 0.0,
        FORCE: 25.0 + wandering(rng, 10.0),
        DISPLACEMENT: wandering(rng, 0.5),
        PUSHING: wandering(rng, 30.0),
    }[load]
    course = course_of(
        25.0 + wandering(rng, 20.0) if drive == FORCE else wandering(rng, 1.5),
        LIGHT,
        load=at_load,
        pulled=A + wandering(rng, 0.3 * A),
        released=A + wandering(rng, 0.3 * A),
        lost=wandering(rng, 4.0),
    )
    boundary = Boundary(drive, FORCE if load == PUSHING else load)
    hold_everywhere(course, LIGHT, boundary)
    _, _, f_in, _, phase = slip_chain(course, LIGHT, boundary, N)
    assert set(phase) == {0, 1, -1}
    assert (f_in.min() < -10.0) == (load == PUSHING)


def test_friction_that_vanishes_lets_both_ends_of_a_stretched_tendon_move_apart():
    """Of a node near the one that stays at rest only the tensions tell which way it slips."""
    friction = np.interp(np.arange(120.0), [0, 30, 60, 90, 119], [A, 0.0, 0.0, A, A])
    tension = 20.0 + 5.0 * np.sin(0.3 * np.arange(120.0))
    # A third of what the tendon is longer by is given at the drive, the rest moves the load.
    length = gives(LIGHT).sum() * (tension - LIGHT.preload_N)
    x_in, x_out, f_in, _, phase = follow(
        length / 3.0,
        load=tension,
        rig=LIGHT,
        boundary=Boundary(DISPLACEMENT, FORCE),
        n=60,
        pulled=friction,
        released=friction,
    )
    assert UNCONVERGED not in phase
    free = slice(30, 61)
    np.testing.assert_allclose(f_in[free], tension[free], rtol=1e-9)
    np.testing.assert_allclose((x_in - x_out)[free], length[free], rtol=1e-2)


def test_friction_that_fades_while_nothing_moves_is_that_of_the_rig():
    """An independent solver with another friction law; the tendon creeps while the drive rests."""
    t = np.arange(301.0)
    motion = Motion(t, np.interp(t, [0, 100, 200, 300], [0, 10, 10, 8]))
    fading = ((0.0, 1.0), (100.0, 1.2), (200.0, 0.7), (300.0, 0.9))
    made = tendon.Rig(
        friction_course=fading, proximal_length_mm=152.0, distal_length_mm=61.0, cells=60
    )
    expected = tendon.simulate(made, motion).columns
    wrap = A * np.interp(t, *np.transpose(fading))
    _, x_out, f_in, f_out, phase = follow(
        motion.x_in_mm, rig=FREE, pulled=wrap, released=wrap, n=60
    )
    assert np.ptp(f_in[100:200]) > 10.0
    np.testing.assert_allclose(f_in, expected["f_in_N"], atol=0.05)
    np.testing.assert_allclose(f_out, expected["f_out_N"], atol=0.05)
    np.testing.assert_allclose(x_out, expected["x_out_mm"], atol=0.05)
    assert (phase[110:200] == 1).all()


def test_drag_holds_the_load_where_the_drive_has_let_go():
    """In a straight sheath, released: f_out − f_in is the drag until the load has no tension."""
    drag, rig = 6.0, GROUP_A
    x_in = through(-20.0)
    _, x_out, f_in, f_out, phase = follow(x_in, rig=rig, pulled=0.0, released=0.0, drag=drag)
    stretch_mm_per_N = rig.sheath_length_mm / rig.tendon_stiffness_N
    slope = 1.0 / (1.0 / rig.load_stiffness_N_per_mm + stretch_mm_per_N)
    tension = np.maximum(rig.preload_N + slope * (x_in + 0.5 * drag * stretch_mm_per_N), 0.0)
    slides = x_in < -1.0
    np.testing.assert_allclose(f_out[slides], tension[slides], atol=1e-9)
    np.testing.assert_allclose(f_in[slides], np.maximum(tension[slides] - drag, 0.0), atol=1e-9)
    at_load = (tension - rig.preload_N) / rig.load_stiffness_N_per_mm
    np.testing.assert_allclose(x_out[slides], at_load[slides], atol=1e-9)
    assert set(phase[slides & (f_in > 0.0)]) == {-1}
    assert set(phase[slides & (f_in == 0.0)]) == {SLACK}
    assert (f_out[f_in == 0.0] > 0.0).any()
