"""Compliances along the tendon without friction, and the mesh of both chains.

That is n nodes in a row and n + 1 segments, half ones at the ends.
"""

import numpy as np

from tsas_cli.effects.drive_compliance import drive_deflection
from tsas_cli.effects.free_tendon import free_compliance
from tsas_cli.effects.sheath_compression import softened
from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.rig import Rig
from tsas_cli.support.arrays import Floats


@kernel
def sheath_compliance(rig: Rig) -> float:
    """Return L/(EA) of the sheathed tendon, the sheath's compression included [mm/N]."""
    ratio = rig.effects.sheath_compression.compliance_ratio
    return softened(rig.sheath_length_mm / rig.tendon_stiffness_N, ratio)


@kernel
def compliance_at_drive(rig: Rig) -> float:
    """Return the compliance between the drive's sensors and the sheath [mm/N]."""
    free = free_compliance(rig.effects.free_tendon.proximal_length_mm, rig.tendon_stiffness_N)
    return free + drive_deflection(1.0, rig.effects.drive_compliance.compliance_mm_per_N)


@kernel
def compliance_at_load(rig: Rig) -> float:
    """Return the compliance between the sheath and the load [mm/N]."""
    return free_compliance(rig.effects.free_tendon.distal_length_mm, rig.tendon_stiffness_N)


PITCH = 1088  # of a row of a chain's state, a compile-time constant, so that row loops vectorise
MOST_NODES = 1000


@kernel
def segment_compliances(rig: Rig, n: int) -> Floats:
    """Return the compliance of each of the n + 1 segments, shape (n + 1,) [mm/N]."""
    sheathed = sheath_compliance(rig) / n
    compliance = np.empty(n + 1)
    for i in range(n + 1):
        start, end = max(2 * i - 1, 0), min(2 * i + 1, 2 * n)  # in halves of a node's bend
        at = 0.5 * (start + end) / n - 1.0  # from −1 at the drive to 1 at the load
        per_angle = 1.0 + rig.bend_slope * at + rig.bend_bow * (1.5 * at * at - 0.5)
        compliance[i] = 0.5 * (end - start) * sheathed * per_angle
    compliance[0] += compliance_at_drive(rig)
    compliance[n] += compliance_at_load(rig)
    return compliance
