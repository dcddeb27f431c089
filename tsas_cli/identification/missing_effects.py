"""Influence of effects that the nominal model lacks on the calibrated values.

Where the nominal model is wrong, the interval of its parameters is that of the nearest nominal
model, and the rig's own value may lie far outside. So the effects of the catalogue that explain
most of the residual are freed, one at a time, and each interval is extended to the parameter's
intervals in those fits. Which of them is the cause, if any, is determined by `diagnose`.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from tsas_cli.effects import EFFECTS
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.extension import Bench, bench_of
from tsas_cli.identification.fit import with_errors
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.joint_fit import FittedModel, estimates_of
from tsas_cli.identification.run_errors import blocks_of
from tsas_cli.identification.screening import projector, screen
from tsas_cli.records.base import TWO_SIDED
from tsas_cli.support.steps import NO_PROGRESS, Steps

LEAST_SHARE = 0.5  # of the best effect's linear reduction, for an effect to be fitted
NEAR = 2.0  # times the best effect's excess over the noise, for an effect to be included
EXPLAINED = 2.0  # mean square of the residuals, beyond which a model is still wrong


@dataclass(frozen=True)
class Widened:
    """Estimates with intervals widened by the influence of some effects, and their names."""

    estimates: tuple[Estimate, ...]
    effects: tuple[str, ...]


def widened(fit: FittedModel, step: Steps = NO_PROGRESS) -> Widened:
    """Return the estimates of a fit, widened by the effects that explain most of its residual.

    `step` counts each effect that is screened, and each that is fitted.
    """
    bench, nominal = bench_of(fit), fit.model.estimates
    trials = _best_trials(bench, step)
    if not trials:
        return Widened(nominal, ())
    least = min(t.mean_square for t in trials)
    near = [t for t in trials if t.mean_square - 1.0 <= NEAR * max(least - 1.0, 0.0)] or [
        min(trials, key=lambda t: t.mean_square)
    ]
    others = [{(e.name, e.run): e for e in _estimates(bench, trial)} for trial in near]
    if least > EXPLAINED:  # none of them explains the residual: include the nominal intervals
        others.append({(e.name, e.run): e for e in nominal})
    return Widened(
        tuple(
            _hull(e, [o[e.name, e.run] for o in others if (e.name, e.run) in o]) for e in nominal
        ),
        tuple(trial.effects[0] for trial in near),
    )


def _best_trials(bench: Bench, step: Steps) -> list[HypothesisFit]:
    """Return the converged fits with one effect each that reduce the residual."""
    screened = []
    bases = {}
    step.ahead(len(EFFECTS))
    for effect in EFFECTS:
        mesh = bench.on_mesh([effect.name])
        if mesh not in bases:
            trial = bench.fit(on_mesh=mesh)
            bases[mesh] = trial, projector(trial)
        screened.append((screen(bench, bases[mesh][0], effect, bases[mesh][1]), bases[mesh][0]))
        step()
    best = max(s.part for s, _ in screened)
    candidates = [(s, base) for s, base in screened if s.part >= LEAST_SHARE * best]
    step.ahead(len(candidates))
    out = []
    for s, base in candidates:
        trial = bench.fit([s.effect.name], s.initial, near=base)
        if trial.solution.converged and trial.mean_square < base.mean_square:
            out.append(trial)
        step()
    return out


def _estimates(bench: Bench, trial: HypothesisFit) -> list[Estimate]:
    rigs = [bench.rig(trial, k) for k in range(len(bench.rigs))]
    fitted = with_errors(trial.unknowns, trial.solution, blocks_of(bench.closed, rigs))
    return estimates_of(trial.unknowns, fitted, bench.base.problem.ids)


def _hull(own: Estimate, others: Sequence[Estimate]) -> Estimate:
    """Return an estimate whose interval spans its value and the intervals of the others."""
    if own.interval_low is None or own.interval_high is None:
        return own
    low = min([own.value, *(o.interval_low for o in others if o.interval_low is not None)])
    high = max([own.value, *(o.interval_high for o in others if o.interval_high is not None)])
    reach = max(high - own.value, own.value - low) / TWO_SIDED
    stderr = None if own.stderr is None else reach
    return replace(own, interval_low=low, interval_high=high, stderr=stderr)
