"""The diagnose stage: `diagnosis.json`, both models, and what each answers to the runs."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from tsas_cli import __version__
from tsas_cli.diagnosis.diagnose import Cause, Diagnosis, diagnose
from tsas_cli.diagnosis.next_experiment import next_experiment
from tsas_cli.diagnosis.residual_map import residual_map
from tsas_cli.diagnosis.search import Search
from tsas_cli.effects import EFFECTS
from tsas_cli.files import new_folder, write_json
from tsas_cli.identification.comparison import compare
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model, source_of, stated_model, write_model
from tsas_cli.identification.phases import segment, segments_as_json
from tsas_cli.identification.prepared import Prepared, prepare
from tsas_cli.recordings.columns import BY_NAME, nominal_name
from tsas_cli.recordings.dataset import Dataset, write_parquet

Floats = npt.NDArray[np.float64]
Table = tuple[str, Sequence[str], Sequence[Sequence[str]]]

EXTENDED, NOMINAL = "model-extended.toml", "model-nominal.toml"
SHOWN = 8  # hypotheses that are printed
_ERRORS = ("rmse_before", "rmse_after", "noise_floor", "best_obtainable")


def diagnose_dataset(
    dataset: Dataset,
    model_path: Path | None,
    out: Path,
    *,
    force: bool = False,
    step: Callable[[], None] = lambda: None,
) -> dict[str, Any]:
    """Diagnose and write what was found, both models and their answers into a new folder.

    The model, or else the data sheet, is where the refit of the nominal parameters begins.

    Raises
    ------
    InputError
        A recording or the model is wrong, or `out` exists and `force` is not set.
    """
    stated = stated_model(dataset.manifest, model_path)
    summary = dataset.header("diagnose", out) | {"model": source_of(model_path)}
    with new_folder(out, force=force) as folder:
        runs = []
        for recording in dataset:
            runs.append(prepare(recording, dataset.manifest.session_start))
            step()
        result = diagnose(dataset.manifest, stated, runs, step)
        summary |= as_json(result)
        summary["segments"] = {run.run.id: segments_as_json(run, segment(run)) for run in runs}
        write_json(folder / "diagnosis.json", summary)
        for name, model in ((EXTENDED, result.model), (NOMINAL, result.nominal)):
            write_model(folder / name, model, version=__version__, dataset=summary["dataset"])
        (folder / "runs").mkdir()
        for run in runs:
            table = _answers(run, result.model, result.nominal)
            write_parquet(folder / "runs" / f"{run.run.id}.parquet", table)
    return summary


def _answers(run: Prepared, extended: Model, nominal: Model) -> pa.Table:
    """Return time, the conditioned or simulated x_in, and what each model answers to it."""
    after, before = compare(run, extended), compare(run, nominal)
    columns = {"time_s": run.time_s, "x_in_mm": after.response.x_in_mm, **after.channels}
    columns |= {nominal_name(name): values for name, values in before.channels.items()}
    return pa.table({name: pa.array(v, from_pandas=True) for name, v in columns.items()})


def as_json(result: Diagnosis) -> dict[str, Any]:
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
        "next_experiment": next_experiment(result),
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
    nothing: frozenset[str] = frozenset()
    named = frozenset(cause.effect for cause in result.causes)
    for names, mesh in search.trials:
        instead = len(names) == len(named) and len(names - named) <= 1
        if mesh != search.bench.on_mesh(names) or not (len(names) == 1 or (names and instead)):
            continue
        trial, found = search.trial(names), search.gain(nothing, names)
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


def _signatures(search: Search) -> dict[str, Any]:
    """Return how visible each effect is on these inputs, and how alike each two are."""
    seen = sorted(search.screen(frozenset()), key=lambda s: s.effect.name)
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


def _evidence(search: Search) -> dict[str, Any]:
    folds, runs = search.folds, len(search.bench.rigs)
    if folds.by_run:
        how = f"each of {runs} runs is predicted by a fit to the others"
    else:
        how = f"with {runs} run(s), stretches are predicted by a fit to the rest"
    return {
        "held_out": "runs" if folds.by_run else "stretches",
        "blocks": folds.blocks,
        "runs": runs,
        "sentence": f"{how}; {folds.blocks} blocks longer than the error's memory count as "
        "evidence. Noise is told from the high-frequency part of each channel.",
    }


def tables(summary: dict[str, Any], out: Path) -> list[Table]:
    """Return what the stage prints: what is named, the errors before and after, the ranking."""
    named = [
        (
            cause["effect"],
            name,
            Estimate(
                name,
                p["value"],
                p["unit"],
                "fitted",
                None,
                p["stderr"],
                p["interval_low"],
                p["interval_high"],
                p["at_bound"],
            ).text(),
            p["unit"],
            ", ".join(cause["rivals"]),
        )
        for cause in summary["named"]
        for name, p in cause["parameters"].items()
    ]
    errors = [
        (name, *(f"{c[key]:.3g}" for key in _ERRORS), c["unit"])
        for name, c in summary["channels"].items()
    ]
    ranking = [
        (
            " + ".join(row["effects"]),
            f"{row['gain_percent']:.1f}",
            f"{row['sureness']:.1f}",
            "" if row["converged"] else "not converged",
        )
        for row in summary["candidates"][:SHOWN]
    ]
    title = f"causes → {out / EXTENDED}"
    return [
        *(
            [(title, ("effect", "parameter", "value [95 %]", "unit", "rivals"), named)]
            if named
            else []
        ),
        (
            "error on held-out data",
            ("channel", "before", "after", "noise", "obtainable", "unit"),
            errors,
        ),
        ("hypotheses", ("effects", "gain [%]", "sureness", ""), ranking),
    ]
