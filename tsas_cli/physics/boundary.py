"""Boundary conditions of the tendon: the given quantity at each end, and the laws of the load."""

from typing import NamedTuple

from tsas_cli.effects.load_friction import LoadFriction, guide_friction
from tsas_cli.effects.load_hysteresis import LoadHysteresis
from tsas_cli.effects.load_relaxation import LoadRelaxation
from tsas_cli.effects.load_spring_nonlinearity import (
    LoadSpringNonlinearity,
    spring_force,
    spring_tangent,
)
from tsas_cli.numerics.compiled import kernel
from tsas_cli.numerics.wave import Wave, wave_at
from tsas_cli.physics.rig import Rig

DISPLACEMENT, FORCE, SPRING = 0, 1, 2  # the given quantity at an end


class Boundary(NamedTuple):
    """The given quantity at each end."""

    drive: int
    load: int


class DriveEnd(NamedTuple):
    """The proximal end: the given quantity; what is parallel to the tendon."""

    given: int
    friction_N: float
    spring_N_per_mm: float
    spring_N: float  # its force at x = 0
    damping_N_s_per_mm: float
    mass_kg: float


class LoadEnd(NamedTuple):
    """The distal end: the given quantity; all that the load consists of."""

    given: int
    stiffness_N_per_mm: float
    nonlinearity: LoadSpringNonlinearity
    ripple: Wave
    friction: LoadFriction
    mass_kg: float
    damping_N_s_per_mm: float
    hysteresis: LoadHysteresis
    relaxation: LoadRelaxation


@kernel
def drive_end(rig: Rig, given: int) -> DriveEnd:
    """Return the proximal end of a rig."""
    effects = rig.effects
    return DriveEnd(
        given,
        effects.drive_friction.friction_N,
        effects.proximal_spring.stiffness_N_per_mm,
        0.0,
        effects.drive_damping.coefficient_N_s_per_mm,
        effects.drive_inertia.mass_kg,
    )


@kernel
def free_drive(given: int) -> DriveEnd:
    """Return a proximal end with nothing in parallel to the tendon."""
    return DriveEnd(given, 0.0, 0.0, 0.0, 0.0, 0.0)


@kernel
def with_spring(
    drive: DriveEnd, given: int, spring_N_per_mm: float, spring_N: float = 0.0
) -> DriveEnd:
    """Return a proximal end with another given quantity and another spring."""
    damping, mass = drive.damping_N_s_per_mm, drive.mass_kg
    return DriveEnd(given, drive.friction_N, spring_N_per_mm, spring_N, damping, mass)


@kernel
def load_end(rig: Rig, given: int) -> LoadEnd:
    """Return the distal end of a rig."""
    effects = rig.effects
    return LoadEnd(
        given,
        rig.load_stiffness_N_per_mm,
        effects.load_spring_nonlinearity,
        effects.load_ripple,
        effects.load_friction,
        effects.load_inertia.mass_kg,
        effects.load_damping.coefficient_N_s_per_mm,
        effects.load_hysteresis,
        effects.load_relaxation,
    )


@kernel
def with_given(load: LoadEnd, given: int) -> LoadEnd:
    """Return a distal end with another given quantity."""
    return LoadEnd(
        given,
        load.stiffness_N_per_mm,
        load.nonlinearity,
        load.ripple,
        load.friction,
        load.mass_kg,
        load.damping_N_s_per_mm,
        load.hysteresis,
        load.relaxation,
    )


@kernel
def spring_law(x: float, load: LoadEnd) -> tuple[float, float]:
    """Return the load spring's force above the preload [N] and its slope [N/mm]."""
    stiffness = load.stiffness_N_per_mm
    force = spring_force(x, stiffness, load.nonlinearity)
    slope = spring_tangent(x, stiffness, load.nonlinearity)
    if load.ripple.sine_mm != 0.0 or load.ripple.cosine_mm != 0.0:
        wave, steeper = wave_at(x, load.ripple)
        force += stiffness * wave
        slope += stiffness * steeper
    return force, slope


@kernel
def moving_friction(load: LoadEnd) -> float:
    """Return the friction of the load's guide that acts on a moving load end [N]."""
    if load.given == SPRING:
        return guide_friction(load.friction)
    return load.friction.before_sensor_N if load.given == FORCE else 0.0


@kernel
def share_before_sensor(load: LoadEnd) -> float:
    """Return the share of the guide's friction that acts before the load's force sensor.

    It is 1 where the load's displacement is given: the friction behind the sensor plays no part.
    """
    before = load.friction.before_sensor_N
    if before == 0.0:
        return 0.0
    return 1.0 if load.given == DISPLACEMENT else before / guide_friction(load.friction)


@kernel
def unloaded_position(x: float, preload_N: float, load: LoadEnd) -> float:
    """Return the position of the load without tension [mm], iterated from x."""
    for _ in range(5):  # Newton's method, exact after one iteration for a linear spring
        force, slope = spring_law(x, load)
        x -= (preload_N + force) / slope
    return x
