"""The laws of a slip chain of three nodes, by hand: each state is held against them."""

import math

import numpy as np
import pytest

from tests.physics.references import (
    GROUP_A,
    course_of,
    wrap_of,
)
from tsas_cli.physics.boundary import DISPLACEMENT, SPRING
from tsas_cli.physics.slip.chain import moment, rest_after

N = 3
A = wrap_of(GROUP_A)
SPRINGY = GROUP_A._replace(
    tendon_stiffness_N=5e3, load_stiffness_N_per_mm=30.0, sheath_length_mm=300.0
)
UP_AND_DOWN = np.array([0.4, 0.9, 1.6, 1.58, 1.45, 1.5, 1.47, 1.1, 0.5, -0.1, -0.7, -0.6])
MASS_TAKES_UP_S = 0.004  # documented in `slip.ends`
ROUNDING = 1e-6  # [N, mm]
FREE = {"free_tendon.proximal_length_mm": 40.0, "free_tendon.distal_length_mm": 15.0}
FALLING = {
    "stribeck_friction.excess": 0.5,
    "stribeck_friction.velocity_mm_per_s": 4.0,
    "stribeck_friction.exponent": 1.3,
    "stribeck_friction.lag_s": 0.02,
}
EFFECTS = {
    "friction alone": {},
    "free tendon": FREE,
    "compliances in series": FREE
    | {"drive_compliance.compliance_mm_per_N": 0.004, "sheath_compression.compliance_ratio": 0.3},
    "friction rises with tension": {"load_dependent_friction.exponent": 0.15},
    "friction falls with tension": {"load_dependent_friction.exponent": -0.25},
    "friction is the same at any tension": {"load_dependent_friction.exponent": -1.0},
    "presliding": {"presliding.length_mm": 0.02},
    "presliding and tension": {
        "presliding.length_mm": 0.05,
        "load_dependent_friction.exponent": 0.5,
    },
    "bristles of a fixed stiffness": {
        "presliding.length_mm": 0.02,
        "presliding.growth": 1.0,
        "sheath_drag.force_N": 6.0,
    },
    "bristles of which a part has one": {
        "presliding.length_mm": 0.02,
        "presliding.growth": 0.6,
        "pulley_friction.load_loss": 0.15,
    },
    "a bent spring": {
        "load_spring_nonlinearity.quadratic_per_mm": 0.3,
        "load_spring_nonlinearity.cubic_per_mm2": 0.2,
    },
    "a guide at the load": {
        "load_friction.after_sensor_N": 3.0,
        "load_friction.before_sensor_N": 1.5,
    },
    "friction rises along the sheath": {"uneven_friction.slope": 1.0},
    "friction falls along the sheath and with tension": {
        "uneven_friction.slope": -1.2,
        "load_dependent_friction.exponent": -0.25,
    },
    "drag": {"sheath_drag.force_N": 6.0},
    "drag and presliding": {"sheath_drag.force_N": 6.0, "presliding.length_mm": 0.02},
    "uneven presliding": {"presliding.length_mm": 0.02, "uneven_friction.slope": 1.2},
    "pulleys": {"pulley_friction.drive_loss": 0.1, "pulley_friction.load_loss": 0.15},
    "pulleys and presliding": {
        "pulley_friction.drive_loss": 0.1,
        "pulley_friction.load_loss": 0.15,
        "presliding.length_mm": 0.02,
        "uneven_friction.slope": 1.2,
    },
    "friction falls with speed": FALLING,
    "presliding falls with speed": FALLING | {"presliding.length_mm": 0.02},
    "a damper": {"load_damping.coefficient_N_s_per_mm": 0.4},
    "a load that yields": {"load_hysteresis.force_N": 4.0, "load_hysteresis.travel_mm": 0.3},
    "a load that relaxes": {"load_relaxation.share": 0.5, "load_relaxation.time_s": 0.1},
    "a load at a pulley": {
        "load_ripple.sine_mm": 0.1,
        "load_ripple.period_mm": 2.0,
        "load_ripple.second_sine": 0.2,
        "load_ripple.second_cosine": -0.1,
    },
    "all at the load": {
        "load_damping.coefficient_N_s_per_mm": 0.2,
        "load_hysteresis.force_N": 2.0,
        "load_relaxation.share": 0.3,
        "load_ripple.cosine_mm": 0.1,
        "load_inertia.mass_kg": 10.0,
        "load_friction.after_sensor_N": 1.0,
    },
    "a mass": {"load_inertia.mass_kg": 40.0},
    "a mass on a bent spring": {
        "load_inertia.mass_kg": 25.0,
        "load_spring_nonlinearity.cubic_per_mm2": 0.2,
    },
}


