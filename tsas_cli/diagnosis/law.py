"""A law of unnamed origin: what describes the residual that no proven cause explains.

The laws (`effects/laws`) act at an end of the tendon, and are fitted together with the nominal
parameters and the proven effects, each channel's residual over its RMS without a law. A law is
taken where it predicts held-out runs: it lowers the squares significantly, by a good part of what
exceeds the noise, and makes no run and no channel worse. Nothing of it is a cause.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from tsas_cli.diagnosis.channel_errors import noise_floor
from tsas_cli.diagnosis.evidence import gain
from tsas_cli.diagnosis.friction_scatter import scatter_is_no_effect
from tsas_cli.diagnosis.held_out import Folds
from tsas_cli.diagnosis.law_bench import (
    CHANGES,
    folds_by_tension,
    in_channel_units,
    priors_of,
    ranges_of,
)
from tsas_cli.diagnosis.refitted import HeldOutFit, refitted
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.extension import Bench
from tsas_cli.identification.fit import with_errors
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.joint_fit import estimates_of
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.numerics.covariance import jackknife
from tsas_cli.support.arrays import Floats
from tsas_cli.support.steps import NO_PROGRESS, Steps

AT_NOISE = 1.1  # of the noise level, below which a channel's RMS needs no further law
AS_WELL = 0.1  # share by which the squares of a set exceed those of the best one at most
SETS: tuple[tuple[str, ...], ...] = (
    ("drive_law",),
    ("load_law",),
    ("tendon_law",),
    ("drive_law", "load_law"),
    ("tendon_law", "load_law"),
    ("drive_law", "tendon_law", "load_law"),
)
LEAST_TAKEN = 1.0 / 3.0  # of what exceeds the noise, by a law: one that takes less describes little
LIGHTER, LOWER = 2, 0.3  # times that a chosen law's cost is lowered; the factor of its root
WORSE = 0.03  # relative rise of the RMS of a held-out run, or of a channel, that refuses a law


@dataclass(frozen=True, eq=False)
class Law:
    """Laws that describe what is left, with the whole model's estimates.

    `rivals` are other sets of as many laws that describe it as well. `before` and `after` are the
    errors on held-out data without the laws and with them, weighted alike; `bench` and `trial` are
    the fit, `covariance` is that of its scaled values, shape (p, p). `beside` are effects that are
    not proven and act too.
    """

    names: tuple[str, ...]
    rivals: tuple[str, ...]
    estimates: tuple[Estimate, ...]
    before: HeldOutFit
    after: HeldOutFit
    bench: Bench
    trial: HypothesisFit
    covariance: Floats
    beside: tuple[str, ...] = ()


class _Predicting(NamedTuple):
    """Laws that predict held-out runs, and the part of the squares that they take."""

    names: tuple[str, ...]
    trial: HypothesisFit
    before: HeldOutFit
    after: HeldOutFit
    part: float


class _Found(NamedTuple):
    """The chosen laws with their bench, other sets that do as well, and sets of fewer laws."""

    bench: Bench
    best: _Predicting
    rivals: tuple[str, ...]
    fewer: tuple[tuple[str, ...], ...]


def describe(
    bench: Bench,
    trial: HypothesisFit,
    folds: Folds,
    step: Steps = NO_PROGRESS,
    unproven: HypothesisFit | None = None,
) -> Law | None:
    """Return the laws that describe the residual of a trial on held-out data, or None.

    `unproven` is the trial with further effects that gain and are not proven: the laws act beside
    these where that predicts better.
    """
    ranges = ranges_of([run.run for run in bench.closed])
    bench = in_channel_units(bench, trial, ranges)
    found = _found(bench, _without_slopes(trial), folds, ranges, step)
    if found is None:
        return None
    if unproven is not None:
        step.doing("fits the laws beside effects that are not proven")
        found = _beside(found, unproven, folds)
    bench, best, rivals, _ = found
    solution = best.trial.solution
    covariance, _ = jackknife(
        solution.jacobian * ~solution.at_bound, solution.residual, folds.block
    )
    return Law(
        best.names,
        rivals,
        tuple(_estimates(bench, best.trial, folds, ranges, best.names)),
        best.before,
        best.after,
        bench,
        best.trial,
        covariance,
        tuple(sorted({*best.trial.effects} - {*trial.effects, *best.names})),
    )


def _found(
    bench: Bench,
    start: HypothesisFit,
    folds: Folds,
    ranges: Mapping[str, Mapping[str, float]],
    step: Steps,
) -> _Found | None:
    """Return the laws that predict beside the effects of a trial, or None.

    Laws are tried alone and together, since the nominal parameters trade with what a missing law
    leaves, until all channels are at the noise level. Of the sets that predict, the one that
    reduces the squares most; one of fewer laws if that does as well.
    """
    possible = {n for n in CHANGES if n in ranges and CHANGES[n] in bench.channels}
    sets = [names for names in SETS if possible.issuperset(names)]
    noise = {name: noise_floor(bench, name, 0.0) for name in bench.channels}
    step.ahead(len(sets))
    scatter = scatter_is_no_effect(start, folds.run)
    held_out: dict[bool, tuple[HypothesisFit, HeldOutFit]] = {}
    found: list[_Predicting] = []
    fits: dict[tuple[str, ...], HypothesisFit] = {}
    for names in sets:
        step.doing(f"fits laws of unnamed origin: {' + '.join(names)}")
        mesh = start.on_mesh or bench.on_mesh(names)
        if mesh not in held_out:
            without = bench.fit(sorted(start.effects), near=start, on_mesh=mesh)
            held_out[mesh] = without, refitted(bench, without, folds, scatter=scatter)
        without, before = held_out[mesh]
        bench = replace(bench, priors=priors_of(bench, without, folds))
        smaller = (f for of, f in fits.items() if f.on_mesh == mesh and {*of} < {*names})
        near = min(smaller, key=lambda f: f.mean_square, default=without)
        fitted = bench.fit([*sorted(start.effects), *names], near=near, on_mesh=mesh)
        fits[names] = fitted
        step()
        fewer = [f.trial.mean_square for f in found if len(f.names) < len(names)]
        enough = LEAST_TAKEN * _excess(noise, before)
        least = [without.mean_square * (1.0 - enough), *((1.0 - AS_WELL) * f for f in fewer)]
        if fitted.mean_square > min(least):  # what fits no better predicts no better
            continue
        after = refitted(bench, fitted, folds, scatter=scatter)
        reduction = gain(before.squares, after.squares)
        some = reduction.convincing and _taken(before, after) > enough
        if some and not _worse(before, after):
            found.append(_Predicting(names, fitted, before, after, reduction.part))
            if all(after.rmse[n] < AT_NOISE * noise[n] for n in after.rmse):
                break
    if not found:
        return None
    most = max(f.part for f in found)
    as_good = [f for f in found if 1.0 - f.part <= (1.0 + AS_WELL) * (1.0 - most)]
    best = min(as_good, key=lambda f: (len(f.names), -f.part))
    rivals = [f for f in as_good if len(f.names) == len(best.names) and f is not best]
    step.doing(f"fits {' + '.join(best.names)} with a lower cost of its parameters")
    bench, best = _at_lower_cost(bench, best, folds, scatter=scatter)
    fewer_laws = tuple(f.names for f in found if len(f.names) < len(best.names))
    return _Found(bench, best, tuple("+".join(f.names) for f in rivals), fewer_laws)


def _beside(found: _Found, unproven: HypothesisFit, folds: Folds) -> _Found:
    """Return the laws beside the effects of a trial too, where that predicts better.

    Where fewer laws fit as well there, it is these: they predict other loads better.
    """
    bench, best = found.bench, found.best

    def fit(names: tuple[str, ...]) -> HypothesisFit:
        together = [*sorted(unproven.effects), *names]
        mesh = best.trial.on_mesh or bench.on_mesh(together)
        initial = unproven.values() | best.trial.values()
        return bench.fit(together, initial, near=best.trial, on_mesh=mesh)

    fits = {names: fit(names) for names in (*found.fewer, best.names)}
    enough = (1.0 + AS_WELL) * fits[best.names].mean_square
    names = next(names for names, fitted in fits.items() if fitted.mean_square <= enough)
    scatter = scatter_is_no_effect(best.trial, folds.run)
    after = refitted(bench, fits[names], folds, scatter=scatter)
    if _worse(best.before, after) or not gain(best.after.squares, after.squares).convincing:
        return found
    rivals = found.rivals if names == best.names else ()
    return found._replace(
        best=best._replace(names=names, trial=fits[names], after=after), rivals=rivals
    )


def _at_lower_cost(
    bench: Bench, best: _Predicting, folds: Folds, *, scatter: bool
) -> tuple[Bench, _Predicting]:
    """Return the laws, and their bench, at the cost of parameters that predicts held-out data best.

    Sets are chosen at a high cost, which keeps the elements of many laws apart, but may hold those
    of the chosen ones back. A lower one has to predict runs of another tension better too: 0.3 of
    it gained on the loads that were learned, and lost 0.5 N of 1.2 N on a new one.
    """
    by_tension = folds_by_tension(bench, folds)

    def squares(of: Bench, trial: HypothesisFit, held_out: Folds) -> float:
        return float(refitted(of, trial, held_out, scatter=scatter).squares.sum())

    for _ in range(LIGHTER):
        priors = {name: prior * LOWER for name, prior in bench.priors.items()}
        lighter, of_trial = replace(bench, priors=priors), best.trial
        fitted = lighter.fit(sorted(of_trial.effects), near=of_trial, on_mesh=of_trial.on_mesh)
        after = refitted(lighter, fitted, folds, scatter=scatter)
        if after.squares.sum() >= best.after.squares.sum() or _worse(best.before, after):
            break
        if by_tension is not None:
            before = squares(bench, of_trial, by_tension)
            if squares(lighter, fitted, by_tension) >= before:
                break
        bench, best = lighter, best._replace(trial=fitted, after=after)
    return bench, best


def _without_slopes(trial: HypothesisFit) -> HypothesisFit:
    """Return a trial as a start for fits with other weights: its values alone."""
    unknown = np.full_like(trial.solution.jacobian, np.nan)
    return replace(trial, solution=replace(trial.solution, jacobian=unknown))


def _excess(noise: Mapping[str, float], before: HeldOutFit) -> float:
    """Return the share of the squares that exceeds the noise, the mean of all channels."""
    shares = [1.0 - (noise[n] / rms) ** 2 for n, rms in before.rmse.items()]
    return max(float(np.mean(shares)), 0.0)


def _taken(before: HeldOutFit, after: HeldOutFit) -> float:
    """Return the share of the squares that a law takes away, the mean of all channels."""
    return float(np.mean([1.0 - (after.rmse[n] / rms) ** 2 for n, rms in before.rmse.items()]))


def _worse(before: HeldOutFit, after: HeldOutFit) -> bool:
    """Return whether a held-out run, or a channel over all of them, is worse by more than a part.

    Of a run all channels count together, each over its RMS: one may lose a little where another
    gains much.
    """

    def of_run(fit: HeldOutFit, k: int) -> float:
        shares = [rms / before.rmse[name] for (run, name), rms in fit.by_run.items() if run == k]
        return float(np.linalg.norm(shares))

    runs = {k for k, _ in before.by_run}
    return any(of_run(after, k) > (1.0 + WORSE) * of_run(before, k) for k in runs) or any(
        after.rmse[n] > (1.0 + WORSE) * rms for n, rms in before.rmse.items()
    )


def _estimates(
    bench: Bench,
    trial: HypothesisFit,
    folds: Folds,
    ranges: Mapping[str, Mapping[str, float]],
    taken: Sequence[str],
) -> list[Estimate]:
    """Return the estimates of all free parameters, and the given ones of the laws."""
    counted = folds.blocks_of_runs(len(bench.rigs))
    fitted = with_errors(trial.unknowns, trial.solution, counted, by_run=True)
    given = [
        Estimate(name, value, QUANTITIES[name].unit, "given")
        for law in taken
        for name, value in ranges[law].items()
    ]
    return [*estimates_of(trial.unknowns, fitted, bench.base.problem.ids), *given]
