"""From sensor readings at the driven ends to the inputs of the tendon, sample by sample."""

import math
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple, Self

import numpy as np

from tsas_cli.effects import Effects
from tsas_cli.effects.backlash import follow_play
from tsas_cli.effects.bend_drift import BendDrift, drifted_bend
from tsas_cli.effects.direction_dependent_friction import direction_factor
from tsas_cli.effects.drive_damping import drive_damper_force
from tsas_cli.effects.drive_friction import drive_friction_force
from tsas_cli.effects.drive_inertia import drive_inertia_force
from tsas_cli.effects.friction_drift import FrictionDrift, friction_factor
from tsas_cli.effects.laws.tendon_law import TendonLaw, tendon_law_factor
from tsas_cli.effects.position_dependent_friction import position_factor
from tsas_cli.effects.preload_loss import PreloadLoss, lost_preload
from tsas_cli.effects.proximal_spring import proximal_spring_force
from tsas_cli.effects.sheath_drag import drag_over
from tsas_cli.effects.viscous_friction import viscous_loss
from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.wave import Wave, rippled, wave_from
from tsas_cli.physics.boundary import DISPLACEMENT, FORCE, SPRING, Boundary
from tsas_cli.physics.course import DIRECTION, DRIVE, MOTION, STEP, TRAVEL, Losses
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.sensors import true_value
from tsas_cli.support.arrays import Floats, Indices

NO_TENDON_LAW = TendonLaw()
ROUNDING = 1e-9  # of a displacement [mm] or a tension [N]: less than that is no motion


@dataclass(frozen=True)
class DriveInput:
    """Sensor readings of the given quantities at both ends during a run, shape (n,).

    `time_s` is the time since the start of the run, shape (n,); without it the run is quasi-static:
    no rate and no time plays a part. `session_s` is the start of the run since that of the first
    run of its dataset. `start_f_in_N` is the tension at the drive at the start of the run, where it
    was measured: the tendon's history before that is chosen so that it fits. `motor_mm` is the
    motor's angle in displacement of the drive, where it was recorded, shape (n,).
    """

    values: Floats
    kind: Literal["displacement", "force"] = "displacement"
    load: Literal["spring", "force", "displacement"] = "spring"
    load_values: Floats | None = None
    start_f_in_N: float | None = None
    time_s: Floats | None = None
    session_s: float = 0.0
    motor_mm: Floats | None = None

    def part(self, at: slice | Indices) -> Self:
        """Return some samples."""
        load, time_s, motor = (
            None if column is None else column[at]
            for column in (self.load_values, self.time_s, self.motor_mm)
        )
        return replace(
            self, values=self.values[at], load_values=load, time_s=time_s, motor_mm=motor
        )


@dataclass(frozen=True)
class EndInputs:
    """Inputs of the tendon over a run, and the kind of the given quantity at each end."""

    course: Floats  # with the rows of `course`
    boundary: Boundary

    @property
    def drive(self) -> Floats:
        """The drive's end of the tendon [mm], or the tension given there [N]."""
        values: Floats = self.course[DRIVE]
        return values

    def part(self, first: int, end: int) -> "EndInputs":
        """Return the samples first … end−1."""
        return replace(self, course=np.ascontiguousarray(self.course[:, first:end]))

    def after(self, before: list[float]) -> "EndInputs":
        """Return the inputs with positions of the drive prepended."""
        more = len(before)
        course = np.concatenate((np.repeat(self.course[:, :1], more, axis=1), self.course), axis=1)
        course[DRIVE, :more] = before
        course[STEP, : more + 1] = math.inf  # their speed is not known
        course[[DIRECTION, MOTION], :more], course[TRAVEL, :more] = 0.0, math.inf
        return replace(self, course=course)

    def first(self) -> "EndInputs":
        """Return the first sample alone."""
        return self.part(0, 1)


