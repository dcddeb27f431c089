"""Held-out errors by a new fit without each fold, simulated: what a diagnosis reports.

The search holds out by one Gauss-Newton step, which fails where a model is far from the data. Here
each fold is left out of a fit from that step on, and simulated with its values. A held-out run has
a plausible friction of its own where that is mere scatter, as its own preload and zeros.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tsas_cli.diagnosis.evidence import Reduction, gain
from tsas_cli.diagnosis.friction_scatter import FRICTION, PLAUSIBLE, SCATTER
from tsas_cli.diagnosis.held_out import Folds, held_out_values, own_of_fold
from tsas_cli.identification.extension import Bench
from tsas_cli.identification.fit import solve
from tsas_cli.identification.fit_problem import rig_at
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.run_simulation import mean_edges
from tsas_cli.support.arrays import Floats, Mask


@dataclass(frozen=True)
class HeldOutFit:
    """Errors of one hypothesis on held-out data.

    `rmse` is the RMS of each channel, in its unit, `normalised` that over its noise where the noise
    rules, not a steep reversal, `by_run` the RMS of each run's number and channel; `squares` the
    sum of squares of the weighted residuals in each block, shape (blocks,), and `raw_squares` that
    of each channel's errors in its unit.
    """

    rmse: dict[str, float]
    normalised: dict[str, float]
    squares: Floats
    by_run: dict[tuple[int, str], float]
    raw_squares: dict[str, Floats]


def gain_anywhere(without: HeldOutFit, with_it: HeldOutFit) -> Reduction:
    """Return the reduction of the weighted squares, or if only that is convincing, of the raw ones.

    What has the shape of a misplaced reversal has next to no weight, however large it is and
    however often it comes; each channel then counts by what it has without the effect.
    """
    weighted = gain(without.squares, with_it.squares)
    if weighted.convincing:
        return weighted
    raw = raw_gain(without.raw_squares, with_it.raw_squares)
    return raw if raw.convincing else weighted


def raw_gain(without: dict[str, Floats], with_it: dict[str, Floats]) -> Reduction:
    """Return the reduction of the squares of each block, each channel's over all that it has."""
    sums = {name: float(of.sum()) for name, of in without.items()}
    before, after = (
        np.sum([squares[name] / total for name, total in sums.items()], axis=0)
        for squares in (without, with_it)
    )
    return gain(before, after)


def raw_squares(bench: Bench, trial: HypothesisFit, folds: Folds) -> dict[str, Floats]:
    """Return the squares of each channel's errors of a fit in each block, in its unit."""
    out = {name: np.zeros(folds.blocks) for name in bench.channels}
    first = 0
    for k, run in enumerate(bench.errors_for(trial)):
        for name, squares, here in _behind_residuals(run.raw(bench.rig(trial, k)), first):
            out[name] += np.bincount(folds.block[here], squares, folds.blocks)
            first = here.stop
    return out


def _behind_residuals(raw: Mapping[str, Floats], first: int) -> Iterator[tuple[str, Floats, slice]]:
    """Yield each channel of a run, its squares behind each residual, and where these are.

    `first` is the number of the run's first residual.
    """
    for name, errors in raw.items():
        squares = np.add.reduceat(errors**2, mean_edges(errors.size))
        yield name, squares, slice(first, first := first + squares.size)


