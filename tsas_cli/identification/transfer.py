"""Straight lines through the phases of runs: stiffness at the drive, transfer of tension.

The proximal stiffness of a phase is km = dFin/dxin, by linear fit as in Yang 2025, Fig. 7. The
transfer is f_in = r f_out + c while the whole tendon slips: the capstan law has r = e^(±a) and
c = 0 (Eq. 7), so that a = μθ is half the logarithm of the quotient of both ratios. An intercept of
opposite sign in the two directions is friction independent of the tendon's tension; one of the
same sign is an offset.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.phases import Phase, Segment
from tsas_cli.identification.prepared import Prepared
from tsas_cli.numerics.covariance import block_length, block_numbers, jackknife
from tsas_cli.support.arrays import Floats
from tsas_cli.support.wording import listed

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
        x, f = x_in[s.rows], f_in[s.rows]
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


FEWEST_OF_TRANSFER = 50
WIDE = 10.0  # the range of f_out must exceed its noise by this factor


@dataclass(frozen=True)
class _Line:
    """r and c of one direction with their covariance and Student's t."""

    values: Floats
    covariance: Floats
    t: Floats


def tension_transfer(
    runs: Sequence[Prepared], segments: Sequence[Sequence[Segment]]
) -> list[Estimate]:
    """Return the transfer in both directions, over all runs with the same bend together.

    Returns
    -------
    list of Estimate
        For each bend the ratio and intercept of both directions, the wrap angle times friction,
        the friction independent of the load, and the offset; `run` lists the runs. Empty where f_in
        or f_out is not measured in both directions, or f_out hardly changes.
    """
    bends = list(dict.fromkeys(run.run.total_bend_rad for run in runs))
    out = []
    for bend in bends:
        members = [k for k, run in enumerate(runs) if run.run.total_bend_rad == bend]
        out += _of_one_bend([runs[k] for k in members], [segments[k] for k in members])
    return out


def without_transfer(runs: Sequence[Prepared], transfer: Sequence[Estimate]) -> Iterator[str]:
    """Yield a sentence on the runs with both forces that a transfer is not fitted to."""
    fitted = {run for estimate in transfer for run in (estimate.run or "").split(", ")}
    forces = "f_in_N", "f_out_N"
    both = [r.run.id for r in runs if all(r.channel(name) is not None for name in forces)]
    if missing := [run for run in both if run not in fitted]:
        yield (
            f"The tension passed on is not fitted in {listed(missing)}: full slip in both "
            "directions is too short there, or f_out_N hardly changes in it."
        )


def _of_one_bend(runs: Sequence[Prepared], segments: Sequence[Sequence[Segment]]) -> list[Estimate]:
    up = _line(runs, segments, "contraction")
    down = _line(runs, segments, "loosening")
    if up is None or down is None or min(up.values[0], down.values[0]) <= 0.0:
        return []
    (up_ratio, up_N), (down_ratio, down_N) = (line.values.tolist() for line in (up, down))
    (up_sd, up_sd_N), (down_sd, down_sd_N) = (
        np.sqrt(np.diag(line.covariance)).tolist() for line in (up, down)
    )
    wrap = 0.5 * math.log(up_ratio / down_ratio)
    wrap_sd = 0.5 * math.hypot(up_sd / up_ratio, down_sd / down_ratio)
    constant_sd = 0.5 * math.hypot(up_sd_N, down_sd_N)
    found = (
        ("ratio_contraction", up_ratio, up_sd, "1"),
        ("ratio_loosening", down_ratio, down_sd, "1"),
        ("intercept_contraction", up_N, up_sd_N, "N"),
        ("intercept_loosening", down_N, down_sd_N, "N"),
        ("wrap", wrap, wrap_sd, "1"),
        ("constant_friction", 0.5 * (up_N - down_N), constant_sd, "N"),
        ("offset", 0.5 * (up_N + down_N), constant_sd, "N"),
    )
    t, ids = float(max(up.t.max(), down.t.max())), ", ".join(run.run.id for run in runs)
    return [
        Estimate(name, value, unit, "fitted", ids, sd, value - t * sd, value + t * sd)
        for name, value, sd, unit in found
    ]


def _line(
    runs: Sequence[Prepared], segments: Sequence[Sequence[Segment]], phase: str
) -> _Line | None:
    at_drive, at_load, block = [], [], []
    count = 0
    noise = 0.0
    for run, parts in zip(runs, segments, strict=True):
        f_in, f_out = run.channel("f_in_N"), run.channel("f_out_N")
        if f_in is None or f_out is None:
            continue
        noise = max(noise, run.noise.get("f_out_N", 0.0))
        for part in parts:
            ok = np.isfinite(f_in[part.rows]) & np.isfinite(f_out[part.rows])
            if part.phase == phase and ok.any():
                at_drive.append(f_in[part.rows][ok])
                at_load.append(f_out[part.rows][ok])
                block.append(np.full(int(ok.sum()), count))
                count += 1
    if count < 2 or sum(b.size for b in block) < FEWEST_OF_TRANSFER:
        return None
    F, G, number = (np.concatenate(parts) for parts in (at_drive, at_load, block))
    if np.ptp(G) < WIDE * noise or np.ptp(G) == 0.0:
        return None
    J = np.column_stack((G, np.ones_like(G)))
    values, *_ = np.linalg.lstsq(J, F, rcond=None)
    residual = F - J @ values
    pieces = np.split(residual, np.flatnonzero(np.diff(number)) + 1)
    blocks = block_numbers([p.size for p in pieces], block_length(pieces))
    covariance, t = jackknife(J, residual, blocks)
    return _Line(values, covariance, t)
