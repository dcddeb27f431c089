"""The errors of one run in the joint fit, in units of what is uncertain.

Each error counts in units of its standard deviation: the channel's noise, and what the remaining
noise of the driven ends does to it (large where the tangent stiffness is large). An error of the
place where the drive turned back lasts for a whole dead band: what has its shape is known to be
uncertain by more, and is taken down accordingly.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from tsas_cli.identification.prepared import Prepared
from tsas_cli.identification.run_simulation import (
    Predictions,
    RunSimulation,
    predict_driven,
    predictor,
    run_simulation,
    with_steps_at,
)
from tsas_cli.identification.samples import mean_edges
from tsas_cli.numerics.conditioning import Conditioned
from tsas_cli.numerics.covariance import FEWEST_BLOCKS, block_length
from tsas_cli.numerics.turning_points import last_beyond
from tsas_cli.physics.response import Dynamics
from tsas_cli.physics.rig import Rig

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]
Bits = npt.NDArray[np.bool_]

TURN = 3.0  # standard deviations by which the place of a reversal may be wrong
WINDOWS_PER_BLOCK = 2.0  # of the conditioning: the error of a cleaned drive lasts that long


class Turns(NamedTuple):
    """What a wrong place of each reversal would do to a channel's errors, stroke by stroke."""

    shape: Floats  # (n,), in units of the errors' standard deviations
    starts: Indices  # of the strokes, (m,)
    counts: Indices  # of their samples, (m,)