def refitted(
    bench: Bench, trial: HypothesisFit, folds: Folds, *, scatter: bool = False
) -> HeldOutFit:
    """Return the errors of a hypothesis on each fold, simulated with a fit to the others.

    With `scatter` each run has a plausible friction of its own.
    """
    runs = bench.errors_for(trial)
    raw: dict[tuple[int, str], list[Floats]] = {}
    over_noise: dict[str, list[Floats]] = {}
    weighted = np.empty(folds.fold.size)
    in_blocks = {name: np.zeros(folds.blocks) for name in bench.channels}
    starts = np.concatenate(([0], np.cumsum(trial.sizes)))
    for fold in range(int(folds.fold.max()) + 1):
        held_out = np.split(folds.fold == fold, starts[1:-1])
        values = refitted_values(bench, trial, folds, fold)
        for k, run in enumerate(runs):
            if not held_out[k].any():
                continue
            own = values
            if scatter:
                known = held_out[k] if folds.by_run else ~held_out[k]
                own = _with_own_friction(bench, trial, values, k, known)
            rig = rig_at(bench.rigs[k], k, trial.unknowns, own)
            of_run = weighted[starts[k] : starts[k + 1]]
            of_run[held_out[k]] = run.residuals(rig)[held_out[k]]
            errors_of = run.raw(rig)
            for name, of_means, here in _behind_residuals(errors_of, int(starts[k])):
                errors, chosen = errors_of[name], of_means * (folds.fold[here] == fold)
                in_blocks[name] += np.bincount(folds.block[here], chosen, folds.blocks)
                there = run.spread(name, held_out[k])
                raw.setdefault((k, name), []).append(errors[there])
                over_noise.setdefault(name, []).append(run.over_noise(name, errors, there))
    by_run = {key: rms_of(parts) for key, parts in raw.items()}
    rmse = {
        name: rms_of([part for (_, n), parts in raw.items() if n == name for part in parts])
        for name in sorted({name for _, name in raw})
    }
    normalised = {name: rms_of(parts) for name, parts in over_noise.items()}
    squares = np.bincount(folds.block, weighted**2, minlength=folds.blocks)
    return HeldOutFit(rmse, normalised, squares.astype(np.float64), by_run, in_blocks)


def _with_own_friction(
    bench: Bench, trial: HypothesisFit, values: Floats, k: int, known: Mask
) -> Floats:
    """Return the values with the plausible friction that fits known residuals of a run (linear)."""
    step = SCATTER * np.array([u.name == FRICTION for u in trial.unknowns])

    def residuals(at: Floats) -> Floats:
        return run.residuals(rig_at(bench.rigs[k], k, trial.unknowns, at))[known]

    run = bench.errors_for(trial)[k]
    residual = residuals(values)
    column = residuals(values + step) - residual
    amount = -float(column @ residual) / (1.0 + float(column @ column))
    return np.asarray(values + float(np.clip(amount, -PLAUSIBLE, PLAUSIBLE)) * step)


def rms_of(parts: Sequence[Floats]) -> float:
    """Return the RMS of all parts together, zero of nothing."""
    every = np.concatenate(parts)
    return float(np.sqrt(np.mean(every**2))) if every.size else 0.0


def refitted_values(bench: Bench, trial: HypothesisFit, folds: Folds, fold: int) -> Floats:
    """Return the scaled values of a fit without one fold, its run's own ones fitted to it."""
    held_out = np.split(folds.fold == fold, np.cumsum(trial.sizes)[:-1])
    own = own_of_fold(trial, folds, fold)
    values = held_out_values(trial, folds, fold)
    values = _solved(bench, trial, values, ~own, [~part for part in held_out])
    return _solved(bench, trial, values, own, held_out) if own.any() else values


def _solved(
    bench: Bench, trial: HypothesisFit, values: Floats, free: Mask, kept: Sequence[Mask]
) -> Floats:
    """Return the values with the free unknowns fitted to the kept residuals of each run.

    Where those of the fit to all runs leave less, they are the start: a Gauss-Newton step may end
    beside another minimum.
    """
    runs = bench.errors_for(trial)

    def residuals(k: int, some: Floats) -> Floats:
        if not kept[k].any():
            return np.zeros(0)
        at = values.copy()
        at[free] = some
        rig = rig_at(bench.rigs[k], k, trial.unknowns, at)
        return runs[k].residuals(rig)[kept[k]]

    def squares(some: Floats) -> float:
        return sum(float(np.sum(residuals(k, some) ** 2)) for k in range(len(runs)))

    start = min(values[free], trial.solution.values[free], key=squares)
    free_unknowns = [u for u, is_free in zip(trial.unknowns, free, strict=True) if is_free]
    unknowns = [replace(u, initial=float(v)) for u, v in zip(free_unknowns, start, strict=True)]
    known = trial.solution.jacobian[np.concatenate(kept)][:, free]
    fitted = solve(
        unknowns,
        len(runs),
        residuals,
        tolerance=bench.tolerance_at(trial.mean_square),
        known=known,
        values_only=True,
    )
    out = values.copy()
    out[free] = fitted.values
    return out
