"""From which size on an effect would be found, and told from the others: linearly, in advance.

What the free parameters can imitate of a signature is taken out of it. What is left, times the
size, has to pass what a diagnosis asks of a gain (`evidence`): to take away the part TELLING of
the squares, noise among them, and to be SURE over the blocks. With E_b the squares that a
signature of size 1 leaves in block b, which holds n_b residuals of noise, a size s is expected to
gain log(1 + s² E_b / n_b) there, and noise scatters that by 2 s √E_b / (n_b + s² E_b).
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np
import numpy.typing as npt

from tsas_cli.diagnosis.evidence import SURE, TELLING
from tsas_cli.diagnosis.held_out import folds_of
from tsas_cli.effects import Effect, Parameter
from tsas_cli.identification.extension import Bench, Trial
from tsas_cli.identification.fit import jacobian
from tsas_cli.identification.fit_problem import rig_at
from tsas_cli.identification.run_errors import blocks_of
from tsas_cli.identification.screening import projector

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]

RANGE = 100.0  # times a parameter's start: a larger size is not looked for
FEW_SHAPES = 4  # of an effect, that are all looked at; of more, the start alone
NEVER = 10.0  # times the size found, from which on causes should be told apart
SAME = 1e-3  # part of a signature's squares that others must leave of it; kinks leave a little
TINY = 1e-6  # of the start: so small that everything is linear, and hardly a kink in between


@dataclass(frozen=True)
class Cause:
    """One amplitude of an effect, at one of its shapes."""

    effect: Effect
    parameter: Parameter
    shape: dict[str, float]

    @property
    def name(self) -> str:
        """effect.parameter."""
        return f"{self.effect.name}.{self.parameter.name}"

    @property
    def start(self) -> float:
        """The start of a fit, less the neutral value."""
        return self.parameter.start - self.parameter.neutral

    @property
    def one_sided(self) -> bool:
        """Whether the neutral value is a bound."""
        return self.parameter.neutral in (self.parameter.lower, self.parameter.upper)

    @property
    def largest(self) -> float:
        """The largest size that is looked for."""
        ends = (self.parameter.lower, self.parameter.upper)
        bound = max(abs(end - self.parameter.neutral) for end in ends)
        return min(RANGE * abs(self.start), bound)


@dataclass(frozen=True)
class Seen:
    """From which size on a cause is found, infinite where it is not; and told from each effect."""

    cause: Cause
    found: float
    told: dict[str, float]

    @property
    def named(self) -> float:
        """From which size on it is found and told from every other effect."""
        return max([self.found, *self.told.values()])

    @property
    def counted(self) -> float:
        """The size named, infinite where another effect hides it far beyond the size found."""
        return math.inf if self.hidden_in else self.named

    @property
    def hidden_in(self) -> list[str]:
        """The effects that imitate it although it is many times as large as it has to be."""
        return [name for name, size in self.told.items() if size > NEVER * self.found]

    @property
    def nearest(self) -> str | None:
        """The effect that it is hardest to tell from, if any keeps it from being named."""
        worst = max(self.told, key=lambda name: self.told[name], default=None)
        return worst if worst is not None and self.told[worst] > self.found else None


def causes_of(effect: Effect) -> list[Cause]:
    """Return each amplitude of an effect at each of its shapes that are looked at."""
    shapes = [p for p in effect.parameters if p.shape]
    options = [p.starts if 0 < len(p.starts) <= FEW_SHAPES else (p.start,) for p in shapes]
    return [
        Cause(effect, p, {f"{effect.name}.{s.name}": v for s, v in zip(shapes, at, strict=True)})
        for at in product(*options)
        for p in effect.parameters
        if not p.shape
    ]


def amplitudes_of(effect: Effect) -> list[Cause]:
    """Return each amplitude of an effect at the first of its shapes."""
    causes = causes_of(effect)
    return [cause for cause in causes if cause.shape == causes[0].shape]


@dataclass(frozen=True, eq=False)
class Look:
    """The runs of a bench, some of which are planned, and what each effect would do in them.

    Everything is linear at the values of `trial`. `run` and `block` number all residuals, (n,),
    `without` are these with no effect added. `signatures` caches what was looked at.
    """

    bench: Bench
    trial: Trial
    run: Indices
    block: Indices
    without: Floats
    signatures: dict[tuple[str, float, tuple[float, ...]], Floats] = field(default_factory=dict)

    def part(self, runs: Sequence[int]) -> "Part":
        """Return the look at some of the runs alone."""
        rows = np.isin(self.run, runs)
        jacobian = self.trial.solution.jacobian[rows]
        solution = replace(
            self.trial.solution, jacobian=jacobian, residual=self.trial.solution.residual[rows]
        )
        block = np.unique(self.block[rows], return_inverse=True)[1]
        return Part(self, rows, block, projector(replace(self.trial, solution=solution)))

    def signature(self, cause: Cause, size: float) -> Floats:
        """Return what a cause of a size does to all residuals, for each unit of it, shape (n,).

        Nothing, where the model does not get through the runs with it: then it is not found.
        """
        key = (cause.name, size, tuple(cause.shape.values()))
        if key not in self.signatures:
            at = cause.shape | {cause.name: cause.parameter.neutral + size}
            change = (self.bench.errors_at(self.trial, at) - self.without) / size
            gone_through = bool(np.isfinite(change).all())
            self.signatures[key] = change if gone_through else np.zeros_like(change)
        return self.signatures[key]


def look_at(bench: Bench, trial: Trial) -> Look:
    """Return the look at the runs of a bench from a trial on the mesh."""
    slopes = _slopes(bench, trial)
    linear = replace(trial, solution=replace(trial.solution, jacobian=slopes))
    return Look(
        bench,
        linear,
        np.repeat(np.arange(len(trial.sizes)), trial.sizes),
        folds_of(blocks_of(bench.closed, bench.rigs)).block,
        bench.errors_at(linear, {}),
    )


@dataclass(frozen=True)
class Imitation:
    """What some signatures can do together, none of them negative: a basis, and them in it."""

    basis: Floats
    columns: Floats

    def left(self, signature: Floats) -> Floats:
        """Return what of a signature they cannot do."""
        from scipy.optimize import nnls

        sizes = np.linalg.norm(self.columns, axis=0)
        columns = self.columns / np.where(sizes > 0.0, sizes, 1.0)
        amounts, _ = nnls(columns, self.basis.T @ signature)
        return np.asarray(signature - self.basis @ (columns @ amounts))


@dataclass(frozen=True)
class Part:
    """Some runs of a look: their rows, blocks, and what the free parameters can do in them."""

    look: Look
    rows: npt.NDArray[np.bool_]
    block: Indices
    basis: Floats
    sizes: dict[str, float] = field(default_factory=dict)

    @property
    def blocks(self) -> int:
        """The number of blocks."""
        return int(self.block.max()) + 1

    def own(self, cause: Cause) -> Floats:
        """Return a cause's signature for each unit of it, less what free parameters imitate.

        Not every effect is linear: the signature is that of about the size that is found.
        """
        if cause.name not in self.sizes:
            self.sizes[cause.name] = self._settled(cause)
        return self._own(self.look.signature(cause, self.sizes[cause.name]))

    def tiny(self, cause: Cause) -> Floats:
        """Return the same for a size so small that it is linear."""
        return self._own(self.look.signature(cause, TINY * cause.start))

    def shows(self, cause: Cause) -> bool:
        """Say whether the free parameters leave anything of a tiny size of a cause."""
        whole, own = self.look.signature(cause, TINY * cause.start)[self.rows], self.tiny(cause)
        return bool(own @ own > SAME * (whole @ whole))

    def _settled(self, cause: Cause) -> float:
        """Return a size between the one that is found and its half: the start times a power of 2.

        Parts thus share signatures. Where nothing is found it is the last one tried. What is found
        however small it is, as where the model jumps with it, is looked at at about the size TINY.
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
        """Return from which factor on a signature would be found, infinite where it never is."""
        squares = np.bincount(self.block, signature**2)
        counts = np.bincount(self.block).astype(float)
        total = float(squares.sum())
        if total <= 0.0:
            return math.inf
        telling = np.sqrt(TELLING / (1.0 - TELLING) * counts.sum() / total)
        factors = telling * np.geomspace(1.0, 1e3, 301)
        gained = factors[:, None] ** 2 * squares
        expected = np.log1p(gained / counts)
        scatter = 4.0 * gained / (counts + gained) ** 2
        sure = expected.sum(axis=1) / np.sqrt((expected**2 + scatter).sum(axis=1)) > SURE
        return float(factors[np.argmax(sure)]) if sure.any() else math.inf

    def seen(self, effects: Sequence[Effect], rivals: Sequence[Effect]) -> list[Seen]:
        """Return how each amplitude of some effects is seen, and told from the rivals."""
        imitations = {e.name: (_imitations(e, self.own), _imitations(e, self.tiny)) for e in rivals}
        out = []
        for cause in (c for effect in effects for c in amplitudes_of(effect)):
            found = self._limited(cause, self.smallest(self.own(cause)))
            told = {
                name: self._limited(cause, self._told(cause, *of_rival))
                for name, of_rival in imitations.items()
                if name != cause.effect.name
            }
            out.append(Seen(cause, found if self.shows(cause) else math.inf, told))
        return out

    def _told(self, cause: Cause, usual: list[Imitation], tiny: list[Imitation]) -> float:
        """Return from which size on no imitation passes for a cause, in either direction."""
        own, exact = self.own(cause), self.tiny(cause)
        ways = (1.0,) if cause.one_sided else (1.0, -1.0)
        for signature, imitations in ((own, usual), (exact, tiny)):
            for way, imitation in product(ways, imitations):
                left = imitation.left(way * signature)
                if left @ left <= SAME * (signature @ signature):
                    return math.inf
        return max(self.smallest(imitation.left(way * own)) for way in ways for imitation in usual)

    def _own(self, signature: Floats) -> Floats:
        here = signature[self.rows]
        return np.asarray(here - self.basis @ (self.basis.T @ here))

    @staticmethod
    def _limited(cause: Cause, size: float) -> float:
        return size if size <= cause.largest else math.inf


def _slopes(bench: Bench, trial: Trial) -> Floats:
    """Return the Jacobian of a trial on the mesh that signatures are made on."""
    return jacobian(
        trial.unknowns,
        len(bench.rigs),
        trial.solution.values,
        lambda k, v: bench.coarse[k].residuals(rig_at(bench.rigs[k], k, trial.unknowns, v)),
    )


def _imitations(effect: Effect, own: Callable[[Cause], Floats]) -> list[Imitation]:
    """Return what the amplitudes of an effect can do together, for each of its shapes.

    One that can act in both directions has a column for each.
    """
    columns: dict[tuple[float, ...], list[Floats]] = {}
    for cause in causes_of(effect):
        column = own(cause) * np.sign(cause.start)
        ways = [column] if cause.one_sided else [column, -column]
        columns.setdefault(tuple(cause.shape.values()), []).extend(ways)
    return [Imitation(*np.linalg.qr(np.array(each).T)) for each in columns.values()]
