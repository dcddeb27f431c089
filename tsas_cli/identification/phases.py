"""Cut a run into its phases: contraction, loosening and the two dead bands.

Between two reversals the drive moves one way: first through a dead band, where the slip front
runs along the sheath and the load stands still, then with the whole tendon slipping. The
transition is where two laws fitted left and right of it fit best together, over all channels:

- in the dead band f_in = p0 + p1 √D + p2 D with D the travel since the reversal (the exact form
  of the distributed model), and f_out and x_out stand still;
- in slip every channel is a straight line over D.

A stroke has at most one transition, so that noise cannot make it chatter. A stroke that only one
of the laws is needed for belongs to a phase as a whole; which one, its slope tells.
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

Floats = npt.NDArray[np.float64]
Phase = Literal["contraction", "loosening", "dead_band_up", "dead_band_down", "unknown"]

POINTS = 400  # at which a transition is looked for in a stroke, before it is refined
STILL = 4.0  # standard deviations by which a drive at rest may seem to move
UNLOADS = 5.0  # standard deviations of its means by which f_in turns back at rest
FEWEST = 8  # samples that a law is fitted to
CLEAR = 30.0  # squares that a second law must save, in mean squares of what is left
GENTLE = 1.0 / 3.0  # the slip's slope over the dead band's, at most


@dataclass(frozen=True)
class Segment:
    """Samples first … end−1 of a run that belong to one phase."""

    first: int
    end: int
    phase: Phase


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

    The drive must be a displacement; a run that a force drives is one unknown segment.
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


def segment_records(run: Prepared, segments: Sequence[Segment]) -> tuple[records.Segment, ...]:
    """Return what the stages' files say of a run's phases."""
    last = run.time_s.size - 1
    return tuple(
        records.Segment(
            start_s=float(run.time_s[s.first]),
            end_s=float(run.time_s[min(s.end, last)]),
            phase=s.phase,
        )
        for s in segments
    )


def _strokes(run: Prepared) -> list[_Stroke]:
    conditioned = run.conditioned["x_in_mm"]
    x = conditioned.values
    turns = [_start_of_unloading(run, int(turn)) for turn in conditioned.reversals]
    channels = {
        name: np.interp(run.time_s, run.time_s[ok], values[ok]) / max(run.noise[name], 1e-12)
        for name, values in run.measured.items()
        if (ok := np.isfinite(values)).sum() > 1
    }
    out = []
    for first, end in zip(turns[:-1], [*turns[1:-1], turns[-1] + 1], strict=True):
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


def _start_of_unloading(run: Prepared, turn: int) -> int:
    """Return where the tension turns back, if that is while the drive rests before its reversal.

    A drive that stands still for a while has begun to unload before its encoder says so.
    """
    conditioned, f_in = run.conditioned["x_in_mm"], run.measured.get("f_in_N")
    x = conditioned.values
    rest = last_beyond(x, turn, STILL * conditioned.sd[turn]) + 1
    if f_in is None or rest == 0 or turn == x.size - 1:
        return turn
    around = f_in[rest : turn + FEWEST]
    if around.size < FEWEST:  # the run ends here
        return turn
    means = np.convolve(around, np.full(FEWEST, 1.0 / FEWEST), mode="valid")
    pulled = means if x[turn] > x[rest - 1] else -means
    margin = UNLOADS * run.noise["f_in_N"] / math.sqrt(FEWEST)
    kept = np.flatnonzero(pulled >= pulled.max() - margin)
    return rest + int(kept[-1]) if kept.size else turn


def _block_means(values: Floats, step: int) -> Floats:
    """Return means over blocks of `step` samples; the last one may be shorter."""
    edges = np.arange(0, values.size, step)
    sums = np.add.reduceat(values, edges)
    means: Floats = sums / np.diff([*edges, values.size])
    return means


def _bases(name: str, travel: Floats) -> tuple[Floats, Floats]:
    """Return the columns of the dead band's law and of the slip's law for one channel."""
    one = np.ones_like(travel)
    line = np.column_stack((one, travel))
    if name == "f_in_N":
        return np.column_stack((one, np.sqrt(travel), travel)), line
    return one[:, None], line


def _transition(stroke: _Stroke) -> int | None:
    """Return where slip begins in a stroke, as an index into its thinned samples, or None."""
    n = stroke.travel.size
    if n <= 2 * FEWEST or not stroke.channels:
        return None
    total = np.zeros(n + 1)
    alone = np.zeros(2)
    for name, values in stroke.channels.items():
        dead, slip = _bases(name, stroke.travel)
        left = _squares_left(dead, values)
        right = _squares_left(slip[::-1], values[::-1])[::-1]
        total += left + right
        alone += left[-1], right[0]
    inner = total[FEWEST : n - FEWEST]
    best = int(np.argmin(inner)) + FEWEST
    mean_square = max(total[best], 1e-30) / (n * len(stroke.channels))
    if alone.min() - total[best] < CLEAR * mean_square:
        return None
    before, after = _slopes(stroke, best)
    return best if after < GENTLE * before else None


def _squares_left(basis: Floats, values: Floats) -> Floats:
    """Return the squares left by a fit to the first k samples, for k = 0 … n, shape (n + 1,)."""
    columns = basis.shape[1]
    gram = np.cumsum(basis[:, :, None] * basis[:, None, :], axis=0)
    shifted = values - values[0]
    moment = np.cumsum(basis * shifted[:, None], axis=0)
    ridge = 1e-12 * np.trace(gram, axis1=1, axis2=2)[:, None, None] * np.eye(columns)
    fit = np.linalg.solve(gram + ridge, moment[:, :, None])[:, :, 0]
    left = np.cumsum(shifted**2) - np.sum(fit * moment, axis=1)
    return np.concatenate(([0.0], np.maximum(left, 0.0)))


def _slopes(stroke: _Stroke, cut: int | None) -> tuple[float, float]:
    """Return how steep f_in (or how lazy the load) is before and after a cut."""
    name = "f_in_N" if "f_in_N" in stroke.channels else next(iter(stroke.channels), None)
    n = stroke.travel.size
    if name is None or n < FEWEST:
        return np.nan, np.nan
    parts = (slice(0, cut), slice(cut or n, n))
    before, after = (_steepness(stroke.travel[p], stroke.channels[name][p]) for p in parts)
    if name != "f_in_N":  # the load stands still in the dead band: turn the order round
        before, after = 1.0 / max(before, 1e-12), 1.0 / max(after, 1e-12)
    return before, after


def _steepness(travel: Floats, values: Floats) -> float:
    spread = travel - travel.mean() if travel.size else travel
    square = float(np.sum(spread**2))
    return abs(float(np.sum(spread * values))) / square if square > 0.0 else np.nan


def _border(slopes: Sequence[tuple[float, float]]) -> float | None:
    """Return the slope between dead band and slip, from the strokes that show both."""
    both = [(b, a) for b, a in slopes if np.isfinite(b) and np.isfinite(a) and a > 0.0]
    if not both:
        return None
    steep, gentle = np.median(np.array(both), axis=0)
    return float(np.sqrt(steep * gentle))