def states(course, rig, boundary):
    """Return places and tensions of the nodes after every sample."""
    courses = [course[:, : i + 1].copy() for i in range(course.shape[1])]
    found = [rest_after(until, rig, boundary, N) for until in courses]
    return [(x, T[:-1]) for x, T in found]


def moments(course):
    """Return the moment at each sample."""
    return [moment(course, i) for i in range(course.shape[1])]


def gives(rig, n=N):
    """Return what each segment gives [mm/N]: halves at both ends, all else in series with them."""
    effects, EA = rig.effects, rig.tendon_stiffness_N
    sheathed = rig.sheath_length_mm / EA * (1.0 + effects.sheath_compression.compliance_ratio) / n
    give = sheathed * np.array([0.5, *[1.0] * (n - 1), 0.5])
    give[0] += effects.free_tendon.proximal_length_mm / EA
    give[0] += effects.drive_compliance.compliance_mm_per_N
    give[-1] += effects.free_tendon.distal_length_mm / EA
    return give


def rubs(force, way, limit):
    """Say whether a friction force is that of an end that has moved by a way."""
    if abs(way) > ROUNDING:
        return force == pytest.approx(math.copysign(limit, way), abs=10 * ROUNDING)
    return abs(force) < limit + 10 * ROUNDING


class Nodes:
    """What a node passes on, by its way since the sample before."""

    def __init__(self, rig):
        self.rig, self.share, self.speed = rig, np.zeros(N + 1), np.zeros(N + 1)
        self.length = np.zeros(N + 1)

    def hold(self, i, way, before, behind, now):
        pulled, released, drag_N, _ = now.losses
        mean = 0.5 * (before + behind)
        exponent = self.rig.effects.load_dependent_friction.exponent
        factor = (abs(mean) / 10.0) ** exponent
        factor *= 1.0 + self.rig.effects.uneven_friction.slope * ((i - 0.5) / N - 0.5)
        excess, falls_mm_s, power, lag_s = self.rig.effects.stribeck_friction
        factor *= 1.0 + excess * math.exp(-((self.speed[i] / falls_mm_s) ** power))
        if now.step_s < math.inf:  # friction of the next step
            taken = -math.expm1(-now.step_s / lag_s)
            self.speed[i] += taken * (abs(way) / now.step_s - self.speed[i])
        loss, sign = 0.5 * drag_N / N, math.copysign(1.0, mean)
        pulleys = self.rig.effects.pulley_friction
        at_end = {1: pulleys.drive_loss, N: pulleys.load_loss}.get(i, 0.0)
        length, growth = self.rig.effects.presliding
        if growth > 0.0:
            wrap = 0.5 * (pulled + released) / N + at_end
            limit_N = mean * wrap + drag_N / N
            at_10_N = 10.0 * self.rig.friction_coefficient * self.rig.total_bend_rad / N
            length *= 1.0 - growth + growth * limit_N / at_10_N
            self.share[i] *= self.length[i] / length  # the bristles stay as they are bent
            self.length[i] = length
        if length > 0.0:
            limit = 1.0 if way > 0.0 else -1.0
            share = limit + (self.share[i] - limit) * math.exp(-abs(way) / length)
            self.share[i] = share
            wrap = share * (factor * (pulled if share > 0.0 else released) / N + at_end)
            assert behind + share * loss == pytest.approx(
                math.exp(-sign * wrap) * (before - share * loss), abs=ROUNDING
            )
            return
        least = math.exp(-sign * (factor * pulled / N + at_end)) * (before - loss) - loss
        most = math.exp(sign * (factor * released / N + at_end)) * (before + loss) + loss
        assert least - ROUNDING < behind < most + ROUNDING
        if way > ROUNDING:
            assert behind == pytest.approx(least, abs=ROUNDING)
        elif way < -ROUNDING:
            assert behind == pytest.approx(most, abs=ROUNDING)


