"""The bench that laws of unnamed origin are fitted on: channels by their RMS, ranges, costs.

The noise's weights hide what happens at reversals, so each channel counts by the RMS of what the
named causes leave. A law acts over the ranges of the recordings, which are given to it, and its
parameters have a cost.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from tsas_cli.diagnosis.held_out import Folds
from tsas_cli.diagnosis.refitted import rms_of
from tsas_cli.effects.laws import FOLLOWS
from tsas_cli.identification.extension import Bench
from tsas_cli.identification.hypothesis_fit import HypothesisFit
from tsas_cli.identification.prepared import Prepared
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.identification.run_errors import ReversalShapes, RunErrors
from tsas_cli.physics.rig import with_values
from tsas_cli.support.arrays import Floats

# The channel that shows each law.
CHANGES = {"drive_law": "f_in_N", "tendon_law": "f_in_N", "load_law": "x_out_mm"}
# Longest width over the longest stroke: an element as wide as half of it only adds a straight line.
WIDEST = {"drive_law": 0.25, "tendon_law": 0.125, "load_law": 0.25}
REST, FAST = 1e-3, 0.95  # share of a high speed that is rest, and the quantile of a high speed
ALIKE = 1.25  # ratio of the highest tensions of two runs, up to which they are alike
TOLERANCE = 3e-5  # of the squares, for the last step of a fit
PRIOR = 0.1  # of a block's squares, the cost of a parameter that does as much as the residual
PLAUSIBLE_FACTOR = 0.3  # of a law that changes the friction,
PLAUSIBLE_PLACE = 0.1  # along the stroke of the drive: 0.3 predicts a damper at twice the error


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
            f"{law}.travel_mm": WIDEST[law] * longest,
            f"{law}.low_mm": float(whole.min()),
            f"{law}.high_mm": float(whole.max()),
        }
        if law != "load_law":
            slow, fast = speeds_of(runs)
            out[law] |= {f"{law}.slow_mm_per_s": slow, f"{law}.fast_mm_per_s": fast}
    return out


def speeds_of(runs: Sequence[Prepared]) -> tuple[float, float]:
    """Return a low and a high speed of the drive: quantiles over all runs [mm/s]."""
    speed = np.concatenate([np.abs(np.gradient(r.drive.values, r.time_s)) for r in runs])
    moving = speed[speed > REST * np.quantile(speed, FAST)]
    slow, fast = np.quantile(moving, (1.0 - FAST, FAST))
    return float(slow), float(max(fast, 1.1 * slow))


def in_channel_units(
    bench: Bench, trial: HypothesisFit, ranges: Mapping[str, Mapping[str, float]]
) -> Bench:
    """Return the bench with each channel's residual over its RMS, and the ranges of the laws."""
    raw: dict[str, list[Floats]] = {}
    for k, run in enumerate(bench.errors_for(trial)):
        for name, errors in run.raw(bench.rig(trial, k)).items():
            raw.setdefault(name, []).append(errors)
    rms = {name: rms_of(parts) for name, parts in raw.items()}
    given = {name: value for law in ranges.values() for name, value in law.items()}
    return replace(
        bench,
        tolerance=TOLERANCE,
        rigs=tuple(with_values(rig, given) for rig in bench.rigs),
        closed=tuple(_over_rms(run, rms) for run in bench.closed),
        meshed=tuple(_over_rms(run, rms) for run in bench.meshed),
        coarse=tuple(_over_rms(run, rms) for run in bench.coarse),
    )


def folds_by_tension(bench: Bench, folds: Folds) -> Folds | None:
    """Return folds of the runs whose tensions are alike, or None where all or none are.

    What is learned from them alone shows how a law extrapolates to another load.
    """
    tensions = np.array([_highest_tension(run.run) for run in bench.closed])
    order = np.argsort(tensions)
    apart = tensions[order[1:]] > ALIKE * tensions[order[:-1]]
    group = np.empty_like(order)
    group[order] = np.concatenate(([0], np.cumsum(apart)))
    if not folds.by_run or not apart.any() or apart.all():
        return None
    return replace(folds, fold=group[folds.run])


def _highest_tension(run: Prepared) -> float:
    values = [v for name in ("f_out_N", "f_in_N") if (v := run.channel(name)) is not None]
    return float(np.nanquantile(np.abs(values[0]), FAST)) if values else 1.0


def priors_of(bench: Bench, without: HypothesisFit, folds: Folds) -> dict[str, float]:
    """Return the priors of the laws' parameters, from the residuals without a law.

    A parameter that changes its channel by the RMS costs a tenth of a block's squares: few runs do
    not determine all of them, and without a cost they fail in a run that no fit has seen.
    """
    block = float(np.sum(without.solution.residual**2)) / folds.blocks
    forces = [
        np.abs(values)
        for run in bench.closed
        for name in ("f_in_N", "f_out_N")
        if (values := run.run.channel(name)) is not None
    ]
    tension = float(np.nanmean(np.concatenate(forces))) if forces else 1.0
    priors = {}
    for name, quantity in QUANTITIES.items():
        law, _, parameter = name.partition(".")
        channel = CHANGES.get(law)
        if channel not in bench.channels or quantity.given:
            continue
        rms = next(float(e.weights[channel][0]) for e in bench.closed if channel in e.samples)
        of_tension = "share" in parameter or quantity.unit == "mm/N"
        of_place = parameter.startswith("place_")
        factor = PLAUSIBLE_PLACE if of_place else PLAUSIBLE_FACTOR
        size = factor if quantity.unit == "1" else rms
        size = rms / tension if of_tension else size
        priors[name] = math.sqrt(PRIOR * block) * quantity.size / size
    return priors


def _over_rms(run: RunErrors, rms: Mapping[str, float]) -> RunErrors:
    weights = {name: np.full(run.run.time_s.size, rms[name]) for name in run.samples}
    turns = {
        name: ReversalShapes(np.zeros(at.size), np.array([0])) for name, at in run.samples.items()
    }
    return replace(run, weights=weights, turns=turns)
