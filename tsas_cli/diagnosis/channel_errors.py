"""Residual RMS of each channel on held-out data, before and after, in the channel's unit."""

import math
from dataclasses import dataclass

import numpy as np

from tsas_cli.diagnosis.held_out import held_out_values
from tsas_cli.diagnosis.remainder import Remainder
from tsas_cli.diagnosis.search import Hypotheses
from tsas_cli.identification.extension import HypothesisFit
from tsas_cli.identification.fit_problem import rig_at


@dataclass(frozen=True)
class HeldOutErrors:
    """Residual RMS of one channel on held-out data, its noise level and the attainable RMS."""

    rmse_before: float
    rmse_after: float
    noise_floor: float
    attainable: float


def channel_errors(
    search: Hypotheses,
    before: HypothesisFit,
    final: HypothesisFit,
    start: Remainder,
    remaining: Remainder,
) -> dict[str, HeldOutErrors]:
    """Return the residual RMS of each channel on held-out data, newly simulated."""
    rmse = {id(t): _held_out_rmse(search, t) for t in (before, final)}
    out = {}
    for name in search.bench.channels:
        weights = [
            run.weights[name][run.samples[name]]
            for run in search.bench.closed
            if name in run.samples
        ]
        first, after = rmse[id(before)][name], rmse[id(final)][name]
        noise = float(np.sqrt(np.mean(np.concatenate(weights) ** 2)))
        attainable = [
            math.sqrt(max(first**2 - start.explained[name] * noise**2, 0.0)),
            math.sqrt(max(after**2 - remaining.explained[name] * noise**2, 0.0)),
        ]
        floor_rms = min(noise, after)  # what was reached cannot be below it
        out[name] = HeldOutErrors(first, after, floor_rms, max(min(attainable), floor_rms))
    return out


def _held_out_rmse(search: Hypotheses, trial: HypothesisFit) -> dict[str, float]:
    """Return each channel's RMS, every run simulated with estimates from the others."""
    bench, folds = search.bench, search.folds
    squares: dict[str, float] = {}
    counts: dict[str, int] = {}
    for k, run in enumerate(bench.errors_for(trial)):
        for fold in np.unique(folds.fold[folds.run == k]):
            values = held_out_values(trial, folds, int(fold))
            rig = rig_at(bench.rigs[k], k, trial.unknowns, values)
            here = folds.fold[folds.run == k] == fold
            for name, errors in run.raw(rig).items():
                held_out = errors[run.spread(name, here)]
                squares[name] = squares.get(name, 0.0) + float(held_out @ held_out)
                counts[name] = counts.get(name, 0) + held_out.size
    return {name: float(np.sqrt(squares[name] / counts[name])) for name in squares}