class BesideSpring:
    """What the load has beside its spring: damper, element that yields, relaxing spring, pulley."""

    def __init__(self, rig):
        self.rig, self.element, self.stretch = rig, 0.0, 0.0

    def force(self, x, way, step_s):
        effects, stiffness = self.rig.effects, self.rig.load_stiffness_N_per_mm
        most, travel = effects.load_hysteresis
        self.element = float(np.clip(self.element + most / travel * way, -most, most))
        share, time_s = effects.load_relaxation
        left = math.exp(-step_s / time_s)
        gained = (1.0 - left) * time_s / step_s * way if step_s < math.inf else 0.0
        self.stretch = self.stretch * left + gained
        sine, cosine, period, up, across = effects.load_ripple
        angle = 2.0 * math.pi * x / period
        wave = sine * math.sin(angle) + cosine * (math.cos(angle) - 1.0)
        second = up * math.sin(2.0 * angle) + across * (math.cos(2.0 * angle) - 1.0)
        wave += math.hypot(sine, cosine) * second
        damped = effects.load_damping.coefficient_N_s_per_mm * way / step_s
        return damped + self.element + stiffness * (share * self.stretch + wave)


class Mass:
    """A mass whose speed follows that of its place late, both by parabolas over three samples."""

    def __init__(self):
        self.places, self.speeds, self.times = [0.0], [0.0], [0.0]

    def force(self, x, step_s, mass_kg):
        if step_s == math.inf:
            self.places, self.speeds, self.times = [x], [0.0], [0.0]
            return 0.0
        times = [*self.times[-2:], self.times[-1] + step_s]

        def rate(values, newest):
            parabola = np.polynomial.Polynomial.fit(times, [*values[-2:], newest], len(times) - 1)
            return parabola.deriv()(times[-1])

        speed = rate(self.places, x)
        still, per_speed = rate(self.speeds, 0.0), rate(self.speeds, 1.0) - rate(self.speeds, 0.0)
        taken_up = (speed - MASS_TAKES_UP_S * still) / (1.0 + MASS_TAKES_UP_S * per_speed)
        for past, newest in ((self.places, x), (self.speeds, taken_up), (self.times, times[-1])):
            past.append(newest)
        return 1e-3 * mass_kg * (speed - taken_up) / MASS_TAKES_UP_S


def hold_everywhere(course, rig, boundary):
    """Hold every state of a run against all laws; return how the nodes went, shape (m, n + 2)."""
    F0, effects, give = rig.preload_N, rig.effects, gives(rig)
    nodes, x_before, mass = Nodes(rig), np.zeros(N + 2), Mass()
    ways, beside = [], BesideSpring(rig)
    for now, (x, T) in zip(moments(course), states(course, rig, boundary), strict=True):
        drive, load, losses, step_s = now
        way = x - x_before
        np.testing.assert_allclose(x[:-1] - x[1:], give * (T - F0), atol=ROUNDING)
        for i in range(1, N + 1):
            nodes.hold(i, way[i], T[i - 1], T[i], now)
        if boundary.drive == DISPLACEMENT:
            assert x[0] == drive
        else:
            held = effects.proximal_spring.stiffness_N_per_mm * x[0]
            assert rubs(drive - held - T[0], way[0], effects.drive_friction.friction_N)
        if boundary.load == DISPLACEMENT:
            assert x[-1] == load
        else:
            guide, after = effects.load_friction[::-1]
            pull = load
            if boundary.load == SPRING:
                shape = effects.load_spring_nonlinearity
                bent = 1.0 + shape.quadratic_per_mm * x[-1] + shape.cubic_per_mm2 * x[-1] ** 2
                pull, guide = F0 - losses.preload_N, guide + after
                pull += rig.load_stiffness_N_per_mm * x[-1] * bent
                pull += beside.force(x[-1], way[-1], step_s)
                pull += mass.force(x[-1], step_s, effects.load_inertia.mass_kg)
            assert rubs(T[-1] - pull, way[-1], guide)
        x_before = x
        ways.append(way)
    return np.array(ways)


def varying(drive, rig, **given):
    """Return the course of a drive while friction of both directions and the preload change."""
    m = drive.size
    pulled, released = np.linspace(0.9, 1.3, m) * A, np.linspace(0.8, 0.6, m) * A
    losses = {"pulled": pulled, "released": released, "lost": np.linspace(0.0, 2.0, m)}
    return course_of(drive, rig, step=0.05, **losses, **given)
