"""The diagnose stage: `diagnosis.json`, both models, and what each answers to the runs."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa

from tsas_cli import __version__
from tsas_cli.diagnosis.diagnose import Cause, Diagnosis, Verdict, diagnose
from tsas_cli.diagnosis.next_experiment import next_experiment
from tsas_cli.diagnosis.residual_map import residual_map
from tsas_cli.diagnosis.search import Search
from tsas_cli.effects import EFFECTS
from tsas_cli.files import folder_if, write_json
from tsas_cli.identification.comparison import compare
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model, fitted_to, source_of, stated_model, write_model
from tsas_cli.identification.phases import segment, segments_as_json
from tsas_cli.identification.prepared import Prepared, prepare
from tsas_cli.recordings.columns import BY_NAME, nominal_name
from tsas_cli.recordings.dataset import Dataset
from tsas_cli.recordings.writing import write_parquet
from tsas_cli.result import Result, Table, notes
from tsas_cli.steps import SILENT, Steps

Floats = npt.NDArray[np.float64]

EXTENDED, NOMINAL = "model-extended.toml", "model-nominal.toml"
SHOWN = 8  # hypotheses that are printed
_ERRORS = ("rmse_before", "rmse_after", "noise_floor", "best_obtainable")


@dataclass(frozen=True, repr=False, eq=False)
class DiagnosisResult(Result):
    """A verdict on what the nominal model lacks, and the extended model.

    Parameters
    ----------
    diagnosis
        The verdict and all that it rests on: causes, errors, what is left, every hypothesis.
    """

    diagnosis: Diagnosis

    @property
    def verdict(self) -> Verdict:
        """`named`, `ambiguous`, `sufficient`, `unexplained` or `undecided`."""
        return self.diagnosis.verdict

    @property
    def reason(self) -> str:
        """The verdict in one plain sentence."""
        return self.diagnosis.reason

    @property
    def causes(self) -> tuple[Cause, ...]:
        """What is named, with rivals, parameters and the gain on held-out data [%]."""
        return self.diagnosis.causes

    @property
    def model(self) -> Model:
        """The extended model; where nothing is named the nominal one, fitted again."""
        return self.diagnosis.model

    @property
    def next_experiment(self) -> str:
        """What to measure next."""
        return str(self.summary["next_experiment"])

    def tables(self) -> list[Table]:
        """Return what is named, the errors before and after, and the ranking."""
        return _tables(self.summary, self.titled("causes", EXTENDED))

    def sentences(self) -> list[str]:
        """Return the verdict, what to measure next, and what the recordings do not say."""
        cannot_tell = notes(self.summary["cannot_tell"])
        return [self.reason, f"Next: {self.next_experiment}", *cannot_tell]


def diagnose_dataset(
    dataset: Dataset,
    model: Model | Path | None,
    out: Path | None,
    *,
    force: bool = False,
    step: Steps = SILENT,
) -> DiagnosisResult:
    """Diagnose, and write what was found, both models and their answers into a new folder if any.

    The model, or else the data sheet, is where the refit of the nominal parameters begins.

    Raises
    ------
    InputError
        A recording or the model is wrong, or `out` exists and `force` is not set.
    """
    stated = stated_model(dataset.manifest, model)
    summary = dataset.header("diagnose", out) | {"model": source_of(model)}
    with folder_if(out, force=force) as folder:
        step.ahead(len(dataset.runs) + 1)
        runs = []
        for recording in dataset:
            runs.append(prepare(recording, dataset.manifest.session_start))
            step()
        result = diagnose(dataset.manifest, stated, runs, step)
        summary |= as_json(result, step)
        step()
        summary["segments"] = {run.run.id: segments_as_json(run, segment(run)) for run in runs}
        if folder is not None:
            _write(folder, summary, result, runs)
    return DiagnosisResult(summary, out, result)


def _write(folder: Path, summary: dict[str, Any], result: Diagnosis, runs: list[Prepared]) -> None:
    write_json(folder / "diagnosis.json", summary)
    for name, model in ((EXTENDED, result.model), (NOMINAL, result.nominal)):
        write_model(folder / name, model, version=__version__, dataset=fitted_to(summary))
    (folder / "runs").mkdir()
    for run in runs:
        table = _answers(run, result.model, result.nominal)
        write_parquet(folder / "runs" / f"{run.run.id}.parquet", table)


def _answers(run: Prepared, extended: Model, nominal: Model) -> pa.Table:
    """Return time, the conditioned or simulated x_in, and what each model answers to it."""
    after, before = compare(run, extended), compare(run, nominal)
    columns = {"time_s": run.time_s, "x_in_mm": after.response.x_in_mm, **after.channels}
    columns |= {nominal_name(name): values for name, values in before.channels.items()}
    return pa.table({name: pa.array(v, from_pandas=True) for name, v in columns.items()})


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


def _tables(summary: dict[str, Any], title: str) -> list[Table]:
    """Return what is named under its title, the errors before and after, and the ranking."""
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
