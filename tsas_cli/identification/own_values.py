"""The parameters that belong to one run alone, fitted to it: its preload and its sensors' zeros."""

import math

import numpy as np

from tsas_cli.effects.force_sensor_offset import FORCE_SENSOR_OFFSET
from tsas_cli.effects.laws import FOLLOWS
from tsas_cli.identification.base_fit import read_off, slopes_of
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit_problem import FitProblem, prepare_fit
from tsas_cli.identification.joint_fit import FittedModel, solve_fit
from tsas_cli.identification.model import Model
from tsas_cli.identification.phases import segment
from tsas_cli.identification.prepared import Prepared

FORCE_ZEROS = [f"{FORCE_SENSOR_OFFSET.name}.{p.name}" for p in FORCE_SENSOR_OFFSET.parameters]
LEAST_SQUARE = 1e-24  # mean square of a channel's error, below which it counts as that


def with_own_values(model: Model, run: Prepared) -> Model:
    """Return a model with the parameters of one run fitted to it; all others are fixed.

    The zero of a force sensor is one of them where the model has an offset of it: it changes
    whenever the sensor is mounted. The fit starts from what the run shows, and once more from the
    median of the model's runs, as those of one mounting have the same zeros. Where a law of the
    model holds in a range of displacements, it starts with the run in the middle of it too: beyond
    it the law is constant, and shows no way back.
    """
    parts = segment(run)
    initial = read_off(model, [run], [parts], [slopes_of(run, parts)])
    own = Model(tuple(e for e in initial.estimates if e.run is not None))
    offsets = [e.name for e in model.estimates if e.name in FORCE_ZEROS and e.value != 0.0]

    def problem_from(start: Model) -> FitProblem:
        known = model.over(own)
        return prepare_fit(start.over(model), known, [run], shared=False, further=offsets)

    problems = [problem_from(own)]
    free = {u.name for u in problems[0].unknowns}
    for first in (_zeros_by_laws(model, run), _median(model, run)):
        values = tuple(e for e in first.estimates if e.name in free)
        if values:
            problems.append(problem_from(Model(values).over(own)))
    fits = [solve_fit(problem) for problem in problems]
    with_samples = [fit for fit in fits if fit.problem.runs]
    if len(with_samples) < 2:
        return (with_samples or fits)[0].model
    return min(with_samples, key=_log_rms).model


def _log_rms(fit: FittedModel) -> float:
    """Return the sum of the logarithms of the channels' RMS in a fit of one run.

    Fits that end far apart have other weights, and no channel's unit counts.
    """
    errors = fit.errors[0].raw(fit.rigs[0]).values()
    return sum(math.log(max(float(np.mean(e**2)), LEAST_SQUARE)) for e in errors)


def _median(model: Model, run: Prepared) -> Model:
    """Return the median of what belongs to the other runs of a model alone, for this run."""
    found: dict[tuple[str, str], list[float]] = {}
    for e in model.estimates:
        if e.run not in (None, run.run.id):
            found.setdefault((e.name, e.unit), []).append(e.value)
    return Model(
        tuple(
            Estimate(name, float(np.median(values)), unit, "default", run.run.id)
            for (name, unit), values in found.items()
        )
    )


def _zeros_by_laws(model: Model, run: Prepared) -> Model:
    """Return the zeros of a run in the middle of the displacements that the laws hold for."""
    zeros = {}
    for law, channel in FOLLOWS.items():
        low, high = (model.value(f"{law}.{end}_mm") for end in ("low", "high"))
        x = run.channel(channel)
        if low is None or high is None or x is None or not np.isfinite(x).any():
            continue
        middle = 0.5 * (float(np.nanmin(x)) + float(np.nanmax(x)))
        zeros[channel.replace("_mm", "_zero_mm")] = middle - 0.5 * (low + high)
    return Model(tuple(Estimate(n, v, "mm", "default", run.run.id) for n, v in zeros.items()))