@dataclass(frozen=True, eq=False)
class RunErrors:
    """The errors of one run for any rig, with the weights that hold at one of them.

    Of each channel `samples` are those that count, `weights` the standard deviation of its error at
    all samples, shape (n,). `predict` gives the predictions of the simulation.
    """

    run: Prepared
    samples: Mapping[str, Indices]
    simulation: RunSimulation
    predict: Callable[[Rig], Predictions]
    weights: Mapping[str, Floats]
    turns: Mapping[str, Turns]

    @property
    def length(self) -> int:
        """The number of samples of the channel that has most; channels run side by side."""
        return max(at.size for at in self.samples.values())

    def raw(self, rig: Rig) -> dict[str, Floats]:
        """Return measured less simulated of each channel, at the samples that count."""
        predicted = self.predict(rig)
        return {
            name: self.run.measured[name][at] - predicted[name][at]
            for name, at in self.samples.items()
        }

    def errors(self, rig: Rig) -> dict[str, Floats]:
        """Return the weighted errors of each channel, at the samples that count."""
        predicted = self.predict(rig)
        out = {}
        for name, at in self.samples.items():
            errors = ((predicted[name] - self.run.measured[name]) / self.weights[name])[at]
            turns = self.turns[name]
            alike = np.add.reduceat(turns.shape * errors, turns.starts)
            out[name] = errors - turns.shape * np.repeat(alike, turns.counts)
        return out

    def residuals(self, rig: Rig) -> Floats:
        """Return means of neighbouring errors that keep a variance of one, channel by channel."""
        parts = []
        for errors in self.errors(rig).values():
            edges = mean_edges(errors.size)
            counts = np.diff([*edges, errors.size])
            parts.append(np.add.reduceat(errors, edges) / np.sqrt(counts))
        return np.concatenate(parts)

    def spread(self, name: str, chosen: Bits) -> Bits:
        """Return which samples of a channel belong to the chosen residuals of the run."""
        start = 0
        for channel, at in self.samples.items():
            edges = mean_edges(at.size)
            if channel == name:
                counts = np.diff([*edges, at.size])
                spread: Bits = np.repeat(chosen[start : start + edges.size], counts)
                return spread
            start += edges.size
        raise KeyError(name)

    def blocks(self, rig: Rig, longest: int) -> Indices:
        """Return the block of each residual: longer than its memory, but at least two in the run.

        `longest` limits a block [samples]: the memory of a wrong model is as long as its run.
        """
        window = max(c.window_s for c in self.run.conditioned.values())
        step = float(np.median(np.diff(self.run.time_s)))
        memory = block_length(list(self.errors(rig).values()))
        length = max(memory, round(WINDOWS_PER_BLOCK * window / step))
        length = min(length, longest, self.length // 2)
        first = [at[mean_edges(at.size)] for at in self.samples.values()]
        numbers: Indices = np.unique(np.concatenate(first) // length, return_inverse=True)[1]
        return numbers


def run_errors(
    run: Prepared, samples: Mapping[str, Indices], rig: Rig, dynamics: Dynamics = "slip"
) -> RunErrors:
    """Return the errors of a run at the samples that count, weighed at a rig."""
    simulation = run_simulation(run, dynamics)
    return _weighed(run, samples, simulation, predictor(simulation), rig)


def reweighed(errors: RunErrors, rig: Rig) -> RunErrors:
    """Return the errors of the same run, weighed at another rig."""
    return _weighed(errors.run, errors.samples, errors.simulation, errors.predict, rig)


def meshed(errors: RunErrors, nodes: int) -> RunErrors:
    """Return the errors of the same run with the same weights, predicted by a slip chain always."""
    simulation = replace(errors.simulation, nodes=nodes)
    return replace(errors, simulation=simulation, predict=predictor(simulation))


def _weighed(
    run: Prepared,
    samples: Mapping[str, Indices],
    simulation: RunSimulation,
    predict: Callable[[Rig], Predictions],
    rig: Rig,
) -> RunErrors:
    """Find each channel's standard deviation per sample: its noise, and those of the ends.

    What the error of an end does is found by a simulation with each of its strokes moved on
    by one standard deviation, so that turning points move too; what a reversal does that was
    taken for noise, by one with it left in. The steps of the dynamic model are chosen with them.
    """
    if simulation.dynamics == "lugre":
        simulation = with_steps_at(simulation, rig)
        predict = predictor(simulation)
    plain = predict(rig)
    square = {
        name: np.full(run.time_s.size, max(noise, 1e-9) ** 2) for name, noise in run.noise.items()
    }
    change: dict[str, Floats] = {}
    drive_last = sorted(run.conditioned, key=lambda c: c == run.drive_column)
    for column in drive_last:
        conditioned = run.conditioned[column]
        end = "values" if column == run.drive_column else "load_values"
        moved = predict_driven(simulation, rig, **{end: _moved_on(conditioned)})
        unseen = conditioned.values + conditioned.unseen
        turned = predict_driven(simulation, rig, **{end: unseen})
        for name, values in square.items():
            change[name] = moved[name] - plain[name]
            values += change[name] ** 2 + (turned[name] - plain[name]) ** 2
            _before_turns(values, change[name], conditioned)
    weights = {name: np.sqrt(values) for name, values in square.items()}
    reversals = run.conditioned[run.drive_column].reversals
    turns = {
        name: _turns(change[name] / weights[name], at, reversals) for name, at in samples.items()
    }
    return RunErrors(run, samples, simulation, predict, weights, turns)


def _turns(change: Floats, at: Indices, reversals: Indices) -> Turns:
    """Return the shape that a wrong start of each stroke gives the errors of its samples.

    A shape s is scaled so that errors e − s (s·e) have unit variance where those of the place
    of the reversal are `TURN` standard deviations: (I + TURN² c cᵀ)^(−1/2) = I − s sᵀ.
    """
    starts = np.unique(np.searchsorted(at, reversals[:-1] + 1))
    starts = np.unique([0, *starts[starts < at.size]])
    counts = np.diff([*starts, at.size])
    shape = change[at]
    size = np.add.reduceat(shape**2, starts)
    share = 1.0 - 1.0 / np.sqrt(1.0 + TURN**2 * size)
    scale = np.sqrt(np.divide(share, size, out=np.zeros(size.size), where=size > 0.0))
    return Turns(shape * np.repeat(scale, counts), starts, counts)


def blocks_of(runs: Sequence[RunErrors], rigs: Sequence[Rig]) -> list[Indices]:
    """Return the blocks of each run's residuals at its rig, a fair number of them over all."""
    longest = sum(run.length for run in runs) // FEWEST_BLOCKS
    return [run.blocks(rig, longest) for run, rig in zip(runs, rigs, strict=True)]


def _before_turns(square: Floats, change: Floats, conditioned: Conditioned) -> None:
    """Add the uncertainty behind each reversal to the samples just before it, in place.

    So close to the extremum that its noise hides it, the drive may have turned back already.
    """
    x, sd = conditioned.values, conditioned.sd
    for turn in conditioned.reversals[1:-1]:
        first = last_beyond(x, turn, TURN * sd[turn]) + 1
        behind = change[turn : 2 * turn - first + 2]
        square[first : turn + 1] += np.max(behind**2)


def _moved_on(conditioned: Conditioned) -> Floats:
    """Return the values with each stroke moved on by one standard deviation."""
    moved = conditioned.values.copy()
    for first, end in pairwise(conditioned.reversals):
        up = conditioned.values[end] >= conditioned.values[first]
        part = slice(first + 1 if first else 0, end + 1)  # a reversal belongs to what it ends
        moved[part] = conditioned.values[part] + conditioned.sd[part] * (1.0 if up else -1.0)
    return moved
