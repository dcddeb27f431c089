"""The mesh of both chains: n nodes in a row, n + 1 segments, half ones at the ends."""

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.compliances import (
    compliance_at_drive,
    compliance_at_load,
    length_per_angle,
    sheath_compliance,
)
from tsas_cli.physics.rig import Rig
from tsas_cli.support.arrays import Floats

PITCH = 1088  # of a row of a chain's state, a compile-time constant, so that row loops vectorise
MOST_NODES = 1000


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