def ends_of(
    rig: Rig, drive: DriveInput, start: tuple[float, float, float] | None = None
) -> EndInputs:
    """Return the inputs of a rig's tendon for ends driven as measured.

    `start` is the position of the tendon's end at the drive at the first sample, the direction of
    its last motion and its travel since its last reversal, where the drive continues a run; None at
    the start of one.
    """
    n = drive.values.size
    time_s = np.zeros(n) if drive.time_s is None else drive.time_s
    if drive.kind == "force":
        at_drive = true_value("f_in_N", drive.values, drive.time_s, drive.session_s, rig)
        position = speed = np.zeros(n)
    else:
        x = drive.values - rig.x_in_zero_mm
        before = float(x[0]) if start is None else start[0]
        ripple = wave_from(rig.effects.drive_ripple, rig.x_in_zero_mm)
        at_drive = tendon_end(x, ripple, rig.effects.backlash.play_mm, before)
        position, speed = at_drive, np.zeros(n)
        if (  # a fit asks thousands of times
            rig.effects.viscous_friction.coefficient_N_s_per_mm != 0.0
            or rig.effects.drive_damping.coefficient_N_s_per_mm != 0.0
            or rig.effects.drive_inertia.mass_kg != 0.0
        ):
            speed = rate_of(at_drive, drive.time_s)
    at_load = np.zeros(n)
    if drive.load_values is not None and drive.load == "force":
        at_load = true_value("f_out_N", drive.load_values, drive.time_s, drive.session_s, rig)
    if drive.load_values is not None and drive.load == "displacement":
        at_load = true_value("x_out_mm", drive.load_values, drive.time_s, drive.session_s, rig)
    step_s = np.full(n, math.inf)
    if drive.time_s is not None:
        step_s[1:] = time_s[1:] - time_s[:-1]
    losses = losses_over(time_s, position, speed, drive.session_s, rig)
    direction = last_direction(at_drive, 0.0 if start is None else start[1])
    travel = since_reversal(at_drive, direction, math.inf if start is None else start[2])
    if rig.effects.tendon_law != NO_TENDON_LAW and drive.kind == "displacement":
        rate = rate_of(at_drive, drive.time_s)
        losses[:2] *= tendon_law_factor(rig.effects.tendon_law, at_drive, travel, rate)
    motion_N = force_of_motion(speed, drive.time_s, rig.effects)
    of_end = at_drive, at_load, step_s, time_s, direction, travel, motion_N
    return EndInputs(np.vstack((losses, *of_end)), boundary_of(drive))


def rate_of(values: Floats, time_s: Floats | None) -> Floats:
    """Return the rate of a quantity at each sample [1/s], 0 without times."""
    if time_s is None or values.size < 2:
        return np.zeros(values.size)
    return np.gradient(values, time_s)


def force_of_motion(speed: Floats, time_s: Floats | None, effects: Effects) -> Floats:
    """Return the force that the drive's sensor reads for the motion of the tendon's end [N]."""
    damping, mass_kg = effects.drive_damping.coefficient_N_s_per_mm, effects.drive_inertia.mass_kg
    if damping == 0.0 and mass_kg == 0.0:
        return np.zeros(speed.size)
    damped: Floats = drive_damper_force(1.0, damping) * speed
    return damped + drive_inertia_force(1.0, mass_kg) * rate_of(speed, time_s)


def force_at_drive(x: Floats, direction: Floats, of_motion: Floats, effects: Effects) -> Floats:
    """Return the force beside the tendon that the drive's sensor reads too, shape (n,) [N].

    `x` is the displacement of the tendon's end, `direction` that of its motion, 1 or −1, and
    `of_motion` that of `force_of_motion`.
    """
    friction = drive_friction_force(effects.drive_friction.friction_N, 1.0)
    stiffness = proximal_spring_force(1.0, effects.proximal_spring.stiffness_N_per_mm)
    return friction * direction + stiffness * x + of_motion


def boundary_of(drive: DriveInput) -> Boundary:
    """Return the given quantity at each end of a driven tendon."""
    return Boundary(
        FORCE if drive.kind == "force" else DISPLACEMENT,
        {"force": FORCE, "displacement": DISPLACEMENT, "spring": SPRING}[drive.load],
    )


