"""Smallest size at which an effect would be detected and distinguished: linearised, in advance.

The free parameters are projected out of a signature. The remainder, times the size, has to pass the
criteria of a diagnosis (`evidence`): a reduction of the squares, with noise, by the share
LEAST_REDUCTION, and the critical value of the test statistic over the blocks. With E_b the squares
of the signature of size 1 in block b, which has n_b residuals of noise, the expected relative
reduction by a size s is log(1 + s² E_b / n_b) there, with a scatter of 2 s √E_b / (n_b + s² E_b)
by noise.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np
import numpy.typing as npt

from tsas_cli.diagnosis.amplitudes import Amplitude, Visibility, amplitudes_of, causes_of
from tsas_cli.diagnosis.evidence import CRITICAL_VALUE, LEAST_REDUCTION
from tsas_cli.diagnosis.held_out import folds_of
from tsas_cli.effects import Effect
from tsas_cli.identification.extension import Bench
from tsas_cli.identification.fit import jacobian
from tsas_cli.identification.fit_problem import rig_at, unknown_of
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.identification.run_errors import blocks_of
from tsas_cli.identification.screening import projector
from tsas_cli.numerics.least_squares import Solution
from tsas_cli.support.arrays import Floats, Indices

SAME = 1e-3  # share of a signature's squares below which it is imitated; kinks leave a little
FACTORS = np.geomspace(1.0, 1e3, 301)  # of a size, where the least that is detected is looked for
TINY = 1e-6  # of the start, so small that the model is linear, with hardly a kink in between


@dataclass(frozen=True, eq=False)
class LinearisedRuns:
    """The runs of a bench, some of which are planned, and the signatures of effects in them.

    Linearised at the values of `trial`. `run` and `block` are the numbers of each residual's run
    and block, (n,). `signatures` is a cache.
    """

    bench: Bench
    trial: HypothesisFit
    run: Indices
    block: Indices
    signatures: dict[tuple[str, float, tuple[float, ...]], Floats] = field(default_factory=dict)

    def part(self, runs: Sequence[int]) -> "Part":
        """Return some of the runs alone."""
        rows = np.isin(self.run, runs)
        jacobian = self.trial.solution.jacobian[rows]
        solution = replace(
            self.trial.solution, jacobian=jacobian, residual=self.trial.solution.residual[rows]
        )
        block = np.unique(self.block[rows], return_inverse=True)[1]
        return Part(self, rows, block, projector(replace(self.trial, solution=solution)))

    def signature(self, cause: Amplitude, size: float) -> Floats:
        """Return the change of all residuals by a cause, over its size, shape (n,).

        Zero where the model does not converge with it: then it is not detected.
        """
        key = (cause.name, size, tuple(cause.shape.values()))
        if key not in self.signatures:
            at = cause.shape | {cause.name: cause.parameter.neutral + size}
            change = (self.bench.errors_at(self.trial, at) - self.trial.solution.residual) / size
            finite = bool(np.isfinite(change).all())
            self.signatures[key] = change if finite else np.zeros_like(change)
        return self.signatures[key]


def linearised_runs(bench: Bench, effects: Mapping[str, float]) -> LinearisedRuns:
    """Return the runs of a bench linearised at its initial values, on the mesh of the signatures.

    `effects` are the values of effects' parameters that are free too.
    """
    further = [unknown_of(name, QUANTITIES[name].scaled(v)) for name, v in effects.items()]
    unknowns = (*bench.free, *further)
    values = np.array([u.initial for u in unknowns])
    at_bound = np.array([not u.lower < u.initial < u.upper for u in unknowns])

    def residuals(k: int, at: Floats) -> Floats:
        return bench.coarse[k].residuals(rig_at(bench.rigs[k], k, unknowns, at))

    without = [residuals(k, values) for k in range(len(bench.rigs))]
    sizes = tuple(map(len, without))
    residual, slopes = np.concatenate(without), jacobian(unknowns, len(sizes), values, residuals)
    message = "linearised at the initial values"
    solution = Solution(
        values, at_bound, residual, slopes, converged=True, message=message, evaluations=1
    )
    return LinearisedRuns(
        bench,
        HypothesisFit((), unknowns, solution, sizes, on_mesh=True),
        np.repeat(np.arange(len(sizes)), sizes),
        folds_of(blocks_of(bench.closed, bench.rigs)).block,
    )


@dataclass(frozen=True)
class Imitation:
    """Non-negative combinations of signatures: a basis, and the signatures in it."""

    basis: Floats
    columns: Floats

    def left(self, signature: Floats) -> Floats:
        """Return the residual of a signature after its best imitation."""
        from scipy.optimize import nnls

        sizes = np.linalg.norm(self.columns, axis=0)
        columns = self.columns / np.where(sizes > 0.0, sizes, 1.0)
        amounts, _ = nnls(columns, self.basis.T @ signature)
        return np.asarray(signature - self.basis @ (columns @ amounts))


@dataclass(frozen=True)
class Part:
    """Some runs of a look: their rows, blocks, and a basis of the free parameters' Jacobian."""

    look: LinearisedRuns
    rows: npt.NDArray[np.bool_]
    block: Indices
    basis: Floats
    sizes: dict[str, float] = field(default_factory=dict)

    @property
    def blocks(self) -> int:
        """The number of blocks."""
        return int(self.block.max()) + 1

    def own(self, cause: Amplitude) -> Floats:
        """Return a cause's signature per unit, with the free parameters projected out.

        Not every effect is linear: the signature is that of about the detected size.
        """
        if cause.name not in self.sizes:
            self.sizes[cause.name] = self._converged_size(cause)
        return self._own(self.look.signature(cause, self.sizes[cause.name]))

    def tiny(self, cause: Amplitude) -> Floats:
        """Return the same for a size small enough to be linear."""
        return self._own(self.look.signature(cause, TINY * cause.start))

    def shows(self, cause: Amplitude) -> bool:
        """Return whether the free parameters cannot imitate a tiny size of a cause."""
        whole, own = self.look.signature(cause, TINY * cause.start)[self.rows], self.tiny(cause)
        return bool(own @ own > SAME * (whole @ whole))

    def _converged_size(self, cause: Amplitude) -> float:
        """Return a size between the detected one and its half: the start times a power of 2.

        Parts thus share signatures. Where none is detected it is the last one tried. Where any size
        is detected, as where the model is discontinuous in it, it is about the size TINY.
        """
        least = math.floor(math.log2(TINY))
        power, tried = 0, set[int]()
        while power not in tried:
            tried.add(power)
            size = cause.start * 2.0**power
            found = self.smallest(self._own(self.look.signature(cause, size)))
            if found < cause.largest:
                power = max(math.floor(math.log2(found / abs(cause.start))), least)
        return size

    def smallest(self, signature: Floats) -> float:
        """Return the smallest factor at which a signature is detected, infinite where none is."""
        squares = np.bincount(self.block, signature**2)
        counts = np.bincount(self.block).astype(float)
        total = float(squares.sum())
        if total <= 0.0:
            return math.inf
        telling = np.sqrt(LEAST_REDUCTION / (1.0 - LEAST_REDUCTION) * counts.sum() / total)
        factors = telling * FACTORS
        gained = factors[:, None] ** 2 * squares
        expected = np.log1p(gained / counts)
        scatter = 4.0 * gained / (counts + gained) ** 2
        sure = expected.sum(axis=1) / np.sqrt((expected**2 + scatter).sum(axis=1)) > CRITICAL_VALUE
        return float(factors[np.argmax(sure)]) if sure.any() else math.inf

    def seen(self, effects: Sequence[Effect], rivals: Sequence[Effect]) -> list[Visibility]:
        """Return the visibility of each amplitude of some effects, and against the rivals."""
        imitations = {e.name: (_imitations(e, self.own), _imitations(e, self.tiny)) for e in rivals}
        out = []
        for cause in (c for effect in effects for c in amplitudes_of(effect)):
            own, tiny = self.own(cause), self.tiny(cause)
            found = self._limited(cause, self.smallest(own))
            signs = (1.0,) if cause.one_sided else (1.0, -1.0)
            signed = [sign * own for sign in signs], [sign * tiny for sign in signs]
            distinct = {
                name: self._limited(cause, self._distinct_from(signed, of_rival))
                for name, of_rival in imitations.items()
                if name != cause.effect.name
            }
            out.append(Visibility(cause, found if self.shows(cause) else math.inf, distinct))
        return out

    def _distinct_from(
        self, signed: tuple[list[Floats], ...], imitations: tuple[list[Imitation], ...]
    ) -> float:
        """Return the smallest size at which no imitation equals a cause, in either direction.

        Its signatures and the imitations are those of about the detected size, and of a tiny one.
        """
        left = _left(signed[0], imitations[0])
        same = not left or not _left(signed[1], imitations[1])
        return math.inf if same else max(map(self.smallest, left))

    def _own(self, signature: Floats) -> Floats:
        here = signature[self.rows]
        return np.asarray(here - self.basis @ (self.basis.T @ here))

    @staticmethod
    def _limited(cause: Amplitude, size: float) -> float:
        return size if size <= cause.largest else math.inf


def _left(signatures: list[Floats], imitations: list[Imitation]) -> list[Floats]:
    """Return the residual of each signature after each imitation, none where one is the same."""
    out = []
    for signature, imitation in product(signatures, imitations):
        left = imitation.left(signature)
        if left @ left <= SAME * (signature @ signature):
            return []
        out.append(left)
    return out


def _imitations(effect: Effect, own: Callable[[Amplitude], Floats]) -> list[Imitation]:
    """Return the imitations by the amplitudes of an effect, for each of its shapes.

    An amplitude of either sign has a column for each.
    """
    columns: dict[tuple[float, ...], list[Floats]] = {}
    for cause in causes_of(effect):
        column = own(cause) * np.sign(cause.start)
        signs = [column] if cause.one_sided else [column, -column]
        columns.setdefault(tuple(cause.shape.values()), []).extend(signs)
    return [Imitation(*np.linalg.qr(np.array(each).T)) for each in columns.values()]
