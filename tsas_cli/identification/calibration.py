"""Calibrate the nominal model on a dataset: phases, stiffness per phase, joint fit.

The joint fit minimises the errors of all measured channels of all runs at once, each in units of
its noise and of what the remaining noise of the drive does to it (large where the tangent
stiffness is large). Before it, the Jacobian says which parameters the recordings can tell.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from tsas_cli.identification.comparison import compare
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit import Fitted, Unknown, fit, identifiable, jacobian
from tsas_cli.identification.model import CORRECTION, DEFAULTS, Model, data_sheet
from tsas_cli.identification.phases import Segment, segment
from tsas_cli.identification.prepared import Prepared
from tsas_cli.identification.starts import read_off
from tsas_cli.identification.stiffness import Slope, slopes
from tsas_cli.numerics.covariance import block_length
from tsas_cli.physics.parameters import NOMINAL, NOMINAL_BY_NAME, NominalParameter
from tsas_cli.physics.quasi_static import Drive, Response, simulate
from tsas_cli.recordings.manifest import Manifest

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]

MOST_SAMPLES = 20_000  # of a run that enter the fit, evenly spread
LOG_SCALE = 0.3  # plausible relative change of a positive parameter
ZERO_SCALE = 0.02  # plausible zero of a displacement sensor, of its range


@dataclass(frozen=True)
class Calibration:
    """The calibrated model and everything that was found on the way, per run where it is a list."""

    model: Model
    runs: Sequence[Prepared]
    segments: Sequence[list[Segment]]
    slopes: Sequence[list[Slope]]
    expected: Sequence[list[Slope]]
    cannot_tell: Sequence[str]
    fitted: Fitted | None


def calibrate(
    manifest: Manifest, runs: Sequence[Prepared], step: Callable[[], None] = lambda: None
) -> Calibration:
    """Calibrate the nominal model; `step` is called after each run's phases are found.

    Where a run holds no f_in_N there are no slopes for it; where nothing can be told, the model is
    that of the data sheet and `cannot_tell` says why.
    """
    segments, measured = [], []
    for run in runs:
        segments.append(segment(run))
        measured.append(_slopes(run, run.measured.get("f_in_N"), segments[-1]))
        step()
    stated = data_sheet(manifest)
    start = _start(stated, runs, segments, measured)
    problem = _Problem(start, runs)
    model, fitted, sentences = problem.solve()
    answers = [compare(run, model) for run in runs]
    expected = [
        _slopes(run, a.response.f_in_N, s)
        for run, a, s in zip(runs, answers, segments, strict=True)
    ]
    rmse = [a.rmse for a in answers]
    cannot = [*_unknown_conditions(runs), *sentences, *_misfit(runs, rmse)]
    return Calibration(
        _with_correction(model, runs), runs, segments, measured, expected, cannot, fitted
    )


def _slopes(run: Prepared, f_in: Floats | None, segments: list[Segment]) -> list[Slope]:
    if f_in is None or "x_in_mm" not in run.conditioned:
        return []
    return slopes(run.conditioned["x_in_mm"].values, f_in, segments)


def _start(
    stated: Model,
    runs: Sequence[Prepared],
    segments: Sequence[list[Segment]],
    measured: Sequence[list[Slope]],
) -> Model:
    """Return the model to start from: read off the data, else the data sheet's, else a default."""
    found: dict[tuple[str, str | None], list[float]] = {}
    for run, parts, km in zip(runs, segments, measured, strict=True):
        rig = stated.rig(run.run)
        values = read_off(run, parts, km, rig.sheath_length_mm, max(rig.total_bend_rad, 1e-3))
        for name, value in values.items():
            owner = None if NOMINAL_BY_NAME[name].shared else run.run.id
            found.setdefault((name, owner), []).append(value)
    estimates = [e for e in stated.estimates if (e.name, e.run) not in found]
    for (name, owner), values in found.items():
        unit = NOMINAL_BY_NAME[name].unit
        estimates.append(Estimate(name, float(np.median(values)), unit, "default", owner))
    return Model(tuple(estimates))


