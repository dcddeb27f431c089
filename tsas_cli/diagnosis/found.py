"""Records of a diagnosis for its files (docs/formats.md)."""

from collections.abc import Iterator

import numpy as np

from tsas_cli.diagnosis.channel_errors import noise_floor
from tsas_cli.diagnosis.diagnose import Diagnosis
from tsas_cli.diagnosis.held_out import predicted_folds
from tsas_cli.diagnosis.hypotheses import Hypotheses
from tsas_cli.diagnosis.proof import FoundCause
from tsas_cli.diagnosis.residual_map import residual_map
from tsas_cli.effects import EFFECTS
from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.records import diagnosis as records
from tsas_cli.records.base import Evidence, Value, number_text
from tsas_cli.support.arrays import Floats
from tsas_cli.support.wording import count_of


def cause_of(cause: FoundCause) -> records.NamedCause:
    """Return the record of an effect that gains with its title, equation and values."""
    effect = next(e for e in EFFECTS if e.name == cause.effect)
    return records.NamedCause(
        effect=cause.effect,
        title=effect.title,
        equation=effect.equation,
        rivals=cause.rivals,
        parameters={
            e.name.split(".")[1]: Value.model_validate(e, from_attributes=True)
            for e in cause.parameters
        },
        gain_percent=cause.gain_percent,
        gain_interval_percent=cause.gain_interval_percent,
        failed=cause.failed,
        law_differs=cause.law_differs,
    )


def beside_a_law(result: Diagnosis) -> Iterator[str]:
    """Yield a sentence for each parameter of a cause that a law has moved out of its interval."""
    if result.law is None:
        return
    for e in (estimate for cause in result.causes for estimate in cause.parameters):
        moved = result.model.value(e.name)
        if moved is not None and e.interval_low is not None and not e.holds(moved):
            yield (
                f"{e.name} is {number_text(moved)} in {records.EXTENDED_MODEL}, and {e.text()} "
                "without the law of unnamed origin, which takes a part of what it does."
            )


def held_out_of(result: Diagnosis) -> dict[str, records.HeldOut]:
    """Return each channel's residual RMS on held-out data, with its unit."""
    return {
        name: records.HeldOut(unit=BY_NAME[name].unit, **vars(channel))
        for name, channel in result.channels.items()
    }


def remainder_of(result: Diagnosis) -> records.RemainingResidual:
    """Return the record of the remaining residual, and the signals that it depends on."""
    remainder = result.remainder
    if remainder is None or result.judged is None:
        return records.RemainingResidual(unexplained=result.unexplained)
    bench = result.judged.bench
    return records.RemainingResidual(
        unexplained=result.unexplained,
        depends_on=remainder.depends_on,
        share_percent=100.0 * result.share_left,
        mean_square=remainder.mean_square,
        slow_noise={
            name: records.SlowNoise(
                sd=slow.ratio * noise_floor(bench, name, 0.0),
                unit=BY_NAME[name].unit,
                time_s=slow.time_s,
            )
            for name, slow in remainder.slow.items()
            if remainder.complete
        },
    )


def candidates_of(result: Diagnosis) -> list[records.TriedHypothesis]:
    """Return single effects, and sets with one named effect replaced, the best first.

    The reduction by a single named effect is that which it is named with, after a new fit.
    """
    search = result.search
    if search is None:
        return []
    rows = []
    named = frozenset(cause.effect for cause in result.causes)
    for names, mesh in search.trials:
        instead = len(names) == len(named) and len(names - named) <= 1
        if mesh != search.bench.on_mesh(names) or not (len(names) == 1 or (names and instead)):
            continue
        trial, found = search.trial(names), search.gain(names)
        alone = names == named and len(named) == 1
        reduction = 100.0 * (1.0 - float(np.sqrt(1.0 - found.part)))
        rows.append(
            records.TriedHypothesis(
                effects=tuple(sorted(names)),
                gain_percent=result.causes[0].gain_percent if alone else reduction,
                test_statistic=found.test_statistic,
                convincing=bool(found.convincing),
                mean_square=trial.mean_square,
                converged=bool(trial.solution.converged),
                parameters=trial.values(),
            )
        )
    return sorted(rows, key=lambda row: -np.inf if row.gain_percent is None else -row.gain_percent)


def signatures_of(search: Hypotheses | None) -> records.Signatures:
    """Return the visibility of each effect on these inputs, and the similarity of each pair."""
    if search is None:
        return records.Signatures()
    screened = sorted(search.screened, key=lambda s: s.effect.name)
    sizes = [float(np.linalg.norm(s.signatures.sum(axis=1))) for s in screened]
    spaces = [_orthonormal(s.signatures) for s in screened]
    names = tuple(s.effect.name for s in screened)
    return records.Signatures(effects=names, visible=sizes, similarity=_similarity(spaces))


def _orthonormal(signatures: Floats) -> Floats:
    u, sizes, _ = np.linalg.svd(signatures, full_matrices=False)
    return np.asarray(u[:, sizes > 1e-6 * sizes.max(initial=1e-12)])


def _similarity(spaces: list[Floats]) -> list[list[float]]:
    """Return the cosine of the smallest angle between each two effects' orthonormal bases."""
    together = np.hstack(spaces)
    ends = np.cumsum([space.shape[1] for space in spaces])[:-1]
    rows = np.split(together.T @ together, ends, axis=0)
    return [[_cosine(block) for block in np.split(row, ends, axis=1)] for row in rows]


def _cosine(products: Floats) -> float:
    return float(np.linalg.svd(products, compute_uv=False).max(initial=0.0).clip(max=1.0))


def residual_maps_of(result: Diagnosis) -> records.ResidualMaps:
    """Return the residual maps, before and after."""
    if result.judged is None or result.before is None or result.final is None:
        return records.ResidualMaps()
    bench = result.judged.bench
    return records.ResidualMaps(
        before=residual_map(bench, result.before), after=residual_map(bench, result.final)
    )


def evidence_of(result: Diagnosis) -> Evidence:
    """Return the record of the held-out data, with the number of blocks."""
    if result.judged is None or result.final is None:
        return Evidence()
    runs = len(result.judged.bench.rigs)
    folds = predicted_folds(result.final, result.judged.folds)
    if folds.by_run:
        how = f"each of {runs} runs is predicted by a fit to the others"
    elif result.judged.folds.by_run:
        how = (
            "the parameters of a run are not determined by the others: stretches of the runs are "
            "predicted by a fit to the rest"
        )
    else:
        how = f"with {count_of(runs, 'run')}, stretches are predicted by a fit to the rest"
    return Evidence(
        held_out="runs" if folds.by_run else "stretches",
        blocks=folds.blocks,
        runs=runs,
        sentence=f"{how}; {folds.blocks} blocks longer than the residual's autocorrelation count "
        "as evidence. The noise level is that of each channel's high-frequency part.",
    )