@kernel
def tendon_end(x: Floats, ripple: Wave, play_mm: float, position: float) -> Floats:
    """Return the positions of the tendon's end at the drive for displacements of the drive [mm].

    `position` is the one before the first sample. To hand over all effects would take a hundred
    times as long as the loop.
    """
    out = np.empty(x.size)
    waves = ripple.sine_mm != 0.0 or ripple.cosine_mm != 0.0  # sines take half the time
    for i in range(x.size):
        moved = rippled(x[i], ripple) if waves else x[i]
        position = follow_play(position, moved, play_mm)
        out[i] = position
    return out


@kernel
def last_direction(x: Floats, before: float = 0.0) -> Floats:
    """Return the direction of the last motion at each sample; `before` is that at the first one.

    Within the rounding of a rest nothing moves.
    """
    out = np.full(x.size, before)
    at = x[0] if x.size else 0.0
    for i in range(1, x.size):
        out[i] = out[i - 1]
        if abs(x[i] - at) > ROUNDING:
            out[i], at = np.sign(x[i] - at), x[i]
    return out


@kernel
def since_reversal(x: Floats, direction: Floats, before: float) -> Floats:
    """Return the travel since the last reversal at each sample [mm]; `before` is that at the first.

    The first motion of a run is no reversal.
    """
    out = np.full(x.size, before)
    for i in range(1, x.size):
        moved = abs(x[i] - x[i - 1])
        turned = direction[i] * direction[i - 1] < 0.0
        out[i] = moved if turned else out[i - 1] + moved
    return out


class LossValues(NamedTuple):
    """The values of a rig that its losses depend on.

    To hand over the whole rig would take a hundred times as long as the loop.
    """

    friction_coefficient: float
    total_bend_rad: float
    asymmetry: float
    friction_drift: FrictionDrift
    bend_drift: BendDrift
    slope_per_mm: float
    viscous_N_s_per_mm: float
    drag_N: float
    preload_loss: PreloadLoss


def loss_values(rig: Rig) -> LossValues:
    """Return the values that the losses of a rig depend on."""
    effects = rig.effects
    return LossValues(
        rig.friction_coefficient,
        rig.total_bend_rad,
        effects.direction_dependent_friction.asymmetry,
        effects.friction_drift,
        effects.bend_drift,
        effects.position_dependent_friction.slope_per_mm,
        effects.viscous_friction.coefficient_N_s_per_mm,
        effects.sheath_drag.force_N,
        effects.preload_loss,
    )


_loss_values = kernel(loss_values)


def losses_over(
    time_s: Floats, position: Floats, speed: Floats, session_s: float, rig: Rig
) -> Floats:
    """Return `losses_at` for each time, shape (4, n)."""
    return _losses_over(time_s, position, speed, session_s, loss_values(rig))


@kernel
def _losses_over(
    time_s: Floats, position: Floats, speed: Floats, session_s: float, values: LossValues
) -> Floats:
    out = np.empty((4, time_s.size))
    for i in range(time_s.size):
        now = _losses(time_s[i], position[i], speed[i], session_s, values)
        out[0, i], out[1, i], out[2, i], out[3, i] = now
    return out


@kernel
def losses_at(time_s: float, position: float, speed: float, session_s: float, rig: Rig) -> Losses:
    """Return the losses at one moment, by position and speed of the end at the drive [mm, s]."""
    return _losses(time_s, position, speed, session_s, _loss_values(rig))


@kernel
def _losses(
    time_s: float, position: float, speed: float, session_s: float, values: LossValues
) -> Losses:
    wrap = values.friction_coefficient * friction_factor(values.friction_drift, time_s, session_s)
    wrap *= drifted_bend(values.total_bend_rad, values.bend_drift, time_s)
    wrap *= position_factor(position, values.slope_per_mm)
    return Losses(
        wrap * direction_factor(values.asymmetry, 1.0),
        wrap * direction_factor(values.asymmetry, -1.0),
        viscous_loss(speed, values.viscous_N_s_per_mm) + drag_over(1.0, values.drag_N),
        lost_preload(values.preload_loss, time_s),
    )
