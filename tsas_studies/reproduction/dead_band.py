"""One dead band of the distributed model: its curve, and what a straight line makes of it."""

import math
from dataclasses import dataclass

import numpy as np

from tsas_cli.physics.closed_form.capstan import dead_band_width
from tsas_cli.physics.ends import DriveInput
from tsas_cli.physics.mesh import compliance_at_drive
from tsas_cli.physics.response import simulate
from tsas_cli.physics.rig import Rig
from tsas_cli.support.arrays import Floats
from tsas_studies.reproduction.rig import wrap_of

POINTS = 2001
SMALLEST_SHARE = 0.02  # of a band that a line is fitted to
FULL_SLIP = 0.5  # of the stroke, from which on the whole tendon slips


@dataclass(frozen=True)
class DeadBand:
    """Displacement since the reversal [mm] and tension at the drive [N], evenly spaced over it."""

    x_mm: Floats
    f_in_N: Floats

    def slope(self, share: float = 1.0) -> float:
        """Return the slope of the least-squares line over the first `share` of the band [N/mm]."""
        kept = np.abs(self.x_mm) <= share * abs(self.x_mm[-1])
        return float(np.polyfit(self.x_mm[kept], self.f_in_N[kept], 1)[0])

    def share_with_slope(self, slope: float) -> float | None:
        """Return the first share of the band whose line has this slope, None where no part has."""
        from scipy.optimize import brentq

        if not self.slope() <= slope <= self.slope(SMALLEST_SHARE):
            return None
        return float(
            brentq(lambda share: self.slope(share) - slope, SMALLEST_SHARE, 1.0, xtol=1e-4)
        )

    @property
    def width_mm(self) -> float:
        """Travel of the drive through the band."""
        return float(abs(self.x_mm[-1]))

    @property
    def secant(self) -> float:
        """Slope between both ends of the band [N/mm]."""
        return float((self.f_in_N[-1] - self.f_in_N[0]) / self.x_mm[-1])

    @property
    def last_tangent(self) -> float:
        """Slope where the slip front arrives, the smallest of the band [N/mm]."""
        return float((self.f_in_N[-1] - self.f_in_N[-2]) / (self.x_mm[-1] - self.x_mm[-2]))


def dead_band(rig: Rig, top_mm: float, *, up: bool) -> DeadBand:
    """Follow the drive from rest to `top_mm`, and on through the dead band that comes next.

    That band is the one on the way down (c-e of Fig. 6); with `up` the drive first goes half of the
    way back, and the band is the one on the way up (f-b).
    """
    turns = [top_mm, FULL_SLIP * top_mm] if up else [top_mm]
    before = simulate(rig, DriveInput(np.array([0.0, *turns])))
    travel_mm = _width(rig, float(before.f_out_N[-1]))
    x = np.linspace(0.0, travel_mm if up else -travel_mm, POINTS)
    run = simulate(rig, DriveInput(np.concatenate(([0.0, *turns[:-1]], turns[-1] + x))))
    return DeadBand(x, run.f_in_N[-POINTS:])


def _width(rig: Rig, f_out_N: float) -> float:
    """Return the drive's travel in a whole dead band, free tendon included [mm]."""
    wrap = wrap_of(rig)
    inside = dead_band_width(f_out_N, wrap, rig.sheath_length_mm, rig.tendon_stiffness_N)
    return inside + 2.0 * math.sinh(wrap) * f_out_N * compliance_at_drive(rig)
