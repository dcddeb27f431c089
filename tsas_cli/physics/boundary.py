"""The two ends of the tendon: what is given there, and where a load rests that nothing pulls."""

from typing import NamedTuple

from tsas_cli.effects.load_spring_nonlinearity import (
    LoadSpringNonlinearity,
    spring_force,
    spring_tangent,
)
from tsas_cli.numerics.compiled import kernel

DISPLACEMENT, FORCE, SPRING = 0, 1, 2  # what is given at an end


class Boundary(NamedTuple):
    """What is given at the two ends: the kind of each."""

    drive: int
    load: int


@kernel
def unloaded_position(
    x: float, preload_N: float, stiffness: float, shape: LoadSpringNonlinearity
) -> float:
    """Return where a spring of a preload leaves the load without tension [mm], sought from x."""
    for _ in range(5):  # Newton's method, exact at once for a straight spring
        force = preload_N + spring_force(x, stiffness, shape)
        x -= force / spring_tangent(x, stiffness, shape)
    return x
