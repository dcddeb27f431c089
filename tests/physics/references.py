"""Rigs and runs of these tests, and the same physics solved in two other ways."""

import math
from itertools import pairwise

import numpy as np

from tsas_cli.effects import Effects, FreeTendon, StribeckFriction, ViscousFriction
from tsas_cli.physics.boundary import DISPLACEMENT, FORCE, SPRING, Boundary
from tsas_cli.physics.course import (
    DRIVE,
    LOAD,
    LOST,
    PULLED,
    RELEASED,
    STEP,
    TIME,
    VISCOUS,
    Losses,
)
from tsas_cli.physics.lugre.ends import EndState, StepEnds
from tsas_cli.physics.lugre.state import Given
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.slip.chain import slip_chain

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


def wrap_of(rig):
    return rig.friction_coefficient * rig.total_bend_rad


def through(*turns, samples=400):
    """Go from rest to each turn in evenly spaced samples."""
    legs = [np.linspace(a, b, samples + 1)[1:] for a, b in pairwise((0.0, *turns))]
    return np.concatenate(legs)


def follow(drive, *, rig=GROUP_A, boundary=LOADED_BY_SPRING, n=30, **given):
    """Run the slip chain, with the rig's own friction and all the time unless said otherwise."""
    return slip_chain(course_of(drive, rig, **given), rig, boundary, n)


def course_of(
    drive,
    rig,
    *,
    load=0.0,
    pulled=None,
    released=None,
    viscous=0.0,
    lost=0.0,
    step=math.inf,
    time_s=0.0,
):
    """Return what acts on a tendon; friction is that of the rig unless it is given."""
    wrap = wrap_of(rig)
    rows = {
        DRIVE: drive,
        LOAD: load,
        PULLED: wrap if pulled is None else pulled,
        RELEASED: wrap if released is None else released,
        VISCOUS: viscous,
        LOST: lost,
        STEP: step,
        TIME: time_s,
    }
    course = np.empty((len(rows), len(drive)))
    for row, values in rows.items():
        course[row] = values
    return course


def at(laws, boundary=LOADED_BY_SPRING, scale=None):
    """Return the laws of a chain with this given at its ends, and a slip chain's scale."""
    drive = laws.drive._replace(given=boundary.drive)
    laws = laws._replace(drive=drive, load=laws.load._replace(given=boundary.load))
    return laws if scale is None else laws._replace(scale_mm=scale)


def step_ends(f_in=0.0, f_out=0.0):
    """Return ends of a step at which all but the tensions is zero."""
    none = Given(0.0, 0.0)
    drive, load = (EndState(none, 0.0, 0.0, tension, 0.0) for tension in (f_in, f_out))
    return StepEnds(drive, load, 0.0)


def moment(now, **values):
    """Return a moment with some values replaced, those of its losses too."""
    losses = {name: values.pop(name) for name in Losses._fields if name in values}
    return now._replace(losses=now.losses._replace(**losses), **values)


class Profile:
    """The tension along the sheath, from rest at the preload, changed from either end.

    Tension cannot change faster along the sheath than e^(±a s/L). A pull at an end therefore lifts
    the profile to at least the steepest one from there, a release lowers it likewise; no front is
    followed and nothing is remembered but the profile.
    """

    def __init__(self, rig, points=40001):
        self.rig, self.wrap = rig, wrap_of(rig)
        self.s = np.linspace(0.0, 1.0, points)
        self.tension = np.full(points, rig.preload_N)
        self.x_out = 0.0

    def pull_drive_to(self, f_in):
        """Change the tension at the drive, with a spring at the load."""
        self._change(f_in, self.tension[0], self.s)
        self.x_out = (self.tension[-1] - self.rig.preload_N) / self.rig.load_stiffness_N_per_mm

    def pull_drive_with_held_load(self, f_in):
        """Change the tension at the drive by so little that the load does not feel it."""
        before = self.tension[-1]
        self._change(f_in, self.tension[0], self.s)
        assert self.tension[-1] == before

    def pull_load_with_held_drive(self, f_out):
        """Change the tension at the load by so little that the drive does not feel it."""
        x_in, before = self.x_in, self.tension[0]
        self._change(f_out, self.tension[-1], 1.0 - self.s)
        assert self.tension[0] == before
        self.x_out += x_in - self.x_in

    def _change(self, to, before, distance):
        if to > before:
            self.tension = np.maximum(self.tension, to * np.exp(-self.wrap * distance))
        else:
            self.tension = np.minimum(self.tension, to * np.exp(self.wrap * distance))

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


def pulled_through(rig, tensions, points=40001):
    """Return x_in and f_out where the drive's tension has passed from one value to the next."""
    profile = Profile(rig, points)
    passed = []
    for tension in tensions:
        profile.pull_drive_to(tension)
        passed.append((profile.x_in, profile.tension[-1]))
    return tuple(np.array(column) for column in zip(*passed, strict=True))


def relaxed_chain(
    drive, load, pulled, released, preload, compliance, *, drive_by_force, load_by_force
):
    """Return x and T after each sample, node by node until no node moves (Gauss-Seidel).

    A node keeps its place unless the tensions beside it leave the capstan cone; then it goes
    where they are on the cone's edge.
    """
    n = compliance.size - 1
    x, history = np.zeros(n + 2), []
    for i in range(len(drive)):
        ratios = math.exp(-pulled[i] / n), math.exp(-released[i] / n)
        held = x.copy()
        if not drive_by_force:
            x[0] = drive[i]
        if not load_by_force:
            x[n + 1] = load[i]
        for _ in range(20000):
            moved = 0.0
            for j in range(1, n + 1):
                before = line(x[j - 1], -1.0, compliance[j - 1], preload)
                behind = line(-x[j + 1], 1.0, compliance[j], preload)
                if j == 1 and drive_by_force:
                    before = (drive[i], 0.0)
                if j == n and load_by_force:
                    behind = (load[i], 0.0)
                to = node_position(held[j], before, behind, *ratios)
                moved, x[j] = max(moved, abs(to - x[j])), to
            if moved < 1e-15:
                break
        T = preload + (x[:-1] - x[1:]) / compliance
        if drive_by_force:
            T[0] = drive[i]
            x[0] = x[1] + compliance[0] * (T[0] - preload)
        if load_by_force:
            T[n] = load[i]
            x[n + 1] = x[n] - compliance[n] * (T[n] - preload)
        history.append((x.copy(), T))
    return history


def line(end, sign, compliance, preload):
    """Return the tension of a segment as value at x = 0 and slope over the node's position."""
    return preload + end / compliance, sign / compliance


def node_position(held, before, behind, pulled, released):
    """Return where a node goes whose segments' tensions are straight lines over its position.

    `pulled` and `released` are what its friction leaves of the tension in either direction.
    """

    def tension(segment, x):
        return segment[0] + segment[1] * x

    for least, sign in ((pulled, 1.0), (1.0 / released, -1.0)):
        T = tension(before, held)
        edge = least * T if T >= 0.0 else T / least
        if sign * (tension(behind, held) - edge) < 0.0:
            for factor in (least, 1.0 / least):  # of positive and of negative tension
                x = (factor * before[0] - behind[0]) / (behind[1] - factor * before[1])
                if (tension(before, x) >= 0.0) == (factor == least):
                    return x
    return held
