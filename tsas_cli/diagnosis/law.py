"""A law of unnamed origin: what describes the residual that no proven cause explains.

The laws (`effects/laws`) act at an end of the tendon, and are fitted together with the nominal
parameters and the proven effects, each channel's residual over its RMS without a law. A law is
taken where it predicts held-out runs: it lowers the squares significantly, and makes no channel of
any run worse. Nothing of it is a cause.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tsas_cli.diagnosis.evidence import gain
from tsas_cli.diagnosis.held_out import Folds
from tsas_cli.diagnosis.refitted import HeldOutFit, refitted
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.extension import Bench, HypothesisFit
from tsas_cli.identification.fit import with_errors
from tsas_cli.identification.joint_fit import estimates_of
from tsas_cli.identification.prepared import Prepared
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.identification.run_errors import ReversalShapes, RunErrors
from tsas_cli.physics.rig import with_values
from tsas_cli.support.steps import NO_PROGRESS, Steps

FOLLOWS = {"drive_law": "x_in_mm", "load_law": "x_out_mm"}  # the displacement of each law
CHANGES = {"drive_law": "f_in_N", "load_law": "x_out_mm"}  # the channel of each law
AS_WELL = 0.02  # least share of the squares that more laws take away than fewer
WORSE = 0.03  # relative rise of a channel's RMS on held-out runs that refuses a law


@dataclass(frozen=True, eq=False)
class Law:
    """Laws that describe what is left, with the whole model's estimates.

    `before` and `after` are the errors on held-out data without the laws and with them, weighted
    alike; `bench` and `trial` are the fit.
    """

    names: tuple[str, ...]
    estimates: tuple[Estimate, ...]
    before: HeldOutFit
    after: HeldOutFit
    bench: Bench
    trial: HypothesisFit


def describe(
    bench: Bench, trial: HypothesisFit, folds: Folds, step: Steps = NO_PROGRESS
) -> Law | None:
    """Return the laws that describe the residual of a trial on held-out data, or None.

    All laws together, and each alone: the nominal parameters trade with what a missing law leaves.
    Of those that predict, the set that reduces the squares most; a single one if that does as well.
    """
    ranges = ranges_of([run.run for run in bench.closed])
    bench = in_channel_units(bench, trial, ranges)
    effects, mesh = sorted(trial.effects), trial.on_mesh
    possible = tuple(n for n in CHANGES if n in ranges and CHANGES[n] in bench.channels)
    sets = dict.fromkeys((possible, *((name,) for name in possible)))
    step.ahead(1 + len(sets))
    without = bench.fit(effects, near=trial, on_mesh=mesh)
    before = refitted(bench, without, folds)
    step()
    found = None
    for names in sets:
        with_laws = bench.fit([*effects, *names], near=without, on_mesh=mesh)
        after = refitted(bench, with_laws, folds)
        step()
        if not gain(before.squares, after.squares).convincing or _worse(before, after):
            continue
        if found is None or gain(after.squares, found[2].squares).part < AS_WELL:
            found = names, with_laws, after
    if found is None:
        return None
    names, fitted, after = found
    estimates = tuple(_estimates(bench, fitted, folds, ranges, names))
    return Law(names, estimates, before, after, bench, fitted)


def ranges_of(runs: Sequence[Prepared]) -> dict[str, dict[str, float]]:
    """Return the given parameters of each law whose displacement was recorded, by its name."""
    out = {}
    for law, column in FOLLOWS.items():
        values = [run.channel(column) for run in runs]
        recorded = [v[np.isfinite(v)] for v in values if v is not None]
        if not recorded:
            continue
        whole = np.concatenate(recorded)
        longest = max(float(np.ptp(v)) for v in recorded)
        out[law] = {
            f"{law}.travel_mm": 0.5 * longest,
            f"{law}.low_mm": float(whole.min()),
            f"{law}.high_mm": float(whole.max()),
        }
    return out


def in_channel_units(
    bench: Bench, trial: HypothesisFit, ranges: Mapping[str, Mapping[str, float]]
) -> Bench:
    """Return the bench with each channel's residual over its RMS, and the ranges of the laws."""
    raw: dict[str, list[float]] = {}
    for k, run in enumerate(bench.errors_for(trial)):
        for name, errors in run.raw(bench.rig(trial, k)).items():
            raw.setdefault(name, []).extend(errors)
    rms = {name: float(np.sqrt(np.mean(np.square(errors)))) for name, errors in raw.items()}
    given = {name: value for law in ranges.values() for name, value in law.items()}
    return replace(
        bench,
        rigs=tuple(with_values(rig, given) for rig in bench.rigs),
        closed=tuple(_over_rms(run, rms) for run in bench.closed),
        meshed=tuple(_over_rms(run, rms) for run in bench.meshed),
    )


def _over_rms(run: RunErrors, rms: Mapping[str, float]) -> RunErrors:
    weights = {name: np.full(run.run.time_s.size, rms[name]) for name in run.samples}
    turns = {
        name: ReversalShapes(np.zeros(at.size), np.array([0]), np.array([at.size]))
        for name, at in run.samples.items()
    }
    return replace(run, weights=weights, turns=turns)


def _worse(before: HeldOutFit, after: HeldOutFit) -> bool:
    """Return whether a channel of a held-out run is worse by more than a small part."""
    return any(
        after.by_run[key] > (1.0 + WORSE) * rms
        and after.by_run[key] - rms > WORSE * before.rmse[key[1]]
        for key, rms in before.by_run.items()
    )


def _estimates(
    bench: Bench,
    trial: HypothesisFit,
    folds: Folds,
    ranges: Mapping[str, Mapping[str, float]],
    taken: Sequence[str],
) -> list[Estimate]:
    """Return the estimates of all free parameters, and the given ones of the laws."""
    blocks = [folds.block[folds.run == k] for k in range(len(bench.rigs))]
    counted = [np.unique(block, return_inverse=True)[1] for block in blocks]
    fitted = with_errors(trial.unknowns, trial.solution, counted, by_run=True)
    given = [
        Estimate(name, value, QUANTITIES[name].unit, "given")
        for law in taken
        for name, value in ranges[law].items()
    ]
    return [*estimates_of(trial.unknowns, fitted, bench.base.problem.ids), *given]
