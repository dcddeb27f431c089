"""The weighted residuals of one run in the joint fit.

Each residual is in units of its standard deviation: the channel's noise, and the propagated noise
of the driven ends (large where the tangent stiffness is large). An error of the position of a
reversal persists over a whole dead band: the component of the residual with its shape is more
uncertain, and is reduced accordingly.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from tsas_cli.identification.end_errors import REVERSAL_SD, advanced, beside, reversed_at_rest
from tsas_cli.identification.prepared import Prepared
from tsas_cli.identification.run_simulation import (
    PER_MEAN,
    Predictions,
    RunSimulation,
    mean_edges,
    points,
    predict_driven,
    predictor,
    run_simulation,
    with_steps_at,
)
from tsas_cli.numerics.covariance import FEWEST_BLOCKS, block_length
from tsas_cli.numerics.noise import Noise
from tsas_cli.numerics.sums import scaled_without_shape, sums_of
from tsas_cli.physics.response import Dynamics
from tsas_cli.physics.rig import Rig
from tsas_cli.support.arrays import Floats, Indices, Mask

LEAST_NOISE = 1e-9  # of a channel, in its unit
STEEP = 2.0  # times a channel's noise: a standard deviation that is that of the driven ends
WINDOWS_PER_BLOCK = 2.0  # of the conditioning: the correlation length of a cleaned drive's error


class ReversalShapes(NamedTuple):
    """Sensitivity of a channel's residuals to the position of each reversal, stroke by stroke."""

    shape: Floats  # (n,), in units of the residuals' standard deviations
    starts: Indices  # of the strokes, (m,)


