"""The proximal stiffness km = dFin/dxin of each phase, by linear fit as in Yang 2025, Fig. 7."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tsas_cli.identification.phases import Phase, Segment
from tsas_cli.numerics.covariance import block_length, block_numbers, jackknife
from tsas_cli.support.arrays import Floats

PHASES: tuple[Phase, ...] = ("contraction", "loosening", "dead_band_up", "dead_band_down")
FEWEST_SAMPLES = 6


@dataclass(frozen=True)
class Slope:
    """One phase's slope in a run [N/mm], with the half-width of its 95 % interval."""

    phase: Phase
    value: float
    stderr: float
    half_width: float
    occurrences: int
    samples: int


def slopes(x_in: Floats, f_in: Floats, segments: Sequence[Segment]) -> list[Slope]:
    """Return the slope of each phase, fitted with an intercept for each occurrence.

    `x_in` and `f_in` are conditioned displacement [mm] and tension [N] at the drive, shape (n,);
    NaN where unknown.
    """
    found = (_slope(phase, x_in, f_in, segments) for phase in PHASES)
    return [slope for slope in found if slope is not None]


def _slope(phase: Phase, x_in: Floats, f_in: Floats, segments: Sequence[Segment]) -> Slope | None:
    xs, fs = [], []
    for s in segments:
        x, f = x_in[s.first : s.end], f_in[s.first : s.end]
        ok = np.isfinite(f) & np.isfinite(x)
        if s.phase == phase and ok.sum() >= FEWEST_SAMPLES:
            xs.append(x[ok] - x[ok].mean())
            fs.append(f[ok] - f[ok].mean())
    square = sum(float(np.sum(x**2)) for x in xs)
    if not xs or square <= 0.0:
        return None
    slope = sum(float(np.sum(x * f)) for x, f in zip(xs, fs, strict=True)) / square
    residuals = [f - slope * x for x, f in zip(xs, fs, strict=True)]
    length = block_length(residuals)
    block = block_numbers([r.size for r in residuals], length)
    covariance, t = jackknife(np.concatenate(xs)[:, None], np.concatenate(residuals), block)
    stderr = float(np.sqrt(covariance[0, 0]))
    samples = sum(x.size for x in xs)
    return Slope(phase, slope, stderr, float(t[0]) * stderr, len(xs), samples)
