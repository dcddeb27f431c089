"""The paper's static model: four phases, piecewise linear.

Yang 2025, Eqs. (4)-(9) and (26)-(32). The dead band is one straight line with the secant stiffness
(29); the distributed model (`branches`, `slip.chain`) agrees with it at the ends of a whole dead
band only, because a moving slip front makes a curve.
"""

from typing import NamedTuple

import numpy as np

from tsas_cli.numerics.compiled import kernel
from tsas_cli.physics.closed_form.branches import SMALLEST_WRAP, full_slip
from tsas_cli.physics.closed_form.capstan import dead_band_stiffness, tension_ratio
from tsas_cli.physics.course import Tensions
from tsas_cli.physics.mesh import compliance_at_drive, sheath_compliance
from tsas_cli.physics.phases import SLACK
from tsas_cli.physics.rig import Rig
from tsas_cli.support.arrays import Floats


class StaticState(NamedTuple):
    """State of the static model: the drive's position [mm] and both tensions [N]."""

    x_in: float
    f_in: float
    f_out: float


@kernel
def follow_static(x_in: Floats, rig: Rig, state: StaticState) -> tuple[Tensions, StaticState]:
    """Return the tensions for a motion of the drive [mm] from a state, and the final state."""
    wrap = max(rig.friction_coefficient * rig.total_bend_rad, SMALLEST_WRAP)
    free = compliance_at_drive(rig)
    stiffness = dead_band_stiffness(wrap, 1.0, 1.0 / sheath_compliance(rig))
    stiffness = stiffness / (1.0 + stiffness * free)
    pull_slope, slack_x = full_slip(1.0, rig, wrap, free)
    release_slope, slack_x = full_slip(-1.0, rig, wrap, free)
    f_in, f_out = np.empty(x_in.size), np.empty(x_in.size)
    phase = np.zeros(x_in.size, dtype=np.int8)
    x, T, out = state
    for i in range(x_in.size):
        T += stiffness * (x_in[i] - x)
        x = x_in[i]
        upper, lower = max(pull_slope * (x - slack_x), 0.0), max(release_slope * (x - slack_x), 0.0)
        if upper <= T:
            T, out, phase[i] = upper, upper * tension_ratio(wrap, 1.0), 1
        elif lower >= T:
            T, out, phase[i] = lower, lower * tension_ratio(wrap, -1.0), -1
        if T == 0.0:
            phase[i] = SLACK
        f_in[i], f_out[i] = T, out
    return Tensions(f_in, f_out, phase), StaticState(x, T, out)
