"""What the slip chain takes from a rig: its segments' springs, its laws, and its nodes at rest."""

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.compliances import (
    compliance_at_drive,
    compliance_at_load,
    length_per_angle,
    sheath_compliance,
)
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.slip.state import GIVE, PITCH, ROWS, T_OLD, Floats, Laws, T


@kernel
def at_rest(rig: Rig, n: int) -> Floats:
    """Return the chain at uniform preload."""
    chain = np.empty(ROWS * PITCH)
    for row in range(ROWS):
        for j in range(n + 2):
            chain[PITCH * row + j] = 0.0
    gives = segment_compliances(rig, n)
    for j in range(n + 2):
        chain[T + j] = chain[T_OLD + j] = rig.preload_N
        chain[GIVE + j] = gives[min(j, n)]
    return chain


@kernel
def laws_of(rig: Rig, n: int) -> Laws:
    """Return what of the rig a static problem needs."""
    effects = rig.effects
    return Laws(
        n,
        rig.preload_N,
        rig.load_stiffness_N_per_mm,
        effects.load_spring_nonlinearity,
        effects.load_friction,
        effects.load_inertia.mass_kg,
        effects.drive_friction.friction_N,
        effects.proximal_spring.stiffness_N_per_mm,
        effects.load_dependent_friction.exponent,
        effects.presliding.length_mm,
    )


@kernel
def segment_compliances(rig: Rig, n: int) -> Floats:
    """Return the compliance of each of the n + 1 segments, shape (n + 1,) [mm/N]."""
    sheathed = sheath_compliance(rig) / n
    compliance = np.empty(n + 1)
    for i in range(n + 1):
        start, end = max(2 * i - 1, 0), min(2 * i + 1, 2 * n)  # in halves of a node's bend
        at = 0.5 * (start + end) / n - 1.0
        compliance[i] = 0.5 * (end - start) * sheathed * length_per_angle(at, rig)
    compliance[0] += compliance_at_drive(rig)
    compliance[n] += compliance_at_load(rig)
    return compliance
