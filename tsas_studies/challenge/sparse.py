"""Sparse regression of the residual on a library of terms, as SINDy does it.

Least squares are thresholded again and again until the terms stay (Brunton, Proctor and Kutz 2016).
The threshold is the largest whose error on what was left out is within one standard error of the
least (Hastie, Tibshirani and Friedman 2009, section 7.10).
"""

import warnings
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from tsas_cli.diagnosis.held_out import Folds
from tsas_cli.identification.extension import Bench
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.run_errors import RunErrors
from tsas_cli.identification.screening import projector
from tsas_cli.physics.rig import Rig
from tsas_cli.support.arrays import Floats
from tsas_cli.support.errors import InputError
from tsas_studies.challenge.library import Term, terms

LEAST, THRESHOLDS = 3.0, 16  # the smallest threshold [standard deviations of noise], how many
OWN = 0.01  # part of a term that the nominal parameters must not be able to imitate


def strongest_effect(bench: Bench, trial: HypothesisFit, folds: Folds) -> str | None:
    """Return the effect of the term that explains most of a trial's residual, if one is kept.

    InputError: PySINDy is not installed.
    """
    effects, columns = _columns(bench, trial)
    size = np.linalg.norm(columns, axis=0)
    basis = projector(trial)
    own = columns - basis @ (basis.T @ columns)
    left = np.linalg.norm(own, axis=0)
    identifiable = left > np.maximum(OWN * size, 1e-9)
    names = [name for name, keep in zip(effects, identifiable, strict=True) if keep]
    unit = own[:, identifiable] / left[identifiable]
    coefficients = regression(unit, trial.solution.residual, folds)
    best = int(np.argmax(np.abs(coefficients)))
    return names[best] if coefficients[best] != 0.0 else None


def _columns(bench: Bench, trial: HypothesisFit) -> tuple[list[str], Floats]:
    """Return the effect and the residual's change, shape (n,), of each term."""
    runs = bench.errors_for(trial)
    listed = [list(terms(run.run)) for run in runs]
    of_runs = [
        [_seen(run, bench.rig(trial, k), term) for term in own]
        for k, (run, own) in enumerate(zip(runs, listed, strict=True))
    ]
    return [term.effect for term in listed[0]], np.concatenate(of_runs, axis=1).T


def _seen(run: RunErrors, rig: Rig, term: Term) -> Floats:
    """Return what the residual of a run changes by when a term is added to what was measured."""
    added = {c: values + term.channels.get(c, 0.0) for c, values in run.run.measured.items()}
    changed = replace(run, run=replace(run.run, measured=added))
    return changed.residuals(rig) - run.residuals(rig)


def regression(columns: Floats, residual: Floats, folds: Folds) -> Floats:
    """Return the coefficient of each column of unit length, zero for those that are left out.

    InputError: PySINDy is not installed.
    """
    highest = max(float(np.abs(columns.T @ residual).max()), 2.0 * LEAST)
    thresholds = np.geomspace(LEAST, highest, THRESHOLDS)
    errors = np.array(
        [
            _held_out(columns, residual, folds.fold == k, thresholds)
            for k in range(int(folds.fold.max()) + 1)
        ]
    )
    best = errors[:, int(np.argmin(errors.mean(axis=0)))]
    worse = errors - best[:, None]
    spread = worse.std(axis=0, ddof=1) / np.sqrt(best.size)
    chosen = int(np.flatnonzero(worse.mean(axis=0) <= spread)[-1])
    return _thresholded(*_reduced(columns, residual), float(thresholds[chosen]))


def _held_out(
    columns: Floats, residual: Floats, left: npt.NDArray[np.bool_], thresholds: Floats
) -> Floats:
    """Return the mean square of what is left out, for each threshold."""
    seen = _reduced(columns[~left], residual[~left])
    coefficients = np.array([_thresholded(*seen, float(limit)) for limit in thresholds])
    missed = residual[left, None] - columns[left] @ coefficients.T
    return np.asarray(np.mean(missed**2, axis=0))


def _reduced(columns: Floats, residual: Floats) -> tuple[Floats, Floats]:
    """Return as few rows with the same least squares."""
    q, r = np.linalg.qr(columns)
    return r, q.T @ residual


def _thresholded(columns: Floats, residual: Floats, limit: float) -> Floats:
    try:
        from pysindy import STLSQ
    except ImportError as error:
        raise InputError(
            "this baseline needs the package pysindy", remedy="install tsas[challenge]"
        ) from error
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # that nothing is left is an answer here
        found = STLSQ(threshold=limit).fit(columns, residual[:, None])
    return np.asarray(found.coef_[0])
