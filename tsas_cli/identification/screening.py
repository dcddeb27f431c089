"""Each effect's signature on the recorded inputs, with the free parameters projected out.

A signature is the change of the residual by the effect at a plausible size. Its component
orthogonal to the Jacobian of the free parameters measures how visible the effect is; the projection
of the residual on that, how much it could explain. Linear: the full fit that follows covers large
effects.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations, product

import numpy as np

from tsas_cli.effects import Effect, Parameter
from tsas_cli.identification.extension import Bench
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.support.arrays import Floats
from tsas_cli.support.steps import NO_PROGRESS, Steps

MOST_SIZES = 10.0  # plausible sizes, the bound of the initial values of a fit
LEAST_SIGNATURE = 0.0005  # share of the squares that a signature has to explain to be fitted
SHARE_OF_BEST = 0.2  # the same, of the share of the best signature
ROUGH = 0.5  # the same, of a share by a signature of another set of effects
HIDDEN = 1e-6  # relative norm below which a column is linearly dependent
DEPENDENT = HIDDEN**2  # the same, of the squares of columns
TINY = 1e-12  # norm of a signature that is none


@dataclass(frozen=True)
class Screened:
    """One effect screened linearly: the share of the squares it could explain, initial values.

    `signatures` have the free parameters projected out, one column for each amplitude, shape
    (n, p), in units of noise; `change` is that of the residuals at the initial values, the free
    parameters unchanged, shape (n,). `changes` has, for all values that were tried, those of the
    residuals by each amplitude, shape (n, p); the best are at `values`.
    """

    effect: Effect
    part: float
    initial: dict[str, float]
    signatures: Floats
    change: Floats
    values: tuple[float, ...] = ()
    changes: Mapping[tuple[float, ...], Floats] = field(default_factory=dict)


def least_part(screened: Iterable[Screened]) -> float:
    """Return the share of the squares that a signature has to explain for the effect to be fitted.

    Of 1,752 effects whose signature had less than `SHARE_OF_BEST` of the best one's, a fit took
    away as much as half of what the best one did in one: what it explains is found once the best
    one is named.
    """
    return max(LEAST_SIGNATURE, SHARE_OF_BEST * max((s.part for s in screened), default=0.0))


def screen_all(
    bench: Bench,
    trials: Mapping[Effect, HypothesisFit],
    known: Iterable[Screened],
    step: Steps = NO_PROGRESS,
) -> list[Screened]:
    """Return effects screened linearly, each at its trial, the one that explains most first.

    An effect changes the residuals of two sets alike: what explains little with the changes `known`
    from another set is not simulated anew.
    """
    step.ahead(len(trials))
    bases = {id(trial): projector(trial) for trial in trials.values()}
    changes = {s.effect: s for s in known}
    rough, out = [], []
    for effect, trial in trials.items():
        basis = bases[id(trial)]
        if effect in changes:
            rough.append(screen_again(changes[effect], trial, basis))
        else:
            out.append(screen(bench, trial, effect, basis))
        step()
    least = ROUGH * least_part([*rough, *out])
    for s in rough:
        trial = trials[s.effect]
        out.append(s if s.part < least else refined(bench, trial, s, bases[id(trial)]))
    return sorted(out, key=lambda s: -s.part)


def projector(trial: HypothesisFit) -> Floats:
    """Return an orthonormal basis of the Jacobian of a trial's free parameters."""
    free = trial.solution.jacobian[:, ~trial.solution.at_bound]
    basis, r = np.linalg.qr(
        free * np.array([u.scale for u in trial.unknowns])[~trial.solution.at_bound]
    )
    sizes = np.abs(np.diag(r))
    own = sizes > HIDDEN * sizes.max(initial=0.0)
    return np.asarray(basis[:, own])


def orthogonal_to(basis: Floats, columns: Floats) -> Floats:
    """Return columns, shape (n,) or (n, m), without what an orthonormal basis spans."""
    return np.asarray(columns - basis @ (basis.T @ columns))


def screen(bench: Bench, trial: HypothesisFit, effect: Effect, basis: Floats) -> Screened:
    """Return an effect screened at a fitted trial, with the best of its shapes.

    What the model cannot be simulated with explains nothing.
    """
    starts = product(*(p.starts or (p.start,) for p in _shapes_first(effect)))
    without = bench.errors_at(trial, {})
    changes = {values: _changes(bench, trial, effect, values, without) for values in starts}
    unknown = Screened(effect, 0.0, {}, np.zeros(0), np.zeros(0), changes=changes)
    return screen_again(unknown, trial, basis)


