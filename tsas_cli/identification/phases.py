"""Cut a run into its phases: contraction, loosening and the two dead bands.

Between two reversals the drive moves in one direction: first through a dead band, where the slip
front runs along the sheath and the load rests, then with the whole tendon slipping. The transition
minimises the squares of two laws fitted before and after it, over all channels:

- in the dead band f_in = p0 + p1 √D + p2 D with D the travel since the reversal (the exact form
  of the distributed model), and f_out and x_out are constant;
- in slip every channel is a straight line over D.

A stroke has at most one transition, so that noise cannot make it chatter. A stroke that one of the
laws suffices for belongs to a phase as a whole, determined by its slope.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt

from tsas_cli.identification.prepared import Prepared
from tsas_cli.numerics.turning_points import last_beyond
from tsas_cli.records import base as records
from tsas_cli.support.arrays import Floats

Phase = Literal["contraction", "loosening", "dead_band_up", "dead_band_down", "unknown"]

POINTS = 400  # of the search for a transition in a stroke
STILL = 4.0  # standard deviations within which a drive is at rest
UNLOADS = 5.0  # standard deviations of its means by which f_in reverses at rest
FEWEST = 8  # samples for the fit of a law
CLEAR = 30.0  # reduction of the squares by a second law, in mean squares of the residual
GENTLE = 1.0 / 3.0  # the slip's slope over the dead band's, at most


@dataclass(frozen=True)
class Segment:
    """Samples first … end−1 of a run that belong to one phase."""

    first: int
    end: int
    phase: Phase

    @property
    def rows(self) -> slice:
        """The samples."""
        return slice(self.first, self.end)


@dataclass(frozen=True)
class _Stroke:
    """Samples between two reversals, thinned: travel since the first one, channels over noise."""

    first: int
    end: int
    up: bool
    at: npt.NDArray[np.int64]
    travel: Floats
    channels: Mapping[str, Floats]


def segment(run: Prepared) -> list[Segment]:
    """Return the phases of a run in order; together they cover all samples.

    The drive must be a displacement; a run driven by force is one unknown segment.
    """
    n = run.time_s.size
    if run.drive_column != "x_in_mm":
        return [Segment(0, n, "unknown")]
    strokes = _strokes(run)
    cuts = [_transition(stroke) for stroke in strokes]
    slopes = [_slopes(stroke, cut) for stroke, cut in zip(strokes, cuts, strict=True)]
    border = _border(slopes)
    out: list[Segment] = []
    for stroke, cut, slope in zip(strokes, cuts, slopes, strict=True):
        dead: Phase = "dead_band_up" if stroke.up else "dead_band_down"
        slip: Phase = "contraction" if stroke.up else "loosening"
        if cut is not None:
            middle = int(stroke.at[cut])
            out += [Segment(stroke.first, middle, dead), Segment(middle, stroke.end, slip)]
        elif border is None or not np.isfinite(slope[0]):
            out.append(Segment(stroke.first, stroke.end, "unknown"))
        else:
            out.append(Segment(stroke.first, stroke.end, dead if slope[0] > border else slip))
    return out


def segment_records(run: Prepared, segments: Sequence[Segment]) -> tuple[records.PhaseSegment, ...]:
    """Return the records of a run's phases in the stages' files."""
    last = run.time_s.size - 1
    return tuple(
        records.PhaseSegment(
            start_s=float(run.time_s[s.first]),
            end_s=float(run.time_s[min(s.end, last)]),
            phase=s.phase,
        )
        for s in segments
    )


def _strokes(run: Prepared) -> list[_Stroke]:
    conditioned = run.conditioned["x_in_mm"]
    x = conditioned.values
    reversals = [_start_of_unloading(run, int(reversal)) for reversal in conditioned.reversals]
    channels = {
        name: np.interp(run.time_s, run.time_s[ok], values[ok]) / max(run.noise[name], 1e-12)
        for name, values in run.measured.items()
        if (ok := np.isfinite(values)).sum() > 1
    }
    out = []
    for first, end in zip(reversals[:-1], [*reversals[1:-1], reversals[-1] + 1], strict=True):
        step = max(1, (end - first) // POINTS)
        at = np.arange(first, end, step)
        out.append(
            _Stroke(
                int(first),
                int(end),
                bool(x[min(end, x.size - 1)] >= x[first]),
                at,
                np.abs(x[at] - x[first]),
                {name: _block_means(values[first:end], step) for name, values in channels.items()},
            )
        )
    return out


def _start_of_unloading(run: Prepared, reversal: int) -> int:
    """Return the sample at which the tension reverses, if the drive rests before its reversal.

    A drive at rest starts to unload before its encoder shows it.
    """
    conditioned, f_in = run.conditioned["x_in_mm"], run.measured.get("f_in_N")
    x = conditioned.values
    rest = last_beyond(x, reversal, STILL * conditioned.sd[reversal]) + 1
    if f_in is None or rest == 0 or reversal == x.size - 1:
        return reversal
    around = f_in[rest : reversal + FEWEST]
    if around.size < FEWEST:  # the run ends here
        return reversal
    means = np.convolve(around, np.full(FEWEST, 1.0 / FEWEST), mode="valid")
    pulled = means if x[reversal] > x[rest - 1] else -means
    margin = UNLOADS * run.noise["f_in_N"] / math.sqrt(FEWEST)
    near_peak = np.flatnonzero(pulled >= pulled.max() - margin)
    return rest + int(near_peak[-1]) if near_peak.size else reversal


def _block_means(values: Floats, step: int) -> Floats:
    """Return means over blocks of `step` samples; the last one may be shorter."""
    edges = np.arange(0, values.size, step)
    sums = np.add.reduceat(values, edges)
    return sums / np.diff(edges, append=values.size)


def _transition(stroke: _Stroke) -> int | None:
    """Return the index of the first slipping one of a stroke's thinned samples, or None."""
    n = stroke.travel.size
    if n <= 2 * FEWEST or not stroke.channels:
        return None
    total = np.zeros(n + 1)
    alone = np.zeros(2)
    for name, values in stroke.channels.items():
        one = np.ones_like(stroke.travel)
        slip, dead = np.column_stack((one, stroke.travel)), one[:, None]
        if name == "f_in_N":
            dead = np.column_stack((one, np.sqrt(stroke.travel), stroke.travel))
        left = _residual_squares(dead, values)
        right = _residual_squares(slip[::-1], values[::-1])[::-1]
        total += left + right
        alone += left[-1], right[0]
    inner = total[FEWEST : n - FEWEST]
    best = int(np.argmin(inner)) + FEWEST
    mean_square = max(total[best], 1e-30) / (n * len(stroke.channels))
    if alone.min() - total[best] < CLEAR * mean_square:
        return None
    before, after = _slopes(stroke, best)
    return best if after < GENTLE * before else None


