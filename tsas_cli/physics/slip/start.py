"""The slip chain before its first sample: the laws of a rig, and its nodes at rest."""

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import Boundary, DriveEnd, drive_end, load_end
from tsas_cli.physics.mesh import PITCH, segment_compliances
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.slip.state import COMPLIANCE, ROWS, TENSION, TENSION_BEFORE, SlipLaws
from tsas_cli.support.arrays import Floats


@kernel
def chain_at_rest(rig: Rig, n: int) -> Floats:
    """Return the chain at uniform preload."""
    chain = np.empty(ROWS * PITCH)
    for row in range(ROWS):
        for j in range(n + 2):
            chain[PITCH * row + j] = 0.0
    for j in range(n + 2):
        chain[TENSION + j] = chain[TENSION_BEFORE + j] = rig.preload_N
    set_compliances(chain, rig, n)
    return chain


@kernel
def set_compliances(chain: Floats, rig: Rig, n: int) -> None:
    """Set the compliances of the segments; the load's end has that of the last one."""
    compliances = segment_compliances(rig, n)
    for j in range(n + 2):
        chain[COMPLIANCE + j] = compliances[min(j, n)]


@kernel
def slip_laws(rig: Rig, n: int, boundary: Boundary) -> SlipLaws:
    """Return the constants of the rig for a static problem, with the given ends."""
    return SlipLaws(
        n,
        rig.preload_N,
        rig.sheath_length_mm * rig.preload_N / rig.tendon_stiffness_N / n + 1e-9,
        rig.effects.load_dependent_friction.exponent,
        rig.effects.uneven_friction.slope,
        rig.effects.presliding.length_mm,
        rig.effects.stribeck_friction,
        drive_end(rig, boundary.drive),
        load_end(rig, boundary.load),
    )


@kernel
def with_drive(laws: SlipLaws, drive: DriveEnd) -> SlipLaws:
    """Return the laws with another end at the drive."""
    return SlipLaws(
        laws.n,
        laws.preload_N,
        laws.scale_mm,
        laws.friction_exponent,
        laws.friction_slope,
        laws.presliding_mm,
        laws.stribeck,
        drive,
        laws.load,
    )
