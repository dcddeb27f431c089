"""Each effect's signature on the recorded inputs, with everything that is already free taken out.

A signature is what the effect at a plausible size does to the residual. What of it the free
parameters cannot imitate says how visible the effect is; how well the residual is made of it says
what it could explain. Linear, so that large effects show only in the full fit that follows.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np
import numpy.typing as npt

from tsas_cli.effects import Effect, Parameter
from tsas_cli.identification.extension import Bench, Trial

Floats = npt.NDArray[np.float64]

MOST_SIZES = 10.0  # of the plausible ones, for the initial values of a fit
HIDDEN = 1e-6  # part of a signature that has to be its own


@dataclass(frozen=True)
class Screened:
    """One effect seen linearly: the part of the squares it could explain, and its initial values.

    `signatures` are its own, one column for each amplitude, shape (n, p), in units of noise.
    """

    effect: Effect
    part: float
    initial: dict[str, float]
    signatures: Floats


def projector(trial: Trial) -> Floats:
    """Return an orthonormal basis of what the free parameters of a trial can do."""
    free = trial.solution.jacobian[:, ~trial.solution.at_bound]
    basis, r = np.linalg.qr(
        free * np.array([u.scale for u in trial.unknowns])[~trial.solution.at_bound]
    )
    own = np.abs(np.diag(r)) > HIDDEN * np.abs(np.diag(r)).max()
    return np.asarray(basis[:, own])


def screen(bench: Bench, trial: Trial, effect: Effect, basis: Floats) -> Screened:
    """Look at an effect from a fitted trial, at the best of its shapes."""
    residual = trial.solution.residual
    without = bench.errors_at(trial, {})
    amplitudes = [p for p in effect.parameters if not p.shape]
    shapes = [p for p in effect.parameters if p.shape]
    best = Screened(effect, -1.0, {}, np.zeros((residual.size, 0)))
    for values in product(*(p.starts or (p.start,) for p in (*shapes, *amplitudes))):
        at = {_name(effect, p): v for p, v in zip((*shapes, *amplitudes), values, strict=True)}
        shape = {_name(effect, p): at[_name(effect, p)] for p in shapes}
        columns, sizes = [], []
        for p in amplitudes:
            name = _name(effect, p)
            columns.append(bench.errors_at(trial, shape | {name: at[name]}) - without)
            sizes.append(at[name] - p.neutral)
        signatures = np.array(columns).T
        own = signatures - basis @ (basis.T @ signatures)
        amounts = _amounts(own, residual, amplitudes, sizes)
        left = residual + own @ amounts
        part = 1.0 - float(left @ left) / float(residual @ residual)
        if part > best.part:
            initial = shape | {
                _name(effect, p): p.neutral + a * size
                for p, a, size in zip(amplitudes, amounts, sizes, strict=True)
            }
            best = Screened(effect, part, initial, own)
    return best


def _amounts(
    own: Floats, residual: Floats, amplitudes: list[Parameter], sizes: list[float]
) -> Floats:
    """Return how much of each signature the residual asks for, within the parameters' bounds."""
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
    wanted = np.linalg.solve(root.T, -(own.T @ residual) / scale)
    found = lsq_linear(root, wanted, (lower * scale, upper * scale))
    return np.asarray(found.x / scale)


def _name(effect: Effect, parameter: Parameter) -> str:
    return f"{effect.name}.{parameter.name}"
