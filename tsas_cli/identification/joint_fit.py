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
from tsas_cli.numerics.conditioning import Conditioned
from tsas_cli.numerics.covariance import block_length
from tsas_cli.physics.parameters import NOMINAL, NOMINAL_BY_NAME, NominalParameter
from tsas_cli.physics.quasi_static import Drive, Response, simulate
from tsas_cli.physics.rig import Rig

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]

MOST_MEANS = 2000  # means of neighbouring residuals that enter the fit, for a channel of a run
MOST_ROUNDS = 4
LOG_SCALE = 0.3  # plausible relative change of a positive parameter
ZERO_SCALE = 0.02  # plausible zero of a displacement sensor, of its range


class JointFit:
    """The joint fit of one dataset: its unknowns, runs, samples and weights."""

    def __init__(self, start: Model, runs: Sequence[Prepared]) -> None:
        self.start = start
        self.runs = runs
        self.unknowns = _unknowns(start, runs)
        self.values = np.array([u.start for u in self.unknowns])
        answers = [simulate(start.rig(r.run), _from_rest(r)) for r in runs]
        self.samples = [_kept(r, a) for r, a in zip(runs, answers, strict=True)]
        self.weights = [self._weights(k) for k in range(len(runs))]

    def solve(self) -> tuple[Model, Fitted | None, list[str]]:
        """Fit what can be told; again with the weights of the result, until the choice stays.

        Returns the model, the fit (None where nothing can be told) and what cannot be told.
        """
        before: list[int] | None = None
        for _ in range(MOST_ROUNDS):
            J = jacobian(self.unknowns, len(self.runs), self.values, self._residuals)
            chosen, confounded = identifiable(self.unknowns, J)
            if not chosen:
                return self.start, None, self._sentences(confounded)
            result = self._fit(chosen)
            if chosen == before:
                break
            before = chosen
        sentences = self._sentences(confounded)
        if not result.converged:
            sentences.append(
                f"The fit did not converge ({result.message}): its values are not to be relied on."
            )
        return self._model(self._estimates(chosen, result)), result, sentences

    def _fit(self, chosen: list[int]) -> Fitted:
        """Fit the chosen unknowns, the others at their starts; renew values and weights."""
        base = np.array([u.start for u in self.unknowns])

        def residuals(k: int, values: Floats) -> Floats:
            base[chosen] = values
            return self._residuals(k, base)

        sought = [replace(self.unknowns[j], start=float(self.values[j])) for j in chosen]
        result = fit(sought, self._blocks(), residuals)
        base[chosen] = result.values
        self.values = base
        self.weights = [self._weights(k) for k in range(len(self.runs))]
        return result

    def _model(self, told: Sequence[Estimate]) -> Model:
        names = {(e.name, e.run) for e in told}
        return Model((*told, *(e for e in self.start.estimates if (e.name, e.run) not in names)))

    def _rig(self, k: int, values: Floats) -> Rig:
        """Return the rig of run k at scaled values of all unknowns."""
        own = {
            u.name: _unscaled(u.name, v)
            for u, v in zip(self.unknowns, values, strict=True)
            if u.run in (None, k)
        }
        rig: Rig = self.start.rig(self.runs[k].run)
        return Rig(**{**rig._asdict(), **own})

    def _owner(self, unknown: Unknown) -> str | None:
        return None if unknown.run is None else self.runs[unknown.run].run.id

    def _estimates(self, chosen: list[int], result: Fitted) -> list[Estimate]:
        spread = result.t * np.sqrt(np.diag(result.covariance))
        out = []
        for j, v, half, at_bound in zip(
            chosen, result.values, spread, result.at_bound, strict=True
        ):
            u = self.unknowns[j]
            parameter = NOMINAL_BY_NAME[u.name]
            ends = np.clip([v - half, v, v + half], u.lower, u.upper)
            low, value, high = (_unscaled(u.name, float(end)) for end in ends)
            stderr = half / result.t * (value if parameter.positive else 1.0)
            out.append(
                Estimate(
                    u.name,
                    value,
                    parameter.unit,
                    "fitted",
                    self._owner(u),
                    float(stderr),
                    low,
                    high,
                    bool(at_bound),
                )
            )
        return out

    def _errors(self, k: int, values: Floats) -> dict[str, Floats]:
        """Return run k's weighted errors of each channel, at the samples that are kept."""
        run, at = self.runs[k], self.samples[k]
        answer = _answers(simulate(self._rig(k, values), _from_rest(run)))
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

    def _weights(self, k: int) -> dict[str, Floats]:
        """Return each channel's standard deviation per sample: its noise, and those of the ends.

        What the error of an end does is found by a simulation with each of its strokes moved on
        by one standard deviation, so that turning points move too.
        """
        run, drive = self.runs[k], _from_rest(self.runs[k])
        rig = self._rig(k, self.values)
        plain = _answers(simulate(rig, drive))
        square = {
            name: np.full(run.time_s.size, max(n, 1e-9) ** 2) for name, n in run.noise.items()
        }
        for column, conditioned in run.conditioned.items():
            values = _moved_on(conditioned)
            moved = (
                replace(drive, values=values)
                if column == run.drive_column
                else replace(drive, load_values=values)
            )
            answers = _answers(simulate(rig, moved))
            for name in square:
                square[name] += (answers[name] - plain[name]) ** 2
        return {name: np.sqrt(values) for name, values in square.items()}

    def _blocks(self) -> list[Indices]:
        """Return for each run the block of each residual, at least a conditioning window long."""
        out = []
        for k, (run, at) in enumerate(zip(self.runs, self.samples, strict=True)):
            window = max(c.window_s for c in run.conditioned.values())
            step = float(np.median(np.diff(run.time_s)))
            errors = list(self._errors(k, self.values).values())
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


