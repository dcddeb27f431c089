"""What `diagnosis.json` says of a diagnosis (docs/formats.md)."""

from typing import Any

import numpy as np
import numpy.typing as npt

from tsas_cli.diagnosis.diagnose import Cause, Diagnosis
from tsas_cli.diagnosis.next_experiment import next_experiment
from tsas_cli.diagnosis.residual_map import residual_map
from tsas_cli.diagnosis.search import Hypotheses
from tsas_cli.effects import EFFECTS
from tsas_cli.recordings.columns import BY_NAME
from tsas_cli.support.steps import SILENT, Steps
from tsas_cli.support.wording import count_of

Floats = npt.NDArray[np.float64]


def as_json(result: Diagnosis, step: Steps = SILENT) -> dict[str, Any]:
    """Return what `diagnosis.json` says of a diagnosis."""
    left = result.remainder
    return {
        "verdict": result.verdict,
        "reason": result.reason,
        "named": [_cause(cause) for cause in result.causes],
        "channels": {
            name: {"unit": BY_NAME[name].unit, **vars(channel)}
            for name, channel in result.channels.items()
        },
        "remainder": {
            "unexplained": result.unexplained,
            "depends_on": [] if left is None else list(left.depends_on),
            "share_percent": 100.0 * result.share_left,
            "mean_square": None if left is None else left.mean_square,
        },
        "next_experiment": next_experiment(result, step),
        "candidates": [] if result.search is None else _candidates(result),
        "signatures": {} if result.search is None else _signatures(result.search),
        "residual_map": _maps(result),
        "evidence": {} if result.search is None else _evidence(result.search),
        "cannot_tell": list(result.cannot_tell),
        "solver": "" if result.final is None else result.final.solver,
    }


def _cause(cause: Cause) -> dict[str, Any]:
    effect = next(e for e in EFFECTS if e.name == cause.effect)
    return {
        "effect": cause.effect,
        "title": effect.title,
        "equation": effect.equation,
        "rivals": list(cause.rivals),
        "parameters": {
            e.name.split(".")[1]: {
                "value": e.value,
                "stderr": e.stderr,
                "unit": e.unit,
                "at_bound": e.at_bound,
                "interval_low": e.interval_low,
                "interval_high": e.interval_high,
            }
            for e in cause.parameters
        },
        "gain_percent": cause.gain_percent,
        "gain_interval_percent": list(cause.gain_interval_percent),
    }


def _candidates(result: Diagnosis) -> list[dict[str, Any]]:
    """Return single effects, and what stands in place of the named ones, the best first."""
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
        rows.append(
            {
                "effects": sorted(names),
                "gain_percent": 100.0 * (1.0 - float(np.sqrt(1.0 - found.part))),
                "sureness": found.sureness,
                "convincing": found.convincing,
                "mean_square": trial.mean_square,
                "converged": trial.solution.converged,
                "parameters": trial.values(),
            }
        )
    return sorted(rows, key=lambda row: -row["gain_percent"])


def _signatures(search: Hypotheses) -> dict[str, Any]:
    """Return how visible each effect is on these inputs, and how alike each two are."""
    seen = sorted(search.screened, key=lambda s: s.effect.name)
    sizes = [float(np.linalg.norm(s.signatures.sum(axis=1))) for s in seen]
    spaces = [_orthonormal(s.signatures) for s in seen]
    likeness = [[_likeness(a, b) for b in spaces] for a in spaces]
    return {"effects": [s.effect.name for s in seen], "visible": sizes, "likeness": likeness}


def _orthonormal(signatures: Floats) -> Floats:
    u, sizes, _ = np.linalg.svd(signatures, full_matrices=False)
    return np.asarray(u[:, sizes > 1e-6 * max(float(sizes.max()), 1e-12)])


def _likeness(a: Floats, b: Floats) -> float:
    """Return the cosine of the smallest angle between what two effects can do, 1 if they share."""
    if a.shape[1] == 0 or b.shape[1] == 0:
        return 0.0
    return float(min(np.linalg.svd(a.T @ b, compute_uv=False).max(), 1.0))


def _maps(result: Diagnosis) -> dict[str, Any]:
    if result.judged is None or result.before is None or result.final is None:
        return {}
    bench = result.judged.bench
    return {
        "before": residual_map(bench, result.before),
        "after": residual_map(bench, result.final),
    }


def _evidence(search: Hypotheses) -> dict[str, Any]:
    folds, runs = search.folds, len(search.bench.rigs)
    if folds.by_run:
        how = f"each of {runs} runs is predicted by a fit to the others"
    else:
        how = f"with {count_of(runs, 'run')}, stretches are predicted by a fit to the rest"
    return {
        "held_out": "runs" if folds.by_run else "stretches",
        "blocks": folds.blocks,
        "runs": runs,
        "sentence": f"{how}; {folds.blocks} blocks longer than the error's memory count as "
        "evidence. Noise is told from the high-frequency part of each channel.",
    }
