"""Rigs and runs of these tests, and the same physics solved in another way."""

import math
from itertools import pairwise

import numpy as np

from tsas_cli.effects import Effects, FreeTendon, StribeckFriction, ViscousFriction
from tsas_cli.physics.boundary import DISPLACEMENT, FORCE, SPRING, Boundary
from tsas_cli.physics.closed_form.branches import branches_at_rest, follow_branches, with_room
from tsas_cli.physics.closed_form.static import StaticState, follow_static
from tsas_cli.physics.course import DRAG, DRIVE, LOAD, LOST, PULLED, RELEASED, STEP, TIME
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.slip import chain

GROUP_A = Rig(
    friction_coefficient=0.125,
    tendon_stiffness_N=60e3 * math.pi / 4.0 * 1.2**2,
    load_stiffness_N_per_mm=1.579,
    sheath_length_mm=250.0 * math.pi,
    total_bend_rad=math.pi,
    preload_N=25.0,
)
TABLE_1 = GROUP_A._replace(  # with the constants of its dynamic model
    effects=Effects(
        viscous_friction=ViscousFriction(0.02), stribeck_friction=StribeckFriction(0.04, 0.01)
    )
)
FREE = GROUP_A._replace(effects=Effects(free_tendon=FreeTendon(152.0, 61.0)))

LOADED_BY_SPRING = Boundary(DISPLACEMENT, SPRING)
LOADED_BY_FORCE = Boundary(DISPLACEMENT, FORCE)
LOADED_BY_DISPLACEMENT = Boundary(DISPLACEMENT, DISPLACEMENT)
DRIVEN_BY_FORCE = LOADED_BY_SPRING._replace(drive=FORCE)


def branches(x_in, rig):
    """Return tensions and phase of the closed form for a motion from rest."""
    return follow_branches(x_in, rig, with_room(branches_at_rest(rig.preload_N), x_in))


def static_model(x_in, rig):
    """Return tensions and phase of the static model for a motion from rest."""
    return follow_static(x_in, rig, StaticState(0.0, rig.preload_N, rig.preload_N))[0]


def slip_chain(course, rig, boundary, n, frames=None):
    """Return the output of the slip chain for a course from rest."""
    start = chain.initial_state(course, rig, boundary, n)
    return chain.follow(course, start, rig, boundary, n, frames)[0]


def wrap_of(rig):
    return rig.friction_coefficient * rig.total_bend_rad


def through(*turns, samples=400):
    """Go from rest to each turn in evenly spaced samples."""
    legs = [np.linspace(a, b, samples + 1)[1:] for a, b in pairwise((0.0, *turns))]
    return np.concatenate(legs)


def follow(drive, *, rig=GROUP_A, boundary=LOADED_BY_SPRING, n=30, **given):
    """Run the slip chain, with the rig's own friction and all the time unless said otherwise."""
    return slip_chain(course_of(drive, rig, **given), rig, boundary, n)


ROWS = {"load": LOAD, "pulled": PULLED, "released": RELEASED, "drag": DRAG, "lost": LOST}
ROWS |= {"step": STEP, "time_s": TIME}


def course_of(drive, rig, **given):
    """Return what acts on a tendon, by the names of `ROWS`.

    Friction is that of the rig unless it is given, a step takes for ever, all else is zero.
    """
    course = np.zeros((8, len(drive)))
    course[DRIVE], course[STEP] = drive, math.inf
    course[[PULLED, RELEASED]] = wrap_of(rig)
    for name, values in given.items():
        course[ROWS[name]] = values
    return course


def at(laws, boundary=LOADED_BY_SPRING, scale=None):
    """Return the laws of a chain with this given at its ends, and a slip chain's scale."""
    drive = laws.drive._replace(given=boundary.drive)
    laws = laws._replace(drive=drive, load=laws.load._replace(given=boundary.load))
    return laws if scale is None else laws._replace(scale_mm=scale)


class Profile:
    """The tension along the sheath, from rest at the preload, changed from the drive.

    Tension cannot change faster along the sheath than e^(±a s/L). A pull therefore lifts the
    profile to at least the steepest one from the drive, a release lowers it likewise; no front is
    followed and nothing is remembered but the profile.
    """

    def __init__(self, rig, points=40001):
        self.rig, self.wrap = rig, wrap_of(rig)
        self.s = np.linspace(0.0, 1.0, points)
        self.tension = np.full(points, rig.preload_N)
        self.x_out = 0.0

    def pull_drive_to(self, f_in):
        """Change the tension at the drive, with a spring at the load."""
        if f_in > self.tension[0]:
            self.tension = np.maximum(self.tension, f_in * np.exp(-self.wrap * self.s))
        else:
            self.tension = np.minimum(self.tension, f_in * np.exp(self.wrap * self.s))
        self.x_out = (self.tension[-1] - self.rig.preload_N) / self.rig.load_stiffness_N_per_mm

    @property
    def x_in(self):
        """Displacement of the drive: that of the load, and the stretch of all tendon between."""
        excess = self.tension - self.rig.preload_N
        free = self.rig.effects.free_tendon
        stretch = (
            self.rig.sheath_length_mm * np.trapezoid(excess, self.s)
            + free.proximal_length_mm * excess[0]
            + free.distal_length_mm * excess[-1]
        )
        return self.x_out + stretch / self.rig.tendon_stiffness_N


def pulled_through(rig, tensions):
    """Return x_in and f_out where the drive's tension has passed from one value to the next."""
    profile, passed = Profile(rig), []
    for tension in tensions:
        profile.pull_drive_to(tension)
        passed.append((profile.x_in, profile.tension[-1]))
    return np.array(list(zip(*passed, strict=True)))
