"""The slip chain before its first sample: the laws of a rig, and its nodes at rest."""

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.boundary import (
    DISPLACEMENT,
    Boundary,
    DriveEnd,
    drive_end,
    load_end,
    with_given,
)
from tsas_cli.physics.mesh import PITCH, segment_compliances
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.slip import state as at
from tsas_cli.physics.slip.state import ROWS, SlipLaws
from tsas_cli.support.arrays import Floats


@kernel
def chain_at_rest(rig: Rig, n: int) -> Floats:
    """Return the chain at uniform preload, with that of an antagonist behind it if there is one."""
    second_N = rig.effects.antagonist.preload_N
    tendons = 2 if second_N > 0.0 else 1
    chain = np.empty(tendons * at.SECOND)
    for row in range(tendons * ROWS):
        for j in range(n + 2):
            chain[PITCH * row + j] = 0.0
    for j in range(n + 2):
        chain[at.TENSION + j] = chain[at.TENSION_BEFORE + j] = rig.preload_N + second_N
    set_compliances(chain, rig, n)
    if second_N > 0.0:
        second = chain[at.SECOND :]
        for j in range(n + 2):
            second[at.TENSION + j] = second[at.TENSION_BEFORE + j] = second_N
            second[at.COMPLIANCE + j] = chain[at.COMPLIANCE + max(n - j, 0)]
    return chain


@kernel
def set_compliances(chain: Floats, rig: Rig, n: int) -> None:
    """Set the compliances of the segments; the load's end has that of the last one."""
    compliances = segment_compliances(rig, n)
    for j in range(n + 2):
        chain[at.COMPLIANCE + j] = compliances[min(j, n)]


@kernel
def slip_laws(rig: Rig, n: int, boundary: Boundary) -> SlipLaws:
    """Return the constants of the rig for a static problem, with the given ends."""
    antagonist = rig.effects.antagonist
    preload_N = rig.preload_N + antagonist.preload_N
    return SlipLaws(
        n,
        preload_N,
        rig.preload_N,
        rig.sheath_length_mm * preload_N / rig.tendon_stiffness_N / n + 1e-9,
        rig.effects.load_dependent_friction.exponent,
        rig.effects.uneven_friction.slope,
        rig.effects.presliding.length_mm,
        rig.effects.stribeck_friction,
        drive_end(rig, boundary.drive),
        load_end(rig, boundary.load),
        antagonist,
    )


@kernel
def with_drive(laws: SlipLaws, drive: DriveEnd) -> SlipLaws:
    """Return the laws with another end at the drive."""
    return SlipLaws(
        laws.n,
        laws.preload_N,
        laws.load_preload_N,
        laws.scale_mm,
        laws.friction_exponent,
        laws.friction_slope,
        laws.presliding_mm,
        laws.stribeck,
        drive,
        laws.load,
        laws.antagonist,
    )


@kernel
def laws_of_second(laws: SlipLaws) -> SlipLaws:
    """Return the laws of an antagonist, whose both ends have given displacements."""
    return SlipLaws(
        laws.n,
        laws.antagonist.preload_N,
        laws.load_preload_N,
        laws.scale_mm,
        laws.friction_exponent,
        -laws.friction_slope,
        laws.presliding_mm,
        laws.stribeck,
        DriveEnd(DISPLACEMENT, 0.0, 0.0, 0.0, 0.0),
        with_given(laws.load, DISPLACEMENT),
        laws.antagonist,
    )
