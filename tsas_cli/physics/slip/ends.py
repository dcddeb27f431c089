"""The two ends of the slip chain: the load's spring, mass and guide, what is beside the drive."""

import math

from tsas_cli.effects.drive_damping import drive_damper_force
from tsas_cli.effects.drive_inertia import drive_inertia_force
from tsas_cli.effects.load_damping import load_damper_force
from tsas_cli.effects.load_hysteresis import element_force
from tsas_cli.effects.load_inertia import inertia_force
from tsas_cli.effects.load_relaxation import relaxing_force
from tsas_cli.effects.proximal_spring import proximal_spring_force
from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.settling import lag_after
from tsas_cli.physics.boundary import DISPLACEMENT, FORCE, SPRING, moving_friction, spring_law
from tsas_cli.physics.slip import state as at
from tsas_cli.physics.slip.nodes import slips_backwards
from tsas_cli.physics.slip.state import BALANCED, TOLERANCE, Moment, SlipLaws
from tsas_cli.support.arrays import Floats

# A mass takes up its speed late by this: its resonance on the tendon, at 50 to 300 rad/s, has a
# tenth to a half of the critical damping, for that of materials and guides; else it would ring on.
SLIPS_ALONG_S = 0.004


@kernel
def backward_difference(rows: tuple[int, int], chain: Floats, step_s: float) -> tuple[float, float]:
    """Return slope and value at zero of a quantity's rate of change by BDF2, over its new value.

    `rows` are those of the quantity before and a step earlier. The steps may differ in length;
    after an infinite one it is implicit Euler.
    """
    before, earlier = rows
    ratio = step_s / chain[at.STEP_BEFORE]
    both_s = step_s * (1.0 + ratio)
    rest = -(1.0 + ratio) / step_s * chain[before] + ratio * ratio / both_s * chain[earlier]
    return (1.0 + 2.0 * ratio) / both_s, rest


@kernel
def speed_tangent(chain: Floats, step_s: float, end: int) -> tuple[float, float]:
    """Return slope and value at x = 0 of the speed of an end [1/s, mm/s]."""
    return backward_difference((at.POSITION_BEFORE + end, at.POSITION_EARLIER + end), chain, step_s)


@kernel
def acceleration_of_speed(chain: Floats, step_s: float, end: int) -> tuple[float, float]:
    """Return slope [1/s] and value at rest [mm/s²] of a mass's acceleration over its speed."""
    rows = (at.SPEED_BEFORE + end, at.SPEED_EARLIER + end)
    per_speed, value = backward_difference(rows, chain, step_s)
    share = 1.0 / (1.0 + SLIPS_ALONG_S * per_speed)
    return share * per_speed, share * value


@kernel
def acceleration_tangent(chain: Floats, step_s: float, end: int) -> tuple[float, float]:
    """Return slope and value at x = 0 of the acceleration of a mass at an end [1/s², mm/s²]."""
    slope, speed = speed_tangent(chain, step_s, end)
    per_speed, at_rest = acceleration_of_speed(chain, step_s, end)
    return per_speed * slope, per_speed * speed + at_rest


@kernel
def load_tangent(chain: Floats, now: Moment, laws: SlipLaws) -> tuple[float, float]:
    """Return slope and value at x = 0 of the tangent of the load's force [N/mm, N]."""
    n = laws.n
    x = chain[at.POSITION + n + 1]
    force, slope = spring_law(x, laws.load)
    value = force - slope * x
    value += laws.load_preload_N - now.losses.preload_N
    mass = laws.load.mass_kg
    if mass > 0.0 and now.step_s < math.inf:
        per_mm_s2, acceleration = acceleration_tangent(chain, now.step_s, n + 1)
        slope += inertia_force(per_mm_s2, mass)
        value += inertia_force(acceleration, mass)
    damping = laws.load.damping_N_s_per_mm
    if damping > 0.0 and now.step_s < math.inf:
        per_mm = load_damper_force(1.0 / now.step_s, damping)
        slope += per_mm
        value -= per_mm * chain[at.POSITION_BEFORE + n + 1]
    if laws.load.hysteresis.force_N > 0.0:
        moved = x - chain[at.POSITION_BEFORE + n + 1]
        force, stiffness = element_force(chain[at.ELEMENT], moved, laws.load.hysteresis)
        slope += stiffness
        value += force - stiffness * x
    if laws.load.relaxation.share > 0.0:
        kept, gained = relaxing_stretch(chain, now.step_s, laws)
        share, stiffness = laws.load.relaxation.share, laws.load.stiffness_N_per_mm
        slope += relaxing_force(gained, stiffness, share)
        at_zero = kept - gained * chain[at.POSITION_BEFORE + n + 1]
        value += relaxing_force(at_zero, stiffness, share)
    return slope, value


@kernel
def pull_at_load(chain: Floats, now: Moment, laws: SlipLaws) -> tuple[float, float]:
    """Return slope and value at x = 0 of the tangent of the first tendon's tension [N/mm, N].

    It holds the load and the antagonist, if there is one; the guide's friction is not in it.
    """
    slope, value = load_tangent(chain, now, laws) if laws.load.given == SPRING else (0.0, now.load)
    if laws.antagonist.preload_N > 0.0 and chain[at.SECOND + at.IS_SLACK] == 0.0:
        r = chain[at.SECOND + at.SWEEP_R]
        slope += chain[at.SECOND + at.SWEEP_P] / r
        value += chain[at.SECOND + at.SWEEP_Q] / r
    return slope, value


@kernel
def tension_of_second(chain: Floats, j: int, laws: SlipLaws) -> float:
    """Return the tension of an antagonist's segment, 0 at the load and n at the drive [N]."""
    return float(chain[at.SECOND + at.TENSION + j]) if laws.antagonist.preload_N > 0.0 else 0.0


