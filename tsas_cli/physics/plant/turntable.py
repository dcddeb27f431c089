"""The drive of a closed loop's plant: motor, gear with finite stiffness, turntable.

    lag · dw/dt + w = u,  dx_m/dt = K w                              motor speed w, command u
    m d²x/dt² + B dx/dt + k_d (x − x_m) + dp/dx (F(p) − F0) = 0       turntable, m = J/r1²
    p = play(x + ripple(x))                                          the tendon's end

Yang 2025, Eqs. (23) to (25), with the reaction k_d (x − x_m) of the drive's stiffness that Eq. (25)
lacks. F is the force of the slip chain and of all that is beside it: the drive's friction, a spring
parallel to the tendon, the law of unnamed origin at the drive (`plant.laws`).

Discretisation: the motor exactly for a constant command, the turntable by BDF2 with a constant step
(second order), in which F is implicit: a turntable after a step is a linear spring of stiffness
m c² + B c + k_d, c = 3/(2h), in series with the slip chain. Viscous friction uses the speed
of the step before, Stribeck friction each node's, with a lag: first order there. While the drive
crosses its play the tendon's end rests under tension, and the play has friction (`play_friction`).
"""

import math
from typing import NamedTuple

from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.wave import Wave, rippled, wave_from
from tsas_cli.physics.rig import Rig

FLANK = 1.0 - 1e-9  # of half the play, from which the drive is in contact with its flank
RIPPLE_STEP_MM = 1e-4  # of the finite difference of the ripple


class Actuator(NamedTuple):
    """Motor and gear (the paper's symbols in brackets)."""

    gain_mm_per_s_rpm: float  # [2π r1/(60 im)]
    stiffness_N_per_mm: float  # [km as chosen for kr, Eq. (34)]
    inertia_N_s2_per_mm: float  # [J/r1²]
    damping_N_s_per_mm: float  # [B]
    motor_lag_s: float
    speed_limit_rpm: float


class Tangent(NamedTuple):
    """A straight line: its value at x = 0 and its slope."""

    ahead: float
    slope: float


class Play(NamedTuple):
    """Half of the gear's play, and its friction over the turntable's stiffness [mm]."""

    half: float
    friction_mm: float


class Motor(NamedTuple):
    """The motor's speed, and its position by the gear's kinematics."""

    rpm: float
    mm: float


class Turntable(NamedTuple):
    """Motion of the turntable after a step; `before` is a step earlier."""

    x: float
    x_before: float
    v: float
    v_before: float
    f_in: float  # reading of a sensor at the drive [N]
    speed: float  # of the tendon's end [mm/s]


class DriveStep(NamedTuple):
    """One step of the plant, with the motor already at its end."""

    actuator: Actuator
    motor_mm: float
    time_s: float  # at its end
    h: float  # its length [s]
    beside: Tangent = Tangent(0.0, 0.0)  # force of the drive's law over the tendon's end [mm, N]
    friction: float = 1.0  # factor of the friction coefficient by the tendon's law


class TurntableSpring(NamedTuple):
    """The turntable after a step as a spring at the tendon's end p.

    In contact its force is force − stiffness p, with p = ahead + slope x.
    """

    touches: bool  # in contact; False while it crosses its play
    x: float  # with the tendon's end at rest [mm]
    tangent: Tangent
    stiffness: float  # [N/mm]
    force: float  # [N]


@kernel
def advance_motor(motor: Motor, command_rpm: float, actuator: Actuator, h: float) -> Motor:
    """Return the motor after h with a constant speed command, exactly."""
    lag = actuator.motor_lag_s
    decay = math.exp(-h / lag) if lag > 0.0 else 0.0
    rest = motor.rpm - command_rpm
    travel = actuator.gain_mm_per_s_rpm * (command_rpm * h + rest * lag * (1.0 - decay))
    return Motor(command_rpm + rest * decay, motor.mm + travel)


@kernel
def spring_of(table: Turntable, p: float, rig: Rig, step: DriveStep) -> TurntableSpring:
    """Return the turntable after a step as a spring for the tendon's end at p."""
    actuator, h = step.actuator, step.h
    c, m = 1.5 / h, actuator.inertia_N_s2_per_mm
    v_rest = (-4.0 * table.x + table.x_before) / (2.0 * h)
    a_rest = c * v_rest + (-4.0 * table.v + table.v_before) / (2.0 * h)
    stiffness = m * c * c + actuator.damping_N_s_per_mm * c + actuator.stiffness_N_per_mm
    pull = actuator.stiffness_N_per_mm * step.motor_mm - m * a_rest
    pull -= actuator.damping_N_s_per_mm * v_rest
    ripple = wave_from(rig.effects.drive_ripple, rig.x_in_zero_mm)
    gear = ripple_tangent(2.0 * table.x - table.x_before, ripple)
    half = 0.5 * rig.effects.backlash.play_mm
    x = (pull - gear.slope * (table.f_in - rig.preload_N)) / stiffness  # with the end at rest
    if half > 0.0:
        play = Play(half, play_friction(table.f_in, rig) / stiffness)
        x = across_play(x, table.x, p, gear, play)
    gap = gear.ahead + gear.slope * x - p
    ahead = gear.ahead - math.copysign(half, gap)
    share = stiffness / (gear.slope * gear.slope)
    force = pull / gear.slope + rig.preload_N + share * ahead
    touches = abs(gap) * FLANK > half or half == 0.0
    return TurntableSpring(touches, x, Tangent(ahead, gear.slope), share, force)


@kernel
def turntable_at(p: float, spring: TurntableSpring) -> tuple[float, float]:
    """Return position and force of a turntable in contact with the tendon's end at p."""
    tangent = spring.tangent
    return (p - tangent.ahead) / tangent.slope, spring.force - spring.stiffness * p


@kernel
def advance_turntable(table: Turntable, x: float, f_in: float, speed: float, h: float) -> Turntable:
    """Return the turntable after a step of BDF2 to x."""
    v = (3.0 * x - 4.0 * table.x + table.x_before) / (2.0 * h)
    return Turntable(x, table.x, v, table.v, f_in, speed)


@kernel
def play_friction(tension: float, rig: Rig) -> float:
    """Return the friction of the drive while it crosses its play [N].

    The play is crossed up and down at different tensions T1 and T2; without a friction of at least
    (T1 − T2)/(T1 + T2), which is tanh(μθ) in full slip, or more by up to the sheath's drag, a cycle
    would create energy.
    """
    wrap = rig.friction_coefficient * rig.total_bend_rad
    return tension * math.tanh(wrap) + rig.effects.sheath_drag.force_N


@kernel
def across_play(x: float, x_now: float, p: float, gear: Tangent, play: Play) -> float:
    """Return the drive's position with the tendon's end at rest, with friction in the play.

    `x` is that without friction. At a flank and pushing against it there is none.
    """
    at = gear.ahead + gear.slope * x_now - p
    gap = gear.ahead + gear.slope * x - p
    if abs(at) >= play.half * FLANK and abs(gap) > play.half and at * gap > 0.0:
        return x
    return min(max(x_now, x - play.friction_mm), x + play.friction_mm)


@kernel
def ripple_tangent(x: float, ripple: Wave) -> Tangent:
    """Return the tangent of the gear's output over its input."""
    if ripple.sine_mm == ripple.cosine_mm == 0.0:
        return Tangent(0.0, 1.0)
    here, next_value = rippled(x, ripple), rippled(x + RIPPLE_STEP_MM, ripple)
    slope = (next_value - here) / RIPPLE_STEP_MM
    return Tangent(here - slope * x, slope)
