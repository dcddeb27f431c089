"""The slip chain before its first sample: the laws of a rig, and its nodes at rest."""

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.mesh import PITCH, segment_compliances
from tsas_cli.physics.rig import Rig
from tsas_cli.physics.slip.state import COMPLIANCE, ROWS, TENSION, TENSION_BEFORE, Floats, SlipLaws


@kernel
def chain_at_rest(rig: Rig, n: int) -> Floats:
    """Return the chain at uniform preload."""
    chain = np.empty(ROWS * PITCH)
    for row in range(ROWS):
        for j in range(n + 2):
            chain[PITCH * row + j] = 0.0
    gives = segment_compliances(rig, n)
    for j in range(n + 2):
        chain[TENSION + j] = chain[TENSION_BEFORE + j] = rig.preload_N
        chain[COMPLIANCE + j] = gives[min(j, n)]
    return chain


@kernel
def slip_laws(rig: Rig, n: int) -> SlipLaws:
    """Return what of the rig a static problem needs."""
    effects = rig.effects
    return SlipLaws(
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