@kernel
def update_end_speeds(chain: Floats, step_s: float, n: int) -> None:
    """Update what the masses at both ends remember, after a step and before `accept`."""
    if step_s == math.inf:
        stop_ends(chain, n)
        return
    for end in (0, n + 1):
        slope, value = speed_tangent(chain, step_s, end)
        speed = slope * chain[at.POSITION + end] + value
        per_speed, at_rest = acceleration_of_speed(chain, step_s, end)
        chain[at.SPEED_EARLIER + end] = chain[at.SPEED_BEFORE + end]
        chain[at.SPEED_BEFORE + end] = speed - SLIPS_ALONG_S * (per_speed * speed + at_rest)
        chain[at.POSITION_EARLIER + end] = chain[at.POSITION_BEFORE + end]
    chain[at.STEP_BEFORE] = step_s


@kernel
def stop_ends(chain: Floats, n: int) -> None:
    """Set the masses at both ends to rest."""
    for end in (0, n + 1):
        chain[at.SPEED_BEFORE + end] = 0.0
    chain[at.STEP_BEFORE] = math.inf


@kernel
def relaxing_stretch(chain: Floats, step_s: float, laws: SlipLaws) -> tuple[float, float]:
    """Return what a step leaves of the relaxing spring's stretch [mm], and adds for each mm."""
    time_s = laws.load.relaxation.time_s
    return lag_after(chain[at.STRETCH], 0.0, step_s, time_s), lag_after(0.0, 1.0, step_s, time_s)


@kernel
def update_load_state(chain: Floats, step_s: float, laws: SlipLaws) -> None:
    """Update the state of what is beside the load spring after a step."""
    if laws.load.relaxation.share > 0.0:
        moved = chain[at.POSITION + laws.n + 1] - chain[at.POSITION_BEFORE + laws.n + 1]
        kept, gained = relaxing_stretch(chain, step_s, laws)
        chain[at.STRETCH] = kept + gained * moved
    if laws.load.hysteresis.force_N > 0.0:
        moved = chain[at.POSITION + laws.n + 1] - chain[at.POSITION_BEFORE + laws.n + 1]
        chain[at.ELEMENT] = element_force(chain[at.ELEMENT], moved, laws.load.hysteresis)[0]


@kernel
def drive_position(chain: Floats, now: Moment, laws: SlipLaws) -> float:
    """Return the position of the drive's end [mm]."""
    if laws.drive.given == DISPLACEMENT:
        return now.drive
    friction = laws.drive.friction_N
    if chain[at.SLIP] == 0 and friction > 0.0:
        return float(chain[at.POSITION_BEFORE])
    p, q, r = chain[at.SWEEP_P], chain[at.SWEEP_Q], chain[at.SWEEP_R]
    slope, value = drive_tangent(chain, now, laws)
    return float(((now.drive - value - chain[at.SLIP] * friction) * r - q) / (p + slope * r))


@kernel
def drive_tangent(chain: Floats, now: Moment, laws: SlipLaws) -> tuple[float, float]:
    """Return slope and value at x = 0 of the force beside the tendon at a drive by force."""
    slope = proximal_spring_force(1.0, laws.drive.spring_N_per_mm)
    value = laws.drive.spring_N
    if now.step_s < math.inf:
        per_mm = drive_damper_force(1.0 / now.step_s, laws.drive.damping_N_s_per_mm)
        per_mm_s2, acceleration = acceleration_tangent(chain, now.step_s, 0)
        slope += per_mm + drive_inertia_force(per_mm_s2, laws.drive.mass_kg)
        value += drive_inertia_force(acceleration, laws.drive.mass_kg)
        value -= per_mm * chain[at.POSITION_BEFORE]  # the damper by implicit Euler
    return slope, value


@kernel
def update_end(i: int, pull: float, friction: float, chain: Floats, laws: SlipLaws) -> bool:
    """Update slip or stick of an end with constant friction; return whether it changed."""
    if chain[at.SLIP + i] != 0:
        if slips_backwards(i, chain, laws):
            chain[at.SLIP + i] = 0
            return True
    elif abs(pull) > friction * (1.0 + TOLERANCE):
        chain[at.SLIP + i] = 1 if pull > 0.0 else -1
        return True
    return False


@kernel
def update_ends(chain: Floats, now: Moment, laws: SlipLaws) -> bool:
    """Update slip or stick of the ends; return whether one changed, or a tangent is inexact."""
    n = laws.n
    unsolved = False
    if laws.drive.given == FORCE:
        slope, value = drive_tangent(chain, now, laws)
        pull = now.drive - chain[at.TENSION] - slope * chain[at.POSITION] - value
        if laws.drive.friction_N > 0.0:
            unsolved = update_end(0, pull, laws.drive.friction_N, chain, laws)
    if laws.load.given != DISPLACEMENT:
        pull = chain[at.TENSION + n] - load_force(chain, now, laws)
        friction = moving_friction(laws.load)
        if friction > 0.0:
            unsolved = update_end(n + 1, pull, friction, chain, laws) or unsolved
        if friction == 0.0 or chain[at.SLIP + n + 1] != 0:
            imbalance = abs(pull - chain[at.SLIP + n + 1] * friction)
            unsolved = (
                imbalance > BALANCED * (abs(chain[at.TENSION + n]) + laws.preload_N) or unsolved
            )
    return unsolved


@kernel
def load_force(chain: Floats, now: Moment, laws: SlipLaws) -> float:
    """Return the first tendon's tension that balances the load as it is, without friction [N]."""
    slope, value = pull_at_load(chain, now, laws)
    return float(slope * chain[at.POSITION + laws.n + 1] + value)
