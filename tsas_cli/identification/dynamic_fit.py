"""The fit of the dynamic model: nominal parameters, bristles, and friction over speed.

First the stiffness of the bristles and viscous friction are freed. Then friction at rest, and after
it the bristles' damping, are screened over many values, since a fit that starts where the residual
is insensitive, or where sliding is unstable, does not move. The value with the largest reduction of
the residual is freed too, if it is identifiable; if not, a note gives the range that the recordings
do not exclude.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import cast

import numpy as np

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
from tsas_cli.support.arrays import Floats
from tsas_cli.support.steps import NO_PROGRESS, Steps

STIFFNESS, DAMPING = "bristles.stiffness_N_per_mm", "bristles.damping_N_s_per_mm"
VISCOUS = "viscous_friction.coefficient_N_s_per_mm"
EXCESS, VELOCITY = "stribeck_friction.excess", "stribeck_friction.velocity_mm_per_s"
VELOCITIES = np.geomspace(0.01, 100.0, 17)  # screened Stribeck velocities [mm/s]
TIMES = 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0  # screened values over the usual one
VAGUE_RATIO = 100.0  # of the ends of an interval that is not informative
SMALL = 1e-3  # excess of friction at rest for its sensitivity
FIRST_EXCESS = 0.01, 1.0  # range of its initial value
LEAST_REDUCTION = 25.0  # of the sum of squares over noise by a freed parameter
VISIBLE_EXCESS = 0.1  # excess of friction at rest whose visibility is reported
VISIBLE_TIMES_NOISE = 10.0  # norm over noise from which it is visible


@dataclass(frozen=True)
class DynamicFit:
    """The model, its least squares (None without a fit), and notes on the remaining residual."""

    model: Model
    fitted: Fitted | None
    cannot_tell: tuple[str, ...] = ()
    misfit: tuple[str, ...] = ()


@dataclass(frozen=True)
class ScreenedValue:
    """Screened values of parameters that are not free yet, linearised where a fit ended."""

    values: Mapping[str, float]
    moves: Floats  # least-squares step of the free parameters with these values, scaled, (p,)
    saves: float  # reduction of the sum of squares, in units of noise
    shows: bool = False  # whether an excess of VISIBLE_EXCESS would be visible


def dynamic_fit(nominal: Model, runs: Sequence[Prepared], step: Steps = NO_PROGRESS) -> DynamicFit:
    """Return the fit of nominal values, bristles and friction over speed with the dynamic chain.

    `nominal` is the model fitted with the slip chain, the initial one here. `step` reports each fit
    and each screened value.
    """
    stiffness = nominal.rig(runs[0].run).bristles.stiffness_N_per_mm
    first = {STIFFNESS: stiffness, VISCOUS: QUANTITIES[VISCOUS].size}
    fit = _solved(_model_of(first).over(nominal), nominal, runs, list(first), step)
    if fit is None:
        return DynamicFit(nominal, None)
    fit = _from_better_stiffness(fit, step) or _at_stiffness(fit, step) or fit
    at_rest = _friction_at_rest(fit, step)
    with_rest = _freed(fit, at_rest, step)
    fit = with_rest or fit
    dampings = _sizes(fit, DAMPING, step)
    fit = _freed(fit, dampings, step) or fit
    notes, fitted = fit.cannot_tell, cast("Fitted", fit.fitted)
    if with_rest is None:
        notes.append(_static_friction_note(at_rest))
    for name in (STIFFNESS, DAMPING, VISCOUS):
        if not _is_free(fit, name):
            looks = dampings if name == DAMPING else _sizes(fit, name, step)
            best = max(look.saves for look in looks)
            finest = _finest_stiffness(fit)
            equivalent = [
                look
                for look in looks
                if look.saves > best - LEAST_REDUCTION or look.values.get(STIFFNESS, 0.0) >= finest
            ]
            fitted = _widened(fitted, equivalent)
            notes.append(_indistinguishable_note(name, equivalent))
    estimates = estimates_of(fit.free, fitted, fit.problem.ids)
    model = Model(tuple(estimates)).over(fit.model)
    return DynamicFit(model, fitted, tuple(notes), tuple(misfit(fit)))


def _solved(
    initial: Model, fixed: Model, runs: Sequence[Prepared], further: Sequence[str], step: Steps
) -> FittedModel | None:
    """Return a fit with the nominal and further free parameters; None if none is identifiable.

    `initial` has the initial values, `fixed` those of parameters that are not identifiable.
    """
    step.ahead(1)
    fit = solve_fit(prepare_fit(initial, fixed, runs, dynamics="lugre", further=further))
    step()
    return None if fit.fitted is None else fit


def _solved_again(
    fit: FittedModel, look: ScreenedValue, fixed: Model, further: Sequence[str], step: Steps
) -> FittedModel | None:
    initial = _model_of(look.values).over(moved_model(fit, look.moves))
    return _solved(initial, fixed, fit.problem.runs, further, step)


def _further(fit: FittedModel) -> list[str]:
    """Return the names of the unknowns besides the nominal parameters."""
    return [u.name for u in fit.problem.unknowns if "." in u.name]


def _model_of(values: Mapping[str, float]) -> Model:
    return Model(
        tuple(Estimate(name, v, QUANTITIES[name].unit, "default") for name, v in values.items())
    )


def _friction_at_rest(fit: FittedModel, step: Steps) -> list[ScreenedValue]:
    """Return friction at rest screened over Stribeck velocities, with its least-squares size."""
    step.ahead(len(VELOCITIES))
    residual, slopes = residuals_with(fit, {}), slopes_of_free(fit)
    looks = []
    for velocity in map(float, VELOCITIES):
        small, visible = (
            (residuals_with(fit, {EXCESS: excess, VELOCITY: velocity}) - residual) / excess
            for excess in (SMALL, VISIBLE_EXCESS)
        )
        *moves, excess_step = _least_squares_step(np.column_stack((slopes, small)), residual)
        reduction = np.sum(residual**2) - np.sum(
            (residual + slopes @ moves + small * excess_step) ** 2
        )
        # At a low velocity the linearisation overestimates; at a high one it is plain friction.
        own = min(
            np.linalg.norm(e + slopes @ _least_squares_step(slopes, e)) for e in (small, visible)
        )
        looks.append(
            ScreenedValue(
                {EXCESS: float(np.clip(excess_step, *FIRST_EXCESS)), VELOCITY: velocity},
                np.array(moves),
                float(reduction) if excess_step > 0.0 else 0.0,
                bool(VISIBLE_EXCESS * own > VISIBLE_TIMES_NOISE),
            )
        )
        step()
    return looks


def _sizes(fit: FittedModel, name: str, step: Steps) -> list[ScreenedValue]:
    """Return a fixed parameter screened from its usual value up; the stiffness down too."""
    residual, slopes = residuals_with(fit, {}), slopes_of_free(fit)
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
        with_value = residuals_with(fit, {name: value})
        moves = _least_squares_step(slopes, with_value)
        reduction = float(np.sum(residual**2) - np.sum((with_value + slopes @ moves) ** 2))
        looks.append(ScreenedValue({name: value}, moves, reduction))
        step()
    return looks


def _is_free(fit: FittedModel, name: str) -> bool:
    return any(u.name == name for u in fit.free)


def _from_better_stiffness(fit: FittedModel, step: Steps) -> FittedModel | None:
    """Return a fit from the best screened stiffness, where it is fixed and another fits better."""
    if _is_free(fit, STIFFNESS):
        return None
    best = max(_sizes(fit, STIFFNESS, step), key=lambda look: look.saves)
    if best.saves < LEAST_REDUCTION:
        return None
    fixed = _model_of(best.values).over(fit.problem.fixed)
    return _solved_again(fit, best, fixed, _further(fit), step)


def _at_stiffness(fit: FittedModel, step: Steps) -> FittedModel | None:
    """Return a fit with the stiffness fixed, where its estimate is not informative.

    Its interval may be too wide, or the mesh too coarse for it.
    """
    finest = _finest_stiffness(fit)
    e = next((e for e in fit.model.estimates if e.name == STIFFNESS), None)
    if e is None or e.interval_low is None or e.interval_high is None:
        return None
    if e.interval_high < VAGUE_RATIO * e.interval_low and e.value < finest:
        return None
    at = ScreenedValue({STIFFNESS: min(e.value, finest)}, np.zeros(len(fit.chosen)), 0.0)
    further = [name for name in _further(fit) if name != STIFFNESS]
    return _solved_again(fit, at, _model_of(at.values).over(fit.problem.fixed), further, step)


def _finest_stiffness(fit: FittedModel) -> float:
    """Return the stiffness whose decay length √(EA L/σ0) is that of a lump [N/mm]."""
    rig = fit.rigs[0]
    return rig.tendon_stiffness_N * LUMPS**2 / rig.sheath_length_mm


def _least_squares_step(slopes: Floats, residual: Floats) -> Floats:
    """Return the step of the parameters that minimises the linearised residual."""
    return np.asarray(np.linalg.lstsq(slopes, -residual, rcond=None)[0])


def _freed(fit: FittedModel, looks: Sequence[ScreenedValue], step: Steps) -> FittedModel | None:
    """Return a fit with the best screened values free too; None if they are not identifiable."""
    best = max(looks, key=lambda look: look.saves)
    if best.saves < LEAST_REDUCTION:
        return None
    more = _solved_again(fit, best, fit.problem.fixed, [*_further(fit), *best.values], step)
    if more is None:
        return None
    found = {e.name: e for e in more.model.estimates if e.stderr is not None and not e.at_bound}
    for name in best.values:
        low = found[name].interval_low if name in found else None
        if low is None or low <= QUANTITIES[name].lower:
            return None
    return more


def _static_friction_note(looks: Sequence[ScreenedValue]) -> str:
    """Return the note on the Stribeck velocities at which friction at rest would be visible."""
    visible = [look.values[VELOCITY] for look in looks if look.shows]
    names = f"{EXCESS} and {VELOCITY} are not identifiable from these recordings"
    if not visible:
        return f"{names}, whatever their values."
    return (
        f"{names}: {VISIBLE_EXCESS:.0%} more friction at rest would be visible for velocities of "
        f"{min(visible):.2g} to {max(visible):.3g} mm/s; others are not excluded."
    )


def _indistinguishable_note(name: str, equivalent: Sequence[ScreenedValue]) -> str:
    """Return the note on the values of a fixed parameter that the recordings do not exclude."""
    values = [look.values[name] for look in equivalent]
    lowest = f"{min(values):.2g}" if name == STIFFNESS else "0"
    return (
        f"{name} is not identifiable: {lowest} to {max(values):.2g} {QUANTITIES[name].unit} fit "
        "equally well, and the other intervals include that range."
    )


def _widened(fitted: Fitted, equivalent: Sequence[ScreenedValue]) -> Fitted:
    """Return standard errors widened by the steps of values that fit equally well."""
    most = np.max([np.abs(look.moves) for look in equivalent], axis=0, initial=0.0)
    return replace(fitted, stderr=np.hypot(fitted.stderr, most / fitted.t))
