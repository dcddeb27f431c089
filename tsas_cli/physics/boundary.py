"""The two ends of the tendon: what is given there, and the laws of what hangs there."""

from typing import NamedTuple

from tsas_cli.effects.load_friction import LoadFriction, guide_friction
from tsas_cli.effects.load_spring_nonlinearity import (
    LoadSpringNonlinearity,
    spring_force,
    spring_tangent,
)
from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.rig import Rig

DISPLACEMENT, FORCE, SPRING = 0, 1, 2  # what is given at an end


class Boundary(NamedTuple):
    """What is given at the two ends: the kind of each."""

    drive: int
    load: int


class DriveEnd(NamedTuple):
    """The proximal end: what is given there, and friction and a spring beside the tendon."""

    given: int
    friction_N: float
    spring_N_per_mm: float


class LoadEnd(NamedTuple):
    """The distal end: what is given there, and spring, guide and mass of the load."""

    given: int
    stiffness_N_per_mm: float
    nonlinearity: LoadSpringNonlinearity
    friction: LoadFriction
    mass_kg: float


@kernel
def drive_end(rig: Rig, given: int) -> DriveEnd:
    """Return the proximal end of a rig."""
    effects = rig.effects
    stiffness = effects.proximal_spring.stiffness_N_per_mm
    return DriveEnd(given, effects.drive_friction.friction_N, stiffness)


@kernel
def load_end(rig: Rig, given: int) -> LoadEnd:
    """Return the distal end of a rig."""
    effects = rig.effects
    return LoadEnd(
        given,
        rig.load_stiffness_N_per_mm,
        effects.load_spring_nonlinearity,
        effects.load_friction,
        effects.load_inertia.mass_kg,
    )


@kernel
def moving_friction(load: LoadEnd) -> float:
    """Return the friction of the load's guide that a moving load end feels [N]."""
    if load.given == SPRING:
        return guide_friction(load.friction)
    return load.friction.before_sensor_N if load.given == FORCE else 0.0


@kernel
def share_before_sensor(load: LoadEnd) -> float:
    """Return the share of the guide's friction that the load's force sensor does not feel.

    Where the load's displacement is given that is all there is: the friction before the sensor.
    """
    before = load.friction.before_sensor_N
    if before == 0.0:
        return 0.0
    return 1.0 if load.given == DISPLACEMENT else before / guide_friction(load.friction)


@kernel
def unloaded_position(x: float, preload_N: float, load: LoadEnd) -> float:
    """Return where a spring of a preload leaves the load without tension [mm], sought from x."""
    for _ in range(5):  # Newton's method, exact at once for a straight spring
        force = preload_N + spring_force(x, load.stiffness_N_per_mm, load.nonlinearity)
        x -= force / spring_tangent(x, load.stiffness_N_per_mm, load.nonlinearity)
    return x