def _residual_squares(basis: Floats, values: Floats) -> Floats:
    """Return the squared residual of a fit to the first k samples, k = 0 … n, shape (n + 1,)."""
    columns = basis.shape[1]
    gram = np.cumsum(basis[:, :, None] * basis[:, None, :], axis=0)
    shifted = values - values[0]
    moment = np.cumsum(basis * shifted[:, None], axis=0)
    ridge = 1e-12 * np.trace(gram, axis1=1, axis2=2)[:, None, None] * np.eye(columns)
    fit = np.linalg.solve(gram + ridge, moment[:, :, None])[:, :, 0]
    residual = np.cumsum(shifted**2) - np.sum(fit * moment, axis=1)
    return np.concatenate(([0.0], np.maximum(residual, 0.0)))


def _slopes(stroke: _Stroke, cut: int | None) -> tuple[float, float]:
    """Return the slope of f_in (or the inverse slope of the load) before and after a cut."""
    name = "f_in_N" if "f_in_N" in stroke.channels else next(iter(stroke.channels), None)
    n = stroke.travel.size
    if name is None or n < FEWEST:
        return np.nan, np.nan
    found = []
    for part in (slice(0, cut), slice(cut or n, n)):
        travel = stroke.travel[part]
        spread = travel - travel.mean() if travel.size else travel
        square = float(np.sum(spread**2))
        along = abs(float(np.sum(spread * stroke.channels[name][part])))
        slope = along / square if square > 0.0 else np.nan
        # The load rests in the dead band: the inverse has the order of f_in.
        found.append(slope if name == "f_in_N" else 1.0 / max(slope, 1e-12))
    return found[0], found[1]


def _border(slopes: Sequence[tuple[float, float]]) -> float | None:
    """Return the slope between dead band and slip, from the strokes with both."""
    both = [(b, a) for b, a in slopes if np.isfinite(b) and np.isfinite(a) and a > 0.0]
    if not both:
        return None
    steep, gentle = np.median(np.array(both), axis=0)
    return float(np.sqrt(steep * gentle))
