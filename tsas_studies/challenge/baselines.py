"""What other people would do: three baselines that are scored beside `tsas diagnose`.

They share its nominal fit, its screening, its candidates and their fits; only the decision differs.
Intervals are those of the plain formula, which takes the residual for white.
"""

import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from tsas_cli.diagnosis.diagnose import bench_folds
from tsas_cli.diagnosis.fits import Fits
from tsas_cli.diagnosis.hypotheses import Names
from tsas_cli.diagnosis.nominal import nominal_fit
from tsas_cli.diagnosis.search import MOST_EFFECTS, add
from tsas_cli.effects import EFFECTS
from tsas_cli.identification.extension import bench_of
from tsas_cli.identification.fit import UNDETERMINED
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.joint_fit import solve_fit
from tsas_cli.identification.model import data_sheet
from tsas_cli.identification.prepared import prepare
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.identification.screening import projector, screen
from tsas_cli.recordings.dataset import read_dataset
from tsas_cli.support import __version__
from tsas_cli.support.files import new_folder, write_json
from tsas_studies.challenge.entry import FILE
from tsas_studies.challenge.sparse import strongest_effect

CLOSE = 10.0  # a larger difference of BIC is very strong evidence (Kass and Raftery 1995)
DROP = 0.01  # of the training error, that a cause has to take away
NOTHING: Names = frozenset()


def bic(dataset: Path, out: Path) -> None:
    """Name effects as long as the BIC of the samples falls, each time the one with the least BIC.

    Rivals of an effect are those with nearly the same BIC in its place.
    """
    fits = fits_of(dataset)
    named, rivals = NOTHING, {}
    while len(named) < MOST_EFFECTS:
        falls = {}
        for effect, _ in add(fits, named):
            before, after = _both(fits, named, named | {effect})
            falls[effect] = information_criterion(before) - information_criterion(after)
        best = max(falls, key=falls.__getitem__, default=None)
        if best is None or falls[best] <= 0.0:
            break
        rivals[best] = [e for e in falls if e != best and falls[e] > falls[best] - CLOSE]
        named |= {best}
    final = fits.trial(named)
    write_diagnosis(out, final, {e: [r for r in rivals[e] if r not in named] for e in rivals})


def training(dataset: Path, out: Path) -> None:
    """Name the effect that takes most from the training error, where it takes enough."""
    fits = fits_of(dataset)
    drops = {e: _drop(*_both(fits, NOTHING, frozenset({e}))) for e, _ in add(fits, NOTHING)}
    best = max(drops, key=drops.__getitem__, default=None)
    if best is None or drops[best] <= DROP:
        write_diagnosis(out, fits.trial(NOTHING), {})
    else:
        write_diagnosis(out, fits.trial(frozenset({best})), {best: []})


def sparse(dataset: Path, out: Path) -> None:
    """Name the effect of the strongest term in a sparse regression, where its fit takes enough."""
    fits = fits_of(dataset)
    bench, nominal = fits.bench, fits.trial(NOTHING)
    name = strongest_effect(bench, nominal, fits.folds)
    if name is None:
        write_diagnosis(out, nominal, {})
        return
    nominal = fits.trial(NOTHING, on_mesh=bench.on_mesh([name]))
    effect = next(e for e in EFFECTS if e.name == name)
    initial = screen(bench, nominal, effect, projector(nominal)).initial
    fitted = bench.fit([name], initial, near=nominal)
    write_diagnosis(out, fitted, {name: []} if _drop(nominal, fitted) > DROP else {})


def fits_of(dataset: Path) -> Fits:
    """Return the fitted nominal model of a dataset, on which effects can be tried."""
    read = read_dataset(dataset)
    runs = [prepare(recording, read.manifest.session_start) for recording in read]
    base = nominal_fit(read.manifest, data_sheet(read.manifest), runs)
    bench = bench_of(solve_fit(base))
    return Fits(bench, bench_folds(bench))


def information_criterion(trial: HypothesisFit) -> float:
    """Return the BIC of a fit, every residual counted as independent of all others."""
    count = trial.solution.residual.size
    return count * math.log(trial.mean_square) + len(trial.unknowns) * math.log(count)


def _both(fits: Fits, before: Names, after: Names) -> tuple[HypothesisFit, HypothesisFit]:
    """Return the fits of two sets of effects, on the mesh that the second one needs."""
    trial = fits.trial(after)
    return fits.trial(before, on_mesh=trial.on_mesh), trial


def _drop(before: HypothesisFit, after: HypothesisFit) -> float:
    """Return by which share the root mean square of the residuals falls."""
    return 1.0 - math.sqrt(after.mean_square / before.mean_square)


def write_diagnosis(out: Path, trial: HypothesisFit, rivals: Mapping[str, Iterable[str]]) -> None:
    """Write `out/diagnosis.json`: the effects of a fit are named, each with its rivals."""
    estimates = _estimates(trial)
    named = [
        {
            "effect": effect,
            "rivals": list(beside),
            "parameters": {
                name.partition(".")[2]: said
                for name, said in estimates.items()
                if name.startswith(f"{effect}.")
            },
        }
        for effect, beside in rivals.items()
    ]
    with new_folder(out, stage="challenge run", inputs=()) as folder:
        content = {
            "format": 1,
            "stage": "challenge run",
            "version": __version__,
            "verdict": "named" if named else "sufficient",
            "named": named,
            "channels": {},
            "remainder": {"unexplained": False, "depends_on": []},
            "next_experiment": "",
        }
        write_json(folder / FILE, content)


def _estimates(trial: HypothesisFit) -> dict[str, dict[str, Any]]:
    """Return value and standard error of each parameter: σ² (JᵀJ)⁻¹ with white residuals."""
    J, residual = trial.solution.jacobian, trial.solution.residual
    gram = J.T @ J
    inverse = np.linalg.pinv(gram, hermitian=True)
    variance = float(residual @ residual) / (residual.size - len(trial.unknowns))
    stderr = np.sqrt(variance * np.diag(inverse))
    determined = np.abs(np.diag(inverse @ gram) - 1.0) < UNDETERMINED
    out = {}
    for j, unknown in enumerate(trial.unknowns):
        quantity = QUANTITIES[unknown.name]
        out[unknown.name] = {
            "value": quantity.unscaled(float(trial.solution.values[j])),
            "stderr": float(stderr[j]) * quantity.size if determined[j] else None,
            "unit": quantity.unit,
            "at_bound": bool(trial.solution.at_bound[j]),
        }
    return out
