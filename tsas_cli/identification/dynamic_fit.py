"""The fit of the dynamic model: its bristles, and friction over speed, beside the nominal values.

First the stiffness of the bristles and viscous friction are freed. Friction at rest, then the
bristles' damping, are looked at from there, at many velocities and sizes, since a fit that begins
where it shows nothing, or where sliding is unstable, ends there. What saves most is freed too, and
stays free where it is identifiable; where not, it is said what the recordings would have shown.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit import Fitted
from tsas_cli.identification.fit_problem import prepare_fit
from tsas_cli.identification.joint_fit import (
    FittedModel,
    estimates_of,
    misfit,
    moved_model,
    residuals_with,
    slopes_of_free,
    solve_fit,
)
from tsas_cli.identification.model import Model
from tsas_cli.identification.prepared import Prepared
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.physics.lugre.start import bristles_of
from tsas_cli.physics.response import LUMPS
from tsas_cli.support.steps import SILENT, Steps

Floats = npt.NDArray[np.float64]

STIFFNESS, DAMPING = "bristles.stiffness_N_per_mm", "bristles.damping_N_s_per_mm"
VISCOUS = "viscous_friction.coefficient_N_s_per_mm"
EXCESS, VELOCITY = "stribeck_friction.excess", "stribeck_friction.velocity_mm_per_s"
VELOCITIES = np.geomspace(0.01, 100.0, 17)  # Stribeck velocities that may show [mm/s]
TIMES = 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0  # by which what is not identifiable may be larger
VAGUE = 100.0  # ratio of the ends of an interval that says nothing
SMALL = 1e-3  # excess of friction at rest by which its effect is found
FIRST_EXCESS = 0.01, 1.0  # range of its initial value
WORTH = 25.0  # squares in units of noise that what is freed must save
SEEN = 0.1  # excess of friction at rest that would show
CLEARLY = 10.0  # times noise


@dataclass(frozen=True)
class DynamicFit:
    """The model, the least squares behind it, None without any, and what these do not explain."""

    model: Model
    fitted: Fitted | None
    cannot_tell: tuple[str, ...] = ()
    misfit: tuple[str, ...] = ()


@dataclass(frozen=True)
class Look:
    """Values of what is not free yet, seen from where a fit ended."""

    values: Mapping[str, float]
    moves: Floats  # of the free parameters, with them, scaled, (p,)
    saves: float  # squares, in units of noise
    shows: bool = False


@dataclass(frozen=True)
class Solved:
    """A joint fit with free parameters, and the least squares of these."""

    fit: FittedModel
    fitted: Fitted


def dynamic_fit(nominal: Model, runs: Sequence[Prepared], step: Steps = SILENT) -> DynamicFit:
    """Fit nominal values, bristles and friction over speed with the dynamic chain.

    `nominal` is what the fit of the slip model found, where this one begins. `step` is told of
    each fit, and of each value that is looked at.
    """
    stiffness = nominal.rig(runs[0].run).bristles.stiffness_N_per_mm
    first = {STIFFNESS: stiffness, VISCOUS: QUANTITIES[VISCOUS].size}
    solved = _solved(_model_of(first).over(nominal), nominal, runs, list(first), step)
    if solved is None:
        return DynamicFit(nominal, None)
    solved = _from_better_stiffness(solved, step) or _at_stiffness(solved, step) or solved
    at_rest = _friction_at_rest(solved.fit, step)
    with_rest = _freed(solved, at_rest, step)
    solved = with_rest or solved
    dampings = _sizes(solved.fit, DAMPING, step)
    solved = _freed(solved, dampings, step) or solved
    said, fitted = solved.fit.cannot_tell, solved.fitted
    if with_rest is None:
        said.append(_unseen_rest(at_rest))
    for name in (STIFFNESS, DAMPING, VISCOUS):
        if not _is_free(solved.fit, name):
            looks = dampings if name == DAMPING else _sizes(solved.fit, name, step)
            best = max(look.saves for look in looks)
            finest = _finest_stiffness(solved.fit)
            like = [
                look
                for look in looks
                if look.saves > best - WORTH or look.values.get(STIFFNESS, 0.0) >= finest
            ]
            fitted = _widened(fitted, like)
            said.append(_alike(name, like))
    fit = solved.fit
    estimates = estimates_of(fit.free, fitted, fit.problem.ids)
    model = Model(tuple(estimates)).over(fit.model)
    return DynamicFit(model, fitted, tuple(said), tuple(misfit(fit)))


def _solved(
    initial: Model, fixed: Model, runs: Sequence[Prepared], further: Sequence[str], step: Steps
) -> Solved | None:
    """Return a fit with parameters freed beside the nominal ones; None where none is identifiable.

    The fit begins with the values of `initial`; what is not identifiable has those of `fixed`.
    """
    step.ahead(1)
    fit = solve_fit(prepare_fit(initial, fixed, runs, dynamics="lugre", further=further))
    step()
    return None if fit.fitted is None else Solved(fit, fit.fitted)


def _further(fit: FittedModel) -> list[str]:
    """Return what was to be freed beside the nominal parameters."""
    return [u.name for u in fit.problem.unknowns if "." in u.name]


def _model_of(values: Mapping[str, float]) -> Model:
    """Return initial values as a model."""
    return Model(
        tuple(Estimate(name, v, QUANTITIES[name].unit, "default") for name, v in values.items())
    )


def _friction_at_rest(fit: FittedModel, step: Steps) -> list[Look]:
    """Look at friction at rest with many Stribeck velocities, its size as the errors ask for."""
    step.ahead(len(VELOCITIES))
    left, slopes = residuals_with(fit, {}), slopes_of_free(fit)
    looks = []
    for velocity in map(float, VELOCITIES):
        small, seen = (
            (residuals_with(fit, {EXCESS: excess, VELOCITY: velocity}) - left) / excess
            for excess in (SMALL, SEEN)
        )
        *moves, asked = _asked(np.column_stack((slopes, small)), left)
        saved = np.sum(left**2) - np.sum((left + slopes @ moves + small * asked) ** 2)
        # A low velocity does less than it promises, and a high one is a change of friction.
        own = min(np.linalg.norm(e + slopes @ _asked(slopes, e)) for e in (small, seen))
        looks.append(
            Look(
                {EXCESS: float(np.clip(asked, *FIRST_EXCESS)), VELOCITY: velocity},
                np.array(moves),
                float(saved) if asked > 0.0 else 0.0,
                bool(SEEN * own > CLEARLY),
            )
        )
        step()
    return looks


def _sizes(fit: FittedModel, name: str, step: Steps) -> list[Look]:
    """Look at values of one that is fixed, from the usual one up; of the stiffness down too."""
    left, slopes = residuals_with(fit, {}), slopes_of_free(fit)
    rigs = fit.rigs
    usual = {
        STIFFNESS: rigs[0].bristles.stiffness_N_per_mm,
        DAMPING: max(bristles_of(rig).damping for rig in rigs),
        VISCOUS: QUANTITIES[VISCOUS].size,
    }[name]
    times = (*TIMES, *(1.0 / t for t in TIMES)) if name == STIFFNESS else TIMES
    step.ahead(len(times))
    looks = []
    for value in (usual * t for t in times):
        there = residuals_with(fit, {name: value})
        moves = _asked(slopes, there)
        saved = float(np.sum(left**2) - np.sum((there + slopes @ moves) ** 2))
        looks.append(Look({name: value}, moves, saved))
        step()
    return looks


def _is_free(fit: FittedModel, name: str) -> bool:
    return any(u.name == name for u in fit.free)


def _from_better_stiffness(solved: Solved, step: Steps) -> Solved | None:
    """Fit again from the stiffness that fits best, where it is fixed but another fits better."""
    if _is_free(solved.fit, STIFFNESS):
        return None
    best = max(_sizes(solved.fit, STIFFNESS, step), key=lambda look: look.saves)
    if best.saves < WORTH:
        return None
    stiffness, fit = _model_of(best.values), solved.fit
    initial = stiffness.over(moved_model(fit, best.moves))
    fixed = stiffness.over(fit.problem.fixed)
    return _solved(initial, fixed, fit.problem.runs, _further(fit), step)


def _at_stiffness(solved: Solved, step: Steps) -> Solved | None:
    """Fit again at the stiffness where the fit ended, where it is identifiable by its name alone.

    Its interval may hold anything, or the mesh be too coarse to show it.
    """
    finest = _finest_stiffness(solved.fit)
    for e in solved.fit.model.estimates:
        if e.name == STIFFNESS and e.interval_low is not None and e.interval_high is not None:
            if e.interval_high < VAGUE * e.interval_low and e.value < finest:
                return None
            there, fit = _model_of({STIFFNESS: min(e.value, finest)}), solved.fit
            further = [name for name in _further(fit) if name != STIFFNESS]
            initial = there.over(moved_model(fit, np.zeros(len(fit.chosen))))
            fixed = there.over(fit.problem.fixed)
            return _solved(initial, fixed, fit.problem.runs, further, step)
    return None


def _finest_stiffness(fit: FittedModel) -> float:
    """Return the stiffness whose way into the sheath, √(EA L/σ0), is as short as a lump [N/mm]."""
    rig = fit.rigs[0]
    return rig.tendon_stiffness_N * LUMPS**2 / rig.sheath_length_mm


def _asked(slopes: Floats, left: Floats) -> Floats:
    """Return the moves that take down most of some errors."""
    return np.asarray(np.linalg.lstsq(slopes, -left, rcond=None)[0])


def _freed(solved: Solved, looks: Sequence[Look], step: Steps) -> Solved | None:
    """Fit with the values of the best look free too; None where they are not identifiable."""
    best = max(looks, key=lambda look: look.saves)
    if best.saves < WORTH:
        return None
    problem = solved.fit.problem
    initial = _model_of(best.values).over(moved_model(solved.fit, best.moves))
    further = [*_further(solved.fit), *best.values]
    more = _solved(initial, problem.fixed, problem.runs, further, step)
    if more is None:
        return None
    estimates = more.fit.model.estimates
    found = {e.name: e for e in estimates if e.stderr is not None and not e.at_bound}
    for name in best.values:
        low = found[name].interval_low if name in found else None
        if low is None or low <= QUANTITIES[name].lower:
            return None
    return more


def _unseen_rest(looks: Sequence[Look]) -> str:
    """Say with which Stribeck velocity friction at rest would have shown."""
    shown = [look.values[VELOCITY] for look in looks if look.shows]
    what = f"{EXCESS} and {VELOCITY} do not show in these recordings"
    if not shown:
        return f"{what}, whatever they are."
    return (
        f"{what}: {SEEN:.0%} more friction at rest would, if its velocity were "
        f"{min(shown):.2g} to {max(shown):.3g} mm/s; of others nothing is known."
    )


def _alike(name: str, like: Sequence[Look]) -> str:
    """Say which values of one that is fixed fit as well."""
    values = [look.values[name] for look in like]
    lowest = f"{min(values):.2g}" if name == STIFFNESS else "0"
    return (
        f"{name} is not told: {lowest} to {max(values):.2g} {QUANTITIES[name].unit} fit alike, and "
        "the other intervals allow for it."
    )


def _widened(fitted: Fitted, like: Sequence[Look]) -> Fitted:
    """Widen the errors by what values that fit alike do to the others."""
    most = np.max([np.abs(look.moves) for look in like], axis=0, initial=0.0)
    return replace(fitted, stderr=np.hypot(fitted.stderr, most / fitted.t))
