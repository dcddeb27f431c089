"""The slip chain while friction, bend, the spring's anchor and both ends change at once."""

import numpy as np
import pytest

from tests.physics.references import FREE, GROUP_A, course_of, follow, slip_chain, wrap_of
from tests.physics.slip.test_small_chains import SPRINGY, N, gives, hold_everywhere
from tsas_cli.physics.boundary import DISPLACEMENT, FORCE, SPRING, Boundary
from tsas_cli.physics.phases import UNCONVERGED
from tsas_studies.challenge.rig import tendon
from tsas_studies.challenge.rig.motions import Motion

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