def screen_again(known: Screened, trial: HypothesisFit, basis: Floats) -> Screened:
    """Return an effect screened at another trial with the changes that are known."""
    effect, residual = known.effect, trial.solution.residual
    parameters = _shapes_first(effect)
    amplitudes = [p for p in parameters if not p.shape]
    none = np.zeros((residual.size, 0))
    unchanged = np.zeros(residual.size)
    best = replace(known, part=-1.0, initial={}, signatures=none, change=unchanged, values=())
    for values, signatures in known.changes.items():
        if not np.isfinite(signatures).all():
            continue
        sizes = [v - p.neutral for v, p in zip(values, parameters, strict=True) if not p.shape]
        own = orthogonal_to(basis, signatures)
        amounts = _amounts(own, residual, amplitudes, sizes)
        remaining = residual + own @ amounts
        part = 1.0 - float(remaining @ remaining) / float(residual @ residual)
        if part > best.part:
            initial = {_name(effect, p): v for p, v in zip(parameters, values, strict=True)}
            initial |= {
                _name(effect, p): p.neutral + a * size
                for p, a, size in zip(amplitudes, amounts, sizes, strict=True)
            }
            best = replace(
                best,
                part=part,
                initial=initial,
                signatures=own,
                change=signatures @ amounts,
                values=values,
            )
    return best if best.initial else replace(best, part=0.0)


def parts_of_pairs(screened: Sequence[Screened], residual: Floats) -> list[float]:
    """Return the share of the squares that each two effects could explain together.

    They are in the order of `itertools.combinations`.
    """
    together = np.hstack([s.signatures for s in screened])
    together = together / np.maximum(np.linalg.norm(together, axis=0), TINY)
    gram, along = together.T @ together, together.T @ residual
    ends = np.cumsum([s.signatures.shape[1] for s in screened])[:-1]
    parts = []
    for a, b in combinations(np.split(np.arange(along.size), ends), 2):
        both = np.append(a, b)
        inverse = np.linalg.pinv(gram[np.ix_(both, both)], rcond=DEPENDENT, hermitian=True)
        parts.append(float(along[both] @ inverse @ along[both]) / float(residual @ residual))
    return parts


def refined(bench: Bench, trial: HypothesisFit, rough: Screened, basis: Floats) -> Screened:
    """Return an effect with its best shape screened anew at a trial."""
    without = bench.errors_at(trial, {})
    new = {rough.values: _changes(bench, trial, rough.effect, rough.values, without)}
    best = screen_again(replace(rough, changes=new), trial, basis)
    return replace(best, changes={**rough.changes, **new})


def _changes(
    bench: Bench,
    trial: HypothesisFit,
    effect: Effect,
    values: tuple[float, ...],
    without: Floats,
) -> Floats:
    """Return the change of the residuals by each amplitude, the others neutral, shape (n, p).

    `without` are the residuals without the effect.
    """
    at = {_name(effect, p): v for p, v in zip(_shapes_first(effect), values, strict=True)}
    names = [_name(effect, p) for p in effect.parameters if not p.shape]
    shape = {name: value for name, value in at.items() if name not in names}
    columns = [bench.errors_at(trial, shape | {name: at[name]}) - without for name in names]
    return np.array(columns).T


def _shapes_first(effect: Effect) -> list[Parameter]:
    return sorted(effect.parameters, key=lambda p: not p.shape)


def _amounts(
    own: Floats, residual: Floats, amplitudes: list[Parameter], sizes: list[float]
) -> Floats:
    """Return the least-squares amplitude of each signature, within the parameters' bounds."""
    from scipy.optimize import lsq_linear

    ends = np.array(
        [
            sorted(((p.lower - p.neutral) / size, (p.upper - p.neutral) / size))
            for p, size in zip(amplitudes, sizes, strict=True)
        ]
    )
    lower = np.maximum(ends[:, 0], -MOST_SIZES) - 1e-9
    upper = np.minimum(ends[:, 1], MOST_SIZES) + 1e-9
    gram = own.T @ own
    scale = np.sqrt(np.maximum(np.diag(gram), 1e-12))
    regular = gram / np.outer(scale, scale) + 1e-9 * np.eye(scale.size)
    root = np.linalg.cholesky(regular).T
    unbounded = np.linalg.solve(root.T, -(own.T @ residual) / scale)
    found = lsq_linear(root, unbounded, (lower * scale, upper * scale))
    return np.asarray(found.x / scale)


def _name(effect: Effect, parameter: Parameter) -> str:
    return f"{effect.name}.{parameter.name}"
