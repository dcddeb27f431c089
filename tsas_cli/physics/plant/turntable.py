"""The plant of a closed loop: motor, gear with finite stiffness, turntable, tendon and load.

    lag · dw/dt + w = u,  dx_m/dt = K w                              motor speed w, asked for u
    m d²x/dt² + B dx/dt + k_d (x − x_m) + dp/dx (F(p) − F0) = 0       turntable, m = J/r1²
    p = play(x + ripple(x))                                          the tendon's end

Yang 2025, Eqs. (23) to (25), with the reaction k_d (x − x_m) of the drive's stiffness that Eq. (25)
lacks. F is what the slip chain, the drive's friction and a spring beside the tendon pull with.

Discretisation: the motor exactly for a speed that is held, the turntable by BDF2 with a constant
step (second order), in which F is implicit: a turntable after a step is a linear spring of
stiffness m c² + B c + k_d, c = 3/(2h), at whose end the slip chain hangs. The speed in what
depends on speed (viscous, Stribeck friction) is that of the step before: first order there. While
the drive crosses its play the tendon's end rests and pulls on; the play rubs (`rubbing`).
"""

import math
from typing import NamedTuple

from tsas_cli.effects.drive_ripple import DriveRipple, rippled
from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import FORCE, SPRING, Boundary
from tsas_cli.physics.ends import friction_at
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.slip.chain import advance, go_slack
from tsas_cli.physics.slip.state import POSITION, SLIP, TENSION, Floats, Moment, SlipLaws

FLANK = 1.0 - 1e-9  # of half the play, from which the drive is at its flank
RIPPLE_STEP_MM = 1e-4  # over which the slope of the ripple is taken


class Actuator(NamedTuple):
    """Motor and gear (the paper's symbols in brackets)."""

    gain_mm_per_s_rpm: float  # [2π r1/(60 im)]
    stiffness_N_per_mm: float  # [km as chosen for kr, Eq. (34)]
    inertia_N_s2_per_mm: float  # [J/r1²]
    damping_N_s_per_mm: float  # [B]
    motor_lag_s: float
    speed_limit_rpm: float


class Turntable(NamedTuple):
    """Motion of motor and turntable after a step; `before` is a step earlier."""

    motor_rpm: float
    motor_mm: float
    x: float
    x_before: float
    v: float
    v_before: float
    f_in: float  # what a sensor at the drive reads [N]
    speed: float  # of the tendon's end [mm/s]


class TurntableSpring(NamedTuple):
    """What the turntable is for the tendon's end p at the end of a step: a spring.

    It pulls with drive − share p where it touches the tendon, p = ahead + slope x there.
    """

    touches: bool  # False while it crosses its play
    x: float  # where the tendon's end rests [mm]
    ahead: float
    slope: float
    share: float  # [N/mm]
    drive: float  # [N]


@kernel
def advance_motor(table: Turntable, asked_rpm: float, actuator: Actuator, h: float) -> Turntable:
    """Return motor speed and travel after h with a speed asked for, exactly."""
    lag = actuator.motor_lag_s
    left = math.exp(-h / lag) if lag > 0.0 else 0.0
    rest = table.motor_rpm - asked_rpm
    way = actuator.gain_mm_per_s_rpm * (asked_rpm * h + rest * lag * (1.0 - left))
    return Turntable(
        asked_rpm + rest * left,
        table.motor_mm + way,
        table.x,
        table.x_before,
        table.v,
        table.v_before,
        table.f_in,
        table.speed,
    )


@kernel
def step_plant(
    table: Turntable,
    chain: Floats,
    before: Moment,
    time_s: float,
    rig: Rig,
    laws: SlipLaws,
    actuator: Actuator,
    h: float,
    scale: float,
) -> tuple[Turntable, Moment, bool]:
    """Move turntable, tendon and load by h to a time, the motor being there already.

    Returns the turntable, the moment that the chain has come to, and whether it settled.
    """
    p = chain[POSITION]
    reach = spring_of(table, p, rig, actuator, h)
    settled, now, x, f_in = True, before, reach.x, table.f_in
    if reach.touches:
        pulled, released, viscous_N, lost_N = friction_at(time_s, table.speed, 0.0, rig)
        now = Moment(reach.drive, 0.0, pulled, released, viscous_N, lost_N, h)
        boundary = Boundary(FORCE, SPRING)
        settled = advance(chain, before, now, boundary, with_drive_spring(laws, reach.share), scale)
        if chain[TENSION] < 0.0:
            go_slack(chain, now, boundary, laws)
            rubs = chain[SLIP] * laws.drive_friction_N
            chain[POSITION] = (reach.drive - rubs) / (reach.share + laws.proximal_spring_N_per_mm)
        x, f_in = turntable_at(chain[POSITION], reach)
    return advance_turntable(table, x, f_in, (chain[POSITION] - p) / h, h), now, settled


