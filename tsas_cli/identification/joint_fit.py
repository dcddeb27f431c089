"""The joint fit of the nominal parameters to all runs and all their measured channels.

Each error counts in units of its standard deviation: the channel's noise, and what the remaining
noise of the drive does to it (large where the tangent stiffness is large). Before the fit, the
Jacobian says which parameters the recordings can tell; the others keep their values.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit import Fitted, Unknown, fit, identifiable, jacobian
from tsas_cli.identification.model import DEFAULTS, Model
from tsas_cli.identification.prepared import Prepared
from tsas_cli.numerics.covariance import block_length
from tsas_cli.physics.parameters import NOMINAL, NOMINAL_BY_NAME, NominalParameter
from tsas_cli.physics.quasi_static import Drive, Response, simulate

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]

MOST_MEANS = 2000  # means of neighbouring residuals that enter the fit, for a channel of a run
LOG_SCALE = 0.3  # plausible relative change of a positive parameter
ZERO_SCALE = 0.02  # plausible zero of a displacement sensor, of its range


class JointFit:
    """The joint fit of one dataset: its unknowns, runs, samples and weights."""

    def __init__(self, start: Model, runs: Sequence[Prepared]) -> None:
        self.start = start
        self.runs = runs
        self.unknowns = _unknowns(start, runs)
        answers = [simulate(start.rig(r.run), _from_rest(r)) for r in runs]
        self.samples = [_kept(r, a) for r, a in zip(runs, answers, strict=True)]
        self.weights = [self._weights(k, start) for k in range(len(runs))]

    def solve(self) -> tuple[Model, Fitted | None, list[str]]:
        """Fit what can be told, twice: the second time with the weights of the first result.

        Returns the model, the fit (None where nothing can be told) and what cannot be told.
        """
        values = np.array([u.start for u in self.unknowns])
        J = jacobian(self.unknowns, len(self.runs), values, self._residuals)
        chosen, confounded = identifiable(self.unknowns, J)
        sentences = self._sentences(confounded)
        if not chosen:
            return self.start, None, sentences
        self.unknowns = [self.unknowns[j] for j in chosen]
        first = fit(self.unknowns, self._blocks(values[chosen]), self._residuals)
        self.weights = [self._weights(k, self._model(first.values)) for k in range(len(self.runs))]
        self.unknowns = [
            replace(u, start=float(v)) for u, v in zip(self.unknowns, first.values, strict=True)
        ]
        result = fit(self.unknowns, self._blocks(first.values), self._residuals)
        if not result.converged:
            sentences.append(
                f"The fit did not converge ({result.message}): its values are not to be relied on."
            )
        return Model(_merged(self.start, self._estimates(result))), result, sentences

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
        for u, v, sd, at_bound in zip(
            self.unknowns, result.values, spread, result.at_bound, strict=True
        ):
            low, value, high = (_unscaled(u.name, v + k * result.t * sd) for k in (-1.0, 0.0, 1.0))
            parameter = NOMINAL_BY_NAME[u.name]
            stderr = float(value * sd if parameter.positive else sd)
            out.append(
                Estimate(
                    u.name,
                    value,
                    parameter.unit,
                    "fitted",
                    self._owner(u),
                    stderr,
                    low,
                    high,
                    bool(at_bound),
                )
            )
        return out

    def _errors(self, k: int, values: Floats) -> dict[str, Floats]:
        """Return run k's weighted errors of each channel, at the samples that are kept."""
        run, at = self.runs[k], self.samples[k]
        answer = _answers(simulate(self._model(values).rig(run.run), _from_rest(run)))
        return {
            name: ((answer[name] - measured) / self.weights[k][name])[at[name]]
            for name, measured in run.measured.items()
        }

    def _residuals(self, k: int, values: Floats) -> Floats:
        """Return run k's residuals: means of neighbouring errors that keep a variance of one."""
        parts = []
        for errors in self._errors(k, values).values():
            edges = _edges(errors.size)
            counts = np.diff([*edges, errors.size])
            parts.append(np.add.reduceat(errors, edges) / np.sqrt(counts))
        return np.concatenate(parts)

    def _weights(self, k: int, model: Model) -> dict[str, Floats]:
        """Return each channel's standard deviation per sample: its noise, and that of the drive.

        What the drive's error does is found by a simulation with each stroke moved on by one
        standard deviation, so that turning points move too.
        """
        run, drive = self.runs[k], _from_rest(self.runs[k])
        rig = model.rig(run.run)
        conditioned = run.conditioned[run.drive_column]
        forth = np.zeros(drive.values.size)
        for first, end in pairwise(conditioned.reversals):
            up = conditioned.values[end] >= conditioned.values[first]
            forth[first : end + 1] = conditioned.sd[first : end + 1] * (1.0 if up else -1.0)
        plain = _answers(simulate(rig, drive))
        moved = _answers(simulate(rig, replace(drive, values=drive.values + forth)))
        return {
            name: np.hypot(max(run.noise[name], 1e-9), moved[name] - plain[name])
            for name in run.measured
        }

    def _blocks(self, values: Floats) -> list[Indices]:
        """Return for each run the block of each residual, at least a conditioning window long."""
        out = []
        for k, (run, at) in enumerate(zip(self.runs, self.samples, strict=True)):
            window = max(c.window_s for c in run.conditioned.values())
            step = float(np.median(np.diff(run.time_s)))
            errors = list(self._errors(k, values).values())
            length = max(block_length(errors), round(window / step), 1)
            first = [at[name][_edges(at[name].size)] for name in run.measured]
            out.append(np.unique(np.concatenate(first) // length, return_inverse=True)[1])
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


def _edges(size: int) -> Indices:
    """Return where each mean of neighbouring samples begins."""
    return np.arange(0, size, max(1, -(-size // MOST_MEANS)))


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
    """Return the samples that enter the fit: those after the tendon has forgotten how it began.

    The first full slip erases the history; to be sure of it with other parameters too, the drive
    must travel as far again.
    """
    slipping = np.flatnonzero(np.abs(response.phase) == 1)
    x = run.drive.values
    travel = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(x)))))
    first = int(np.searchsorted(travel, 2.0 * travel[slipping[0]])) if slipping.size else 0
    usable = ~run.in_gap
    usable[:first] = False
    return {n: np.flatnonzero(usable & np.isfinite(m)) for n, m in run.measured.items()}
