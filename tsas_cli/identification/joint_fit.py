"""The joint fit of the nominal parameters to all runs and all their measured channels.

Before the fit, the Jacobian says which parameters the recordings can tell; the others keep their
values. The errors and their weights are those of `run_errors`.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit import Fitted, Residuals, Unknown, fit, identifiable, jacobian
from tsas_cli.identification.model import Model
from tsas_cli.identification.prepared import Prepared
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.identification.run_errors import RunErrors, blocks_of
from tsas_cli.identification.samples import kept_samples, lost
from tsas_cli.identification.unknowns import further_unknown, nominal_unknowns
from tsas_cli.numerics.side_by_side import each
from tsas_cli.physics.response import Dynamics
from tsas_cli.physics.rig import Rig, with_values

Floats = npt.NDArray[np.float64]

MOST_ROUNDS = 4
MISSED = 1.3  # times what noise explains: the model is wrong
ROUGH, FINE = 1e-3, 1e-6  # tolerance of the first fit, whose weights are the start's, and after


class JointFit:
    """The joint fit of one dataset: its unknowns and its runs."""

    def __init__(
        self,
        start: Model,
        kept: Model,
        runs: Sequence[Prepared],
        plausible: Mapping[str, tuple[float, float]] | None = None,
        *,
        dynamics: Dynamics = "slip",
        further: Sequence[str] = (),
    ) -> None:
        """Take the values to start from, and those to keep where the recordings do not tell.

        `plausible` narrows the bounds of parameters, by name; `dynamics` is the model that is
        fitted; `further` names parameters to free beside the nominal ones.
        """
        self.start = start
        self.kept = kept
        samples = [kept_samples(run, start.rig(run.run)) for run in runs]
        self.left_out = [s for run, at in zip(runs, samples, strict=True) for s in lost(run, at)]
        self.runs = [run for run, at in zip(runs, samples, strict=True) if at]
        self.rigs = [start.rig(run.run) for run in self.runs]
        self.unknowns = nominal_unknowns(start, self.runs, plausible or {})
        self.unknowns += [further_unknown(name, start) for name in further]
        self.chosen: list[int] = []
        self.untold = self.left_out  # what the recordings do not say, once it is solved
        self.values = np.array([u.start for u in self.unknowns])
        kept_at = [at for at in samples if at]
        self.errors = [
            RunErrors(run, at, rig, dynamics)
            for run, at, rig in zip(self.runs, kept_at, self.rigs, strict=True)
        ]

    def keep_shared(self) -> None:
        """Leave free only what belongs to one run alone."""
        self.unknowns = [u for u in self.unknowns if u.run is not None]
        self.values = np.array([u.start for u in self.unknowns])

    def solve(self) -> tuple[Model, Fitted | None, list[str]]:
        """Fit what can be told; again with the weights of the result, until the choice stays.

        Returns the model, the fit (None where nothing can be told) and what cannot be told.
        """
        if not self.runs:
            return self.kept, None, self.left_out
        before: list[int] = []
        for _ in range(MOST_ROUNDS):
            J = jacobian(self.unknowns, len(self.runs), self._numbers(), self._residuals)
            chosen, confounded = identifiable(self.unknowns, J)
            # One that was fitted to a value too small to show is told: it is that small.
            small = [j for j in before if confounded.get(j) == []]
            chosen = sorted({*chosen, *small})
            confounded = {j: p for j, p in confounded.items() if j not in small}
            if not chosen:
                return self.kept, None, [*self.left_out, *self._sentences(confounded)]
            result = self._fit(chosen, tolerance=FINE if before else ROUGH)
            if chosen == before:
                break
            before = chosen
        self.chosen = chosen
        told = estimates_of(self.told(), result, self.ids())
        self.untold = [*self.left_out, *self._sentences(confounded)]
        return Model(tuple(told)).over(self.kept), result, [*self.untold, *_doubts(told, result)]

    def misfit(self) -> list[str]:
        """Say which channels are further from the model than what is known to be uncertain."""
        worst: dict[str, float] = {}
        for k in range(len(self.runs)):
            for name, errors in self.errors[k].errors(self._rig(k, self.values)).items():
                worst[name] = max(worst.get(name, 0.0), float(np.sqrt(np.mean(errors**2))))
        return [
            f"{name} is missed by up to {ratio:.3g} times what noise explains: the nominal model "
            "is wrong somewhere, and its values are those of the nearest nominal model, not of "
            "the rig."
            for name, ratio in worst.items()
            if ratio > MISSED
        ]

    def told(self) -> list[Unknown]:
        """Return the unknowns that the recordings tell, once it is solved."""
        return [self.unknowns[j] for j in self.chosen]

    def residuals_with(self, changes: Mapping[str, float]) -> Floats:
        """Return the residuals of all runs where it ended, with some shared values changed."""
        changed = [with_values(rig, changes) for rig in self.solved_rigs()]
        pairs = zip(self.errors, changed, strict=True)
        return np.concatenate(each(lambda pair: pair[0].residuals(pair[1]), list(pairs)))

    def solved_rigs(self) -> list[Rig]:
        """Return the rig of each run where it ended."""
        return [self._rig(k, self.values) for k in range(len(self.runs))]

    def slopes(self) -> Floats:
        """Return the Jacobian by what is told, where it ended, shape (n, p)."""
        residuals = self._beside(self.values, self.chosen)
        return jacobian(self.told(), len(self.runs), self.values[self.chosen], residuals)

    def moved(self, moves: Floats) -> Model:
        """Return the model where it ended with the values told moved, scaled, to start from."""
        at = self.values.copy()
        at[self.chosen] += moves
        there = [
            Estimate(
                u.name,
                QUANTITIES[u.name].unscaled(float(np.clip(v, u.lower, u.upper))),
                QUANTITIES[u.name].unit,
                "default",
                self._owner(u),
            )
            for u, v in zip(self.unknowns, at, strict=True)
            if np.isfinite(v)
        ]
        return Model(tuple(there)).over(self.start)

    def _numbers(self) -> Floats:
        """Return the values, of one that is kept critical the one to start from."""
        starts = [u.start for u in self.unknowns]
        return np.where(np.isnan(self.values), starts, self.values)

    def _beside(self, base: Floats, chosen: list[int]) -> Residuals:
        """Return the residuals of a run at scaled values of the chosen, the others as in `base`."""

        def residuals(k: int, values: Floats) -> Floats:
            at = base.copy()
            at[chosen] = values
            return self._residuals(k, at)

        return residuals

    def _fit(self, chosen: list[int], *, tolerance: float) -> Fitted:
        """Fit the chosen unknowns, the others as they are kept; renew values and weights."""
        base = np.array([self._kept(u) for u in self.unknowns])
        at = self._numbers()
        sought = [replace(self.unknowns[j], start=float(at[j])) for j in chosen]
        rigs = [self._rig(k, self.values) for k in range(len(self.errors))]
        blocks = blocks_of(self.errors, rigs)
        result = fit(sought, blocks, self._beside(base, chosen), tolerance=tolerance)
        base[chosen] = result.values
        self.values = base
        for k, run in enumerate(self.errors):
            run.weigh(self._rig(k, base))
        return result

    def _residuals(self, k: int, values: Floats) -> Floats:
        return self.errors[k].residuals(self._rig(k, values))

    def _kept(self, unknown: Unknown) -> float:
        """Return the scaled value that an unknown keeps where it is not fitted."""
        value = self.kept.value(unknown.name, self._owner(unknown))
        quantity = QUANTITIES[unknown.name]
        return quantity.scaled(quantity.default if value is None else value)

    def _rig(self, k: int, values: Floats) -> Rig:
        """Return the rig of run k at scaled values of all unknowns."""
        return rig_at(self.rigs[k], k, self.unknowns, values)

    def ids(self) -> list[str]:
        """Return the ids of the runs that are fitted."""
        return [run.run.id for run in self.runs]

    def _owner(self, unknown: Unknown) -> str | None:
        return None if unknown.run is None else self.runs[unknown.run].run.id

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
            f"it is kept at {_kept_value(self.kept, name, owners[0])}."
            for (name, why), owners in reasons.items()
        ]


def estimates_of(unknowns: Sequence[Unknown], found: Fitted, runs: Sequence[str]) -> list[Estimate]:
    """Return what a fit says of its unknowns, in their units; `runs` are the ids of the runs."""
    out = []
    told = zip(unknowns, found.values, found.stderr, found.t, found.at_bound, strict=True)
    for u, v, sd, t, at_bound in told:
        quantity = QUANTITIES[u.name]
        ends = np.clip([v - t * sd, v, v + t * sd], u.lower, u.upper)
        low, value, high = (quantity.unscaled(float(end)) for end in ends)
        stderr = sd * (value if quantity.positive else quantity.size)
        out.append(
            Estimate(
                u.name,
                value,
                quantity.unit,
                "fitted",
                None if u.run is None else runs[u.run],
                float(stderr) if np.isfinite(stderr) else None,
                low,
                high,
                bool(at_bound),
            )
        )
    return out


def rig_at(rig: Rig, k: int, unknowns: Sequence[Unknown], values: Floats) -> Rig:
    """Return the rig of run k with the scaled values of the unknowns that are its own or shared."""
    own = {
        u.name: QUANTITIES[u.name].unscaled(v)
        for u, v in zip(unknowns, values, strict=True)
        if u.run in (None, k)
    }
    return with_values(rig, own)


def _kept_value(kept: Model, name: str, owner: str) -> str:
    value = kept.value(name, owner or None)
    value = QUANTITIES[name].default if value is None else value
    unit = QUANTITIES[name].unit.removeprefix("1")
    return "its critical value" if math.isnan(value) else f"{value:.5g} {unit}".rstrip()


def _doubts(told: Sequence[Estimate], result: Fitted) -> list[str]:
    """Say what makes the fitted values unreliable."""
    names = {e: f"{e.name} of run {e.run}" if e.run else e.name for e in told}
    nothing = [e for e in told if e.at_bound and e.interval_low == QUANTITIES[e.name].default]
    out = [
        f"{names[e]} ended where it does nothing: at most {e.interval_high:.2g} {e.unit} would go "
        "unseen."
        for e in nothing
    ]
    out += [
        f"{names[e]} ended at the bound of what is plausible, {e.value:.5g}: it is not to be "
        "relied on."
        for e in told
        if e.at_bound and e not in nothing
    ]
    out += [
        f"{names[e]} does not show where the fit ended: its interval is all that is plausible."
        for e in told
        if e.stderr is None
    ]
    if not result.converged:
        out.append(
            f"The fit did not converge ({result.message.rstrip('.')}): its values are not to be "
            "relied on."
        )
    return out