@kernel
def spring_of(
    table: Turntable, p: float, rig: Rig, actuator: Actuator, h: float
) -> TurntableSpring:
    """Return what a turntable is for the tendon, whose end is at p, at the end of a step."""
    c, m = 1.5 / h, actuator.inertia_N_s2_per_mm
    v_rest = (-4.0 * table.x + table.x_before) / (2.0 * h)
    a_rest = c * v_rest + (-4.0 * table.v + table.v_before) / (2.0 * h)
    stiffness = m * c * c + actuator.damping_N_s_per_mm * c + actuator.stiffness_N_per_mm
    pull = actuator.stiffness_N_per_mm * table.motor_mm - m * a_rest
    pull -= actuator.damping_N_s_per_mm * v_rest
    ahead, slope = ripple_at(2.0 * table.x - table.x_before, rig.effects.drive_ripple)
    half = 0.5 * rig.effects.backlash.play_mm
    x = (pull - slope * (table.f_in - rig.preload_N)) / stiffness  # with the end where it is
    if half > 0.0:
        x = across_play(x, table, p, ahead, slope, half, play_friction(table.f_in, rig) / stiffness)
    gap = ahead + slope * x - p
    ahead -= math.copysign(half, gap)
    share = stiffness / (slope * slope)
    drive = pull / slope + rig.preload_N + share * ahead
    return TurntableSpring(abs(gap) * FLANK > half or half == 0.0, x, ahead, slope, share, drive)


@kernel
def turntable_at(p: float, reach: TurntableSpring) -> tuple[float, float]:
    """Return where a turntable is that holds the tendon's end at p, and its force there."""
    return (p - reach.ahead) / reach.slope, reach.drive - reach.share * p


@kernel
def advance_turntable(table: Turntable, x: float, f_in: float, speed: float, h: float) -> Turntable:
    """Return the turntable after a step of BDF2 to x."""
    v = (3.0 * x - 4.0 * table.x + table.x_before) / (2.0 * h)
    return Turntable(table.motor_rpm, table.motor_mm, x, table.x, v, table.v, f_in, speed)


@kernel
def play_friction(tension: float, rig: Rig) -> float:
    """Return what holds the drive while it crosses its play [N].

    Up and down it is crossed at different tensions T1 and T2: each time that would give energy but
    for a friction of at least (T1 − T2)/(T1 + T2), which is tanh(μθ) in full slip.
    """
    return tension * math.tanh(rig.friction_coefficient * rig.total_bend_rad)


@kernel
def across_play(
    x: float, table: Turntable, p: float, ahead: float, slope: float, half: float, held: float
) -> float:
    """Return where the drive is with the tendon's end at rest, friction in the play counted.

    `x` is where it would be without. At a flank and pushing against it nothing rubs.
    """
    at = ahead + slope * table.x - p
    gap = ahead + slope * x - p
    if abs(at) >= half * FLANK and abs(gap) > half and at * gap > 0.0:
        return x
    return min(max(table.x, x - held), x + held)


@kernel
def with_drive_spring(laws: SlipLaws, stiffness: float) -> SlipLaws:
    """Return the laws with a spring more between the tendon's end and the ground [N/mm]."""
    return SlipLaws(
        laws.n,
        laws.preload_N,
        laws.load_stiffness_N_per_mm,
        laws.load_spring,
        laws.load_friction,
        laws.load_mass_kg,
        laws.drive_friction_N,
        laws.proximal_spring_N_per_mm + stiffness,
        laws.friction_exponent,
        laws.presliding_mm,
    )


@kernel
def ripple_at(x: float, ripple: DriveRipple) -> tuple[float, float]:
    """Return value at x = 0 and slope of the tangent of the gear's output over its input."""
    if ripple.sine_mm == ripple.cosine_mm == 0.0:
        return 0.0, 1.0
    here, there = rippled(x, ripple), rippled(x + RIPPLE_STEP_MM, ripple)
    slope = (there - here) / RIPPLE_STEP_MM
    return here - slope * x, slope