@dataclass(frozen=True, eq=False)
class RunErrors:
    """The residuals of one run for any rig, with weights computed at one of them.

    Of each channel `samples` are those that enter the fit, `weights` the standard deviation of its
    residual at all samples, shape (n,). `predict` returns the predictions of a rig.
    """

    run: Prepared
    samples: Mapping[str, Indices]
    simulation: RunSimulation
    predict: Callable[[Rig], Predictions]
    weights: Mapping[str, Floats]
    turns: Mapping[str, ReversalShapes]

    @property
    def length(self) -> int:
        """The number of samples of the channel that has most."""
        return max(at.size for at in self.samples.values())

    @property
    def count(self) -> int:
        """The number of residuals of all channels."""
        return sum(mean_edges(at.size).size for at in self.samples.values())

    def raw(self, rig: Rig) -> dict[str, Floats]:
        """Return measured minus simulated of each channel, at the samples that enter the fit."""
        predicted = self.predict(rig)
        return {
            name: self.run.measured[name][at] - predicted[name][at]
            for name, at in self.samples.items()
        }

    def errors(self, rig: Rig) -> dict[str, Floats]:
        """Return the weighted residuals of each channel, at the samples that enter the fit."""
        return self.weighted(self.predict(rig))

    def weighted(self, predicted: Mapping[str, Floats]) -> dict[str, Floats]:
        """Return the weighted residuals of each channel for a prediction at all samples."""
        return {n: self._weighted(n, predicted[n] - self.run.measured[n]) for n in self.samples}

    def _weighted(self, name: str, difference: Floats) -> Floats:
        """Return a channel's weighted residuals, from predicted minus measured at all samples."""
        at, weights = self.samples[name], self.weights[name]
        return scaled_without_shape(difference, weights, at, *self.turns[name])

    def by_driven_ends(self, rig: Rig) -> dict[str, Floats]:
        """Return what noise of the driven ends does to each channel, at the samples of the fit."""
        run, plain = self.run, self.predict(rig)
        squares = {name: np.zeros(at.size) for name, at in self.samples.items()}
        for column, conditioned in run.conditioned.items():
            end = "values" if column == run.drive_column else "load_values"
            draws = conditioned.again(run.time_s, run.every)
            for again in draws:
                moved = predict_driven(self.simulation, rig, **{end: again})
                for name, at in self.samples.items():
                    squares[name] += (moved[name] - plain[name])[at] ** 2 / len(draws)
        return {name: np.sqrt(values) for name, values in squares.items()}

    @property
    def delay_unit(self) -> float:
        """The unit of `delays`: `REVERSAL_SD` standard deviations of the driving end."""
        return REVERSAL_SD * float(np.median(self.run.conditioned[self.run.drive_column].sd))

    def delays(self, rig: Rig) -> dict[str, Floats]:
        """Return by how much each stroke lags behind the model's, in each channel.

        In units of `delay_unit`, shape (strokes,): what the weighted residuals leave out as an
        error of the position of a reversal.
        """
        out = {}
        for name, errors in self.errors(rig).items():
            shape, starts = self.turns[name]
            size = np.sqrt(sums_of(shape**2, starts))
            along = sums_of(shape * errors, starts)
            out[name] = np.divide(along, size, out=np.zeros(size.size), where=size > 0.0)
        return out

    def residuals(self, rig: Rig) -> Floats:
        """Return means of neighbouring residuals, scaled to unit variance, channel by channel."""
        return self._means(self.errors(rig))

    def changed(self, changes: Mapping[str, Floats]) -> Floats:
        """Return the change of the residuals where predicted minus measured changes by so much.

        The changes are those of some channels at all samples, shape (n,) each.
        """
        none = np.zeros(self.run.time_s.size)
        return self._means({n: self._weighted(n, changes.get(n, none)) for n in self.samples})

    def _means(self, errors: Mapping[str, Floats]) -> Floats:
        parts = []
        for name, each in errors.items():
            edges, roots = _edges_and_roots(each.size, self.run.noises[name].correlation)
            parts.append(sums_of(each, edges) / roots)
        return np.concatenate(parts)

    def over_noise(self, name: str, errors: Floats, chosen: Mask) -> Floats:
        """Return the chosen of a channel's errors over its noise, where that rules.

        Where a reversal is steep the noise of the driven ends does.
        """
        noise = max(self.run.noise[name], LEAST_NOISE)
        calm = self.weights[name][self.samples[name]] < STEEP * noise
        return np.asarray(errors[chosen & calm] / noise)

    def spread(self, name: str, chosen: Mask) -> Mask:
        """Return which samples of a channel belong to the chosen residuals of the run."""
        start = 0
        for channel, at in self.samples.items():
            edges = mean_edges(at.size)
            if channel == name:
                counts = np.diff(edges, append=at.size)
                return np.repeat(chosen[start : start + edges.size], counts)
            start += edges.size
        raise KeyError(name)

    def blocks(self, rig: Rig, longest: int) -> Indices:
        """Return the block of each residual: longer than its correlation, at least two a run.

        `longest` limits a block [samples]: that of a wrong model is correlated over the run.
        """
        window = max(c.window_s for c in self.run.conditioned.values())
        step = float(np.median(np.diff(self.run.time_s)))
        memory = block_length(list(self.errors(rig).values()))
        length = max(memory, round(WINDOWS_PER_BLOCK * window / step))
        length = min(length, longest, self.length // 2)
        first = [at[mean_edges(at.size)] for at in self.samples.values()]
        return np.unique(np.concatenate(first) // length, return_inverse=True)[1]


@lru_cache
def _edges_and_roots(size: int, correlation: float) -> tuple[Indices, Floats]:
    """Return the first sample of each mean, and the root of the variance of its sum.

    Of samples of unit variance with that correlation of neighbours.
    """
    edges = mean_edges(size)
    counts = np.diff(edges, append=size)
    return edges, np.sqrt(counts * Noise(1.0, correlation).growth(counts))


def run_errors(
    run: Prepared, samples: Mapping[str, Indices], rig: Rig, dynamics: Dynamics = "slip"
) -> RunErrors:
    """Return the residuals of a run at the samples that enter the fit, weighted at a rig."""
    simulation = run_simulation(run, dynamics)
    return _weighted(run, samples, simulation, predictor(simulation), rig)


def reweighted(errors: RunErrors, rig: Rig) -> RunErrors:
    """Return the residuals of the same run, weighted at another rig."""
    return _weighted(errors.run, errors.samples, errors.simulation, errors.predict, rig)


def meshed(errors: RunErrors, nodes: int, per_mean: float = PER_MEAN) -> RunErrors:
    """Return the residuals of the same run with the same weights, always predicted by a chain.

    It has so many nodes, and simulates so many samples for each mean that enters the fit.
    """
    at = points(errors.run, per_mean)
    simulation = replace(errors.simulation, nodes=nodes, points=at)
    return replace(errors, simulation=simulation, predict=predictor(simulation))


def _weighted(
    run: Prepared,
    samples: Mapping[str, Indices],
    simulation: RunSimulation,
    predict: Callable[[Rig], Predictions],
    rig: Rig,
) -> RunErrors:
    """Return residuals with each channel's standard deviation per sample: its noise and the ends'.

    The error of an end is propagated by a simulation with each of its strokes advanced by one
    standard deviation, so that reversals move too; that of a small reversal removed as noise, by a
    simulation with it. The steps of the dynamic model are chosen at the same rig.
    """
    if simulation.dynamics == "lugre":
        simulation = with_steps_at(simulation, rig)
        predict = predictor(simulation)
    plain = predict(rig)
    square = {
        name: np.full(run.time_s.size, max(noise, LEAST_NOISE) ** 2)
        for name, noise in run.noise.items()
    }
    change: dict[str, Floats] = {}
    drive_last = sorted(run.conditioned, key=lambda c: c == run.drive_column)
    for column in drive_last:
        conditioned = run.conditioned[column]
        end = "values" if column == run.drive_column else "load_values"
        moved = predict_driven(simulation, rig, **{end: advanced(conditioned)})
        with_small_reversals = conditioned.values + conditioned.unseen
        disturbed = predict_driven(simulation, rig, **{end: with_small_reversals})
        with_reversals_at_rest = reversed_at_rest(conditioned, run.time_s)
        hidden = predict_driven(simulation, rig, **{end: with_reversals_at_rest})
        for name, values in square.items():
            change[name] = moved[name] - plain[name]
            values += change[name] ** 2 + (disturbed[name] - plain[name]) ** 2
            values += beside(hidden[name] - plain[name]) ** 2
    weights = {name: np.sqrt(values) for name, values in square.items()}
    reversals = run.conditioned[run.drive_column].reversals
    turns = {
        name: _reversal_shapes(change[name] / weights[name], at, reversals)
        for name, at in samples.items()
    }
    return RunErrors(run, samples, simulation, predict, weights, turns)


def _reversal_shapes(change: Floats, at: Indices, reversals: Indices) -> ReversalShapes:
    """Return the sensitivity of the residuals of each stroke to an error of its start.

    A shape s is scaled so that residuals e − s (s·e) have unit variance where the position of the
    reversal has a standard deviation of R = `REVERSAL_SD`: (I + R² c cᵀ)^(−1/2) = I − s sᵀ.
    """
    starts = np.unique(np.searchsorted(at, reversals[:-1] + 1))
    starts = np.unique([0, *starts[starts < at.size]])
    counts = np.diff(starts, append=at.size)
    shape = change[at]
    size = sums_of(shape**2, starts)
    share = 1.0 - 1.0 / np.sqrt(1.0 + REVERSAL_SD**2 * size)
    scale = np.sqrt(np.divide(share, size, out=np.zeros(size.size), where=size > 0.0))
    return ReversalShapes(shape * np.repeat(scale, counts), starts)


def blocks_of(runs: Sequence[RunErrors], rigs: Sequence[Rig]) -> list[Indices]:
    """Return the blocks of each run's residuals at its rig, enough of them in total."""
    longest = sum(run.length for run in runs) // FEWEST_BLOCKS
    return [run.blocks(rig, longest) for run, rig in zip(runs, rigs, strict=True)]
