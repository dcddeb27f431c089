"""One run in the joint fit: its model's answers, and its errors in units of what is uncertain.

Each error counts in units of its standard deviation: the channel's noise, and what the remaining
noise of the driven ends does to it (large where the tangent stiffness is large). An error of the
place where the drive turned back lasts for a whole dead band: what has its shape is known to be
uncertain by more, and is taken down accordingly.
"""

from collections.abc import Sequence
from copy import copy
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from tsas_cli.identification.prepared import Prepared
from tsas_cli.identification.samples import mean_edges, points
from tsas_cli.numerics.conditioning import Conditioned
from tsas_cli.numerics.covariance import FEWEST_BLOCKS, block_length
from tsas_cli.numerics.turning_points import last_beyond
from tsas_cli.physics.ends import Drive
from tsas_cli.physics.lugre.chain import OWN_STEPS
from tsas_cli.physics.response import Dynamics, Response, is_closed, simulate
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


class RunErrors:
    """The errors of one run for any rig, with weights that are renewed on demand."""

    def __init__(
        self, run: Prepared, samples: dict[str, Indices], rig: Rig, dynamics: Dynamics = "slip"
    ) -> None:
        """Take the samples of each channel that count, the rig that gives weights, the model."""
        self.run = run
        self.samples = samples
        self.points = points(run)  # that a chain follows
        # The fit leaves out what the start still shows in: it may begin at rest.
        self.drive = replace(run.drive, start_f_in_N=None)
        self.dynamics: Dynamics = dynamics
        self.nodes: int | None = None
        self.step_ends_s = OWN_STEPS
        self._known: tuple[tuple[Rig, dict[str, Floats]], ...] = ()
        self.weights: dict[str, Floats] = {}
        self.turns: dict[str, Turns] = {}
        self.weigh(rig)

    def meshed(self, nodes: int) -> "RunErrors":
        """Return the same run with the same weights, answered by a slip chain always."""
        other = copy(self)
        other.nodes = nodes
        other._known = ()  # noqa: SLF001
        return other

    @property
    def length(self) -> int:
        """The number of samples of the channel that has most; channels run side by side."""
        return max(at.size for at in self.samples.values())

    def weigh(self, rig: Rig) -> None:
        """Renew each channel's standard deviation per sample: its noise, and those of the ends.

        What the error of an end does is found by a simulation with each of its strokes moved on
        by one standard deviation, so that turning points move too; what a reversal does that was
        taken for noise, by one with it left in. The dynamic model's steps are renewed with them,
        and taken at any other rig: with steps of its own each would have its own small errors,
        in which finite differences drown.
        """
        if self.dynamics == "lugre":
            self.step_ends_s = self._response(rig, self.drive, OWN_STEPS).step_ends_s
            self._known = ()
        plain = self._answer(rig)
        square = {
            name: np.full(self.run.time_s.size, max(noise, 1e-9) ** 2)
            for name, noise in self.run.noise.items()
        }
        change: dict[str, Floats] = {}
        drive_last = sorted(self.run.conditioned, key=lambda c: c == self.run.drive_column)
        for column in drive_last:
            conditioned = self.run.conditioned[column]
            answers = self._follow(rig, self._driven_by(column, _moved_on(conditioned)))
            unseen = conditioned.values + conditioned.unseen
            turned = self._follow(rig, self._driven_by(column, unseen))
            for name, values in square.items():
                change[name] = answers[name] - plain[name]
                values += change[name] ** 2 + (turned[name] - plain[name]) ** 2
                _before_turns(values, change[name], conditioned)
        self.weights = {name: np.sqrt(values) for name, values in square.items()}
        self.turns = {
            name: self._turns(change[name] / self.weights[name], at)
            for name, at in self.samples.items()
        }

    def _driven_by(self, column: str, values: Floats) -> Drive:
        """Return the run's drive with the values of one driven end replaced."""
        if column == self.run.drive_column:
            return replace(self.drive, values=values)
        return replace(self.drive, load_values=values)

    def _turns(self, change: Floats, at: Indices) -> Turns:
        """Return the shape that a wrong start of each stroke gives the errors of its samples.

        A shape s is scaled so that errors e − s (s·e) have unit variance where those of the place
        of the reversal are `TURN` standard deviations: (I + TURN² c cᵀ)^(−1/2) = I − s sᵀ.
        """
        reversals = self.run.conditioned[self.run.drive_column].reversals
        starts = np.unique(np.searchsorted(at, reversals[:-1] + 1))
        starts = np.unique([0, *starts[starts < at.size]])
        counts = np.diff([*starts, at.size])
        shape = change[at]
        size = np.add.reduceat(shape**2, starts)
        share = 1.0 - 1.0 / np.sqrt(1.0 + TURN**2 * size)
        scale = np.sqrt(np.divide(share, size, out=np.zeros(size.size), where=size > 0.0))
        return Turns(shape * np.repeat(scale, counts), starts, counts)

    def answers(self, rig: Rig) -> dict[str, Floats]:
        """Return the model's answers at all samples, shape (n,)."""
        return self._answer(rig)

    def raw(self, rig: Rig) -> dict[str, Floats]:
        """Return measured less simulated of each channel, at the samples that count."""
        answer = self._answer(rig)
        return {
            name: self.run.measured[name][at] - answer[name][at]
            for name, at in self.samples.items()
        }

    def errors(self, rig: Rig) -> dict[str, Floats]:
        """Return the weighted errors of each channel, at the samples that count."""
        answer = self._answer(rig)
        out = {}
        for name, at in self.samples.items():
            errors = ((answer[name] - self.run.measured[name]) / self.weights[name])[at]
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

    def _answer(self, rig: Rig) -> dict[str, Floats]:
        """Return the answers to the run's own drive, with the steps of all rigs.

        Those of the last two rigs are kept. (A cached method would hold the run in a cycle, and
        thousands of calibrations in one process would grow by megabytes each.)
        """
        answers = next((known for at, known in self._known if at == rig), None)
        if answers is None:
            answers = self._at_samples(self._response(rig, self.drive, self.step_ends_s))
        others = tuple(pair for pair in self._known if pair[0] != rig)
        self._known = (*others[-1:], (rig, answers))
        return answers

    def _follow(self, rig: Rig, drive: Drive) -> dict[str, Floats]:
        """Return the answers to another drive, with steps of its own."""
        return self._at_samples(self._response(rig, drive, OWN_STEPS))

    def _response(self, rig: Rig, drive: Drive, step_ends_s: Floats) -> Response:
        """Simulate all samples by the closed form, those that are followed by a chain."""
        closed = self.nodes is None and self.dynamics == "slip" and is_closed(rig, drive)
        at = slice(None) if closed else self.points
        load = None if drive.load_values is None else drive.load_values[at]
        time_s = None if drive.time_s is None else drive.time_s[at]
        thinned = replace(drive, values=drive.values[at], load_values=load, time_s=time_s)
        return simulate(
            rig,
            thinned,
            self.dynamics,
            on_mesh=self.nodes is not None,
            nodes=self.nodes,
            tolerance=self.run.step_tolerance,
            step_ends_s=step_ends_s,
        )

    def _at_samples(self, response: Response) -> dict[str, Floats]:
        """Return the answers at all samples, straight between those simulated."""
        there = {
            "f_in_N": response.f_in_N,
            "f_out_N": response.f_out_N,
            "x_out_mm": response.x_out_mm,
        }
        n = self.drive.values.size
        if response.f_in_N.size == n:
            return there
        return {name: np.interp(np.arange(n), self.points, each) for name, each in there.items()}


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
