"""What an effect that the nominal model lacks would do to the calibrated values.

Where the nominal model is proven wrong, the interval of its parameters is that of the nearest
nominal model, and the rig's own value may lie far outside. So the effects of the catalogue that
explain most of what is wrong are freed, one at a time, and each interval reaches from the nominal
value over what the parameter would then be. Which of them it is, and whether it is one of them,
is for `diagnose` to say.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from tsas_cli.effects import EFFECTS
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.extension import Bench, Trial, bench_of
from tsas_cli.identification.fit import with_errors
from tsas_cli.identification.joint_fit import FittedModel, estimates_of
from tsas_cli.identification.run_errors import blocks_of
from tsas_cli.identification.screening import projector, screen
from tsas_cli.support.steps import SILENT, Steps

WORTH = 0.5  # of what the best effect explains linearly, for an effect to be fitted
NEAR = 2.0  # times the best effect's excess over the noise, for an effect to count
EXPLAINED = 2.0  # mean square of the residuals, beyond which a model is still wrong
NORMAL = 1.96


@dataclass(frozen=True)
class Widened:
    """Estimates whose intervals hold what some effects would do, and the names of these."""

    estimates: tuple[Estimate, ...]
    effects: tuple[str, ...]


def widened(fit: FittedModel, step: Steps = SILENT) -> Widened:
    """Widen the intervals of a solved fit by the effects that explain most of what it misses.

    `step` counts each effect that is looked at, and of each that is fitted.
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
    if least > EXPLAINED:  # none of them is the rig either: what the nominal model says counts too
        others.append({(e.name, e.run): e for e in nominal})
    return Widened(
        tuple(
            _hull(e, [o[e.name, e.run] for o in others if (e.name, e.run) in o]) for e in nominal
        ),
        tuple(trial.effects[0] for trial in near),
    )


def _best_trials(bench: Bench, step: Steps) -> list[Trial]:
    """Return the converged fits with one effect each that are better than without."""
    seen = []
    bases = {}
    step.ahead(len(EFFECTS))
    for effect in EFFECTS:
        mesh = bench.on_mesh([effect.name])
        if mesh not in bases:
            trial = bench.fit(on_mesh=mesh)
            bases[mesh] = trial, projector(trial)
        seen.append((screen(bench, bases[mesh][0], effect, bases[mesh][1]), bases[mesh][0]))
        step()
    best = max(s.part for s, _ in seen)
    worth = [(s, base) for s, base in seen if s.part >= WORTH * best]
    step.ahead(len(worth))
    out = []
    for s, base in worth:
        trial = bench.fit([s.effect.name], s.initial, near=base)
        if trial.solution.converged and trial.mean_square < base.mean_square:
            out.append(trial)
        step()
    return out


def _estimates(bench: Bench, trial: Trial) -> list[Estimate]:
    rigs = [bench.rig(trial, k) for k in range(len(bench.rigs))]
    fitted = with_errors(trial.unknowns, trial.solution, blocks_of(bench.closed, rigs))
    return estimates_of(trial.unknowns, fitted, bench.base.problem.ids)


def _hull(own: Estimate, others: Sequence[Estimate]) -> Estimate:
    """Return an estimate whose interval reaches from its value over all intervals of the others."""
    if own.interval_low is None or own.interval_high is None:
        return own
    low = min([own.value, *(o.interval_low for o in others if o.interval_low is not None)])
    high = max([own.value, *(o.interval_high for o in others if o.interval_high is not None)])
    reach = max(high - own.value, own.value - low) / NORMAL
    stderr = None if own.stderr is None else reach
    return replace(own, interval_low=low, interval_high=high, stderr=stderr)