class _Problem:
    """The joint fit of one dataset: the unknowns, the runs, the weights."""

    def __init__(self, start: Model, runs: Sequence[Prepared]) -> None:
        self.start = start
        self.runs = runs
        self.unknowns = _unknowns(start, runs)
        self.responses = [simulate(start.rig(r.run), _from_rest(r)) for r in runs]
        self.samples = [_kept(r, a) for r, a in zip(runs, self.responses, strict=True)]
        self.weights = [self._weights(k, start) for k in range(len(runs))]

    def solve(self) -> tuple[Model, Fitted | None, list[str]]:
        """Fit what can be told, twice: the second time with the weights of the first result."""
        everything = np.array([u.start for u in self.unknowns])
        J = jacobian(self.unknowns, len(self.runs), everything, self._residuals)
        chosen, confounded = identifiable(self.unknowns, J)
        sentences = self._sentences(confounded)
        if not chosen:
            return self.start, None, sentences
        all_unknowns = self.unknowns
        self.unknowns = [all_unknowns[j] for j in chosen]
        result = fit(self.unknowns, self._blocks(self.start), self._residuals)
        model = self._model(result.values)
        self.weights = [self._weights(k, model) for k in range(len(self.runs))]
        self.unknowns = [
            replace(u, start=float(v)) for u, v in zip(self.unknowns, result.values, strict=True)
        ]
        result = fit(self.unknowns, self._blocks(model), self._residuals)
        fitted = self._estimates(result)
        if not result.converged:
            sentences.append(
                f"The fit did not converge ({result.message}); its values are not to be used."
            )
        return Model(_merged(self.start, fitted)), result, sentences

    def _model(self, values: Floats) -> Model:
        told = [
            Estimate(
                u.name, _unscaled(u.name, v), NOMINAL_BY_NAME[u.name].unit, "fitted", self._owner(u)
            )
            for u, v in zip(self.unknowns, values, strict=True)
        ]
        return Model(_merged(self.start, told))

    def _owner(self, unknown: Unknown) -> str | None:
        return None if unknown.run is None else self.runs[unknown.run].run.id

    def _estimates(self, result: Fitted) -> list[Estimate]:
        spread = np.sqrt(np.diag(result.covariance))
        out = []
        for u, v, sd, bound in zip(
            self.unknowns, result.values, spread, result.at_bound, strict=True
        ):
            low, value, high = (_unscaled(u.name, v + k * result.t * sd) for k in (-1.0, 0.0, 1.0))
            stderr = value * sd if NOMINAL_BY_NAME[u.name].positive else sd
            out.append(
                Estimate(
                    u.name,
                    value,
                    NOMINAL_BY_NAME[u.name].unit,
                    "fitted",
                    self._owner(u),
                    float(stderr),
                    low,
                    high,
                    bool(bound),
                )
            )
        return out

    def _residuals(self, k: int, values: Floats) -> Floats:
        """Return the weighted residuals of run k, channel after channel."""
        run, at = self.runs[k], self.samples[k]
        answer = _answers(simulate(self._model(values).rig(run.run), _from_rest(run)))
        parts = [
            ((answer[name] - measured) / self.weights[k][name])[at[name]]
            for name, measured in run.measured.items()
        ]
        return np.concatenate(parts)

    def _weights(self, k: int, model: Model) -> dict[str, Floats]:
        """Return each channel's standard deviation per sample: noise, and that of the drive.

        What the drive's error does is found by a simulation with each stroke moved on by one
        standard deviation, so that turning points move too.
        """
        run, drive = self.runs[k], _from_rest(self.runs[k])
        rig = model.rig(run.run)
        conditioned = run.conditioned[run.drive_column]
        forth = np.zeros(drive.values.size)
        turns = conditioned.reversals
        for first, end in zip(turns[:-1], turns[1:], strict=True):
            up = conditioned.values[end] >= conditioned.values[first]
            forth[first : end + 1] = conditioned.sd[first : end + 1] * (1.0 if up else -1.0)
        plain = _answers(simulate(rig, drive))
        moved = _answers(simulate(rig, replace(drive, values=drive.values + forth)))
        floor = {name: max(noise, 1e-9) for name, noise in run.noise.items()}
        return {name: np.hypot(floor[name], moved[name] - plain[name]) for name in run.measured}

    def _blocks(self, model: Model) -> list[Indices]:
        """Return for each run the block of each residual, at least a conditioning window long."""
        out = []
        for run, at, weights in zip(self.runs, self.samples, self.weights, strict=True):
            answer = _answers(simulate(model.rig(run.run), _from_rest(run)))
            left = [((answer[n] - m) / weights[n])[at[n]] for n, m in run.measured.items()]
            window = max(c.window_s for c in run.conditioned.values())
            step = float(np.median(np.diff(run.time_s)))
            thinned = max(1, run.time_s.size // MOST_SAMPLES)
            length = max(block_length(left) * thinned, round(window / step), 1)
            number = np.concatenate([at[n] // length for n in run.measured])
            out.append(np.unique(number, return_inverse=True)[1])
        return out

    def _sentences(self, confounded: Mapping[int, list[int]]) -> list[str]:
        """Say what is kept and why, one sentence for each parameter and reason."""
        reasons: dict[tuple[str, str], list[str]] = {}
        for j, partners in confounded.items():
            unknown = self.unknowns[j]
            names = sorted({self.unknowns[p].name for p in partners})
            why = f"cannot be told apart from {' and '.join(names)}" if names else "does not show"
            reasons.setdefault((unknown.name, why), []).append(self._owner(unknown) or "")
        return [
            f"{name} {why} in these recordings"
            f"{' (runs ' + ', '.join(owners) + ')' if any(owners) else ''}; "
            f"it is kept at {_kept_value(self.start, name, owners[0])}."
            for (name, why), owners in reasons.items()
        ]


def _kept_value(start: Model, name: str, owner: str) -> str:
    value = start.value(name, owner or None)
    value = DEFAULTS[name] if value is None else value
    return f"{value:.5g} {NOMINAL_BY_NAME[name].unit}"


def _unknowns(start: Model, runs: Sequence[Prepared]) -> list[Unknown]:
    out = []
    springs = any(run.run.load == "spring" for run in runs)
    for p in NOMINAL:
        if p.name == "load_stiffness_N_per_mm" and not springs:
            continue
        for k in [None] if p.shared else range(len(runs)):
            owner = None if k is None else runs[k].run.id
            value = start.value(p.name, owner)
            value = DEFAULTS[p.name] if value is None else value
            travel = max(float(np.ptp(r.drive.values)) for r in runs)
            scale = LOG_SCALE if p.positive else ZERO_SCALE * travel
            bounds = (_scaled(p, p.lower), _scaled(p, p.upper))
            out.append(Unknown(p.name, k, _scaled(p, value), *bounds, scale))
    return out


def _scaled(parameter: NominalParameter, value: float) -> float:
    return math.log(value) if parameter.positive else value


def _unscaled(name: str, value: float) -> float:
    return math.exp(value) if NOMINAL_BY_NAME[name].positive else float(value)


def _merged(start: Model, told: Sequence[Estimate]) -> tuple[Estimate, ...]:
    names = {(e.name, e.run) for e in told}
    return (*told, *(e for e in start.estimates if (e.name, e.run) not in names))


def _from_rest(run: Prepared) -> Drive:
    """Return the drive with a start from rest: the fit leaves out what the start still shows in."""
    return replace(run.drive, start_f_in_N=None)


def _answers(response: Response) -> dict[str, Floats]:
    return {
        "f_in_N": response.f_in_N,
        "f_out_N": response.f_out_N,
        "x_out_mm": response.x_out_mm,
    }


def _kept(run: Prepared, response: Response) -> dict[str, Indices]:
    """Return the samples that enter the fit: after the first full slip, which erases the history."""
    slipping = np.flatnonzero(np.abs(response.phase) == 1)
    first = int(slipping[0]) if slipping.size else 0
    usable = np.zeros(run.time_s.size, dtype=bool)
    usable[first :: max(1, run.time_s.size // MOST_SAMPLES)] = True
    usable &= ~run.in_gap
    return {n: np.flatnonzero(usable & np.isfinite(m)) for n, m in run.measured.items()}


def _with_correction(model: Model, runs: Sequence[Prepared]) -> Model:
    """Add the mean difference of fitted and stated preload, for runs that are not calibrated."""
    known = {
        e.run: e.value for e in model.estimates if e.name == "preload_N" and e.origin == "fitted"
    }
    off = [known[r.run.id] - r.run.preload_N for r in runs if r.run.id in known and r.run.preload_N]
    if not off:
        return model
    stderr = float(np.std(off, ddof=1)) if len(off) > 1 else None
    correction = Estimate(CORRECTION, float(np.mean(off)), "N", "fitted", stderr=stderr)
    return Model((*model.estimates, correction))


def _unknown_conditions(runs: Sequence[Prepared]) -> list[str]:
    out = []
    if any(r.run.total_bend_rad is None for r in runs):
        out.append(
            "total_bend_rad is not in the manifest: 1 rad is taken, so that friction_coefficient "
            "stands for the product of friction and bend."
        )
    if any(r.run.sheath_length_mm is None for r in runs):
        out.append(
            "sheath_length_mm is not in the manifest: 1000 mm is taken, so that "
            "tendon_stiffness_N stands for the stiffness of one metre."
        )
    return out


def _misfit(runs: Sequence[Prepared], rmse: Sequence[Mapping[str, float]]) -> list[str]:
    """Say where the calibrated model is further from the data than their noise allows."""
    worst: dict[str, float] = {}
    for run, errors in zip(runs, rmse, strict=True):
        for name, error in errors.items():
            if run.noise[name] > 0.0:
                worst[name] = max(worst.get(name, 0.0), error / run.noise[name])
    return [
        f"{name} is missed by up to {ratio:.3g} times its noise: the nominal model is wrong "
        "somewhere, and the intervals are those of the nearest nominal model, not of the rig."
        for name, ratio in worst.items()
        if ratio > 2.0
    ]