def _moved_on(conditioned: Conditioned) -> Floats:
    """Return the values with each stroke moved on by one standard deviation."""
    moved = conditioned.values.copy()
    for first, end in pairwise(conditioned.reversals):
        up = conditioned.values[end] >= conditioned.values[first]
        part = slice(first, end + 1)
        moved[part] = conditioned.values[part] + conditioned.sd[part] * (1.0 if up else -1.0)
    return moved


def _edges(size: int) -> Indices:
    """Return where each mean of neighbouring samples begins."""
    return np.arange(0, size, max(1, -(-size // MOST_MEANS)))


def _kept_value(start: Model, name: str, owner: str) -> str:
    value = start.value(name, owner or None)
    value = DEFAULTS[name] if value is None else value
    return f"{value:.5g} {NOMINAL_BY_NAME[name].unit}"


def _unknowns(start: Model, runs: Sequence[Prepared]) -> list[Unknown]:
    """Return all candidates, in the order in which they are asked for.

    With a load that is no spring the preload is only a name for the zeros: it keeps its value.
    """
    out = []
    travel = max(float(np.ptp(r.drive.values)) for r in runs)
    springs = [k for k, run in enumerate(runs) if run.run.load == "spring"]
    for p in NOMINAL:
        owners: Sequence[int | None] = [None] if p.shared else range(len(runs))
        if p.name == "preload_N":
            owners = springs
        if p.name == "load_stiffness_N_per_mm" and not springs:
            continue
        for k in owners:
            value = start.value(p.name, None if k is None else runs[k].run.id)
            value = DEFAULTS[p.name] if value is None else value
            scale = LOG_SCALE if p.positive else ZERO_SCALE * travel
            bounds = (_scaled(p, p.lower), _scaled(p, p.upper))
            out.append(Unknown(p.name, k, _scaled(p, value), *bounds, scale))
    return out


def _scaled(parameter: NominalParameter, value: float) -> float:
    return math.log(value) if parameter.positive else value


def _unscaled(name: str, value: float) -> float:
    return math.exp(value) if NOMINAL_BY_NAME[name].positive else float(value)


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
