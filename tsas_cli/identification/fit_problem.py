"""One dataset before the joint fit: its runs and its unknowns."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tsas_cli.identification.fit import Unknown
from tsas_cli.identification.model import Model
from tsas_cli.identification.prepared import Prepared
from tsas_cli.identification.quantities import LOG_SCALE, NOMINAL, QUANTITIES
from tsas_cli.identification.run_errors import RunErrors, run_errors
from tsas_cli.identification.run_simulation import fitted_samples, left_out_notes
from tsas_cli.physics.response import Dynamics
from tsas_cli.physics.rig import Rig, with_values
from tsas_cli.support.arrays import Floats

STATED_SCALE = {"friction_coefficient": 1.0}  # of the logarithm; of others LOG_SCALE
UNSTATED_SCALE = 7.0  # plausible logarithm of a nominal parameter that nobody states, over another
FURTHER_SCALE = 0.7  # plausible change of bristles (logarithm) and effects (their sizes)
ZERO_SCALE = 0.1  # of a displacement's range: its zero is where somebody has set it
# The condition of the runs without which a parameter is known but for a factor.
OVER = {"friction_coefficient": "total_bend_rad", "tendon_stiffness_N": "sheath_length_mm"}


@dataclass(frozen=True, eq=False)
class FitProblem:
    """One dataset before the joint fit: its unknowns and its runs, all at the initial values.

    `rigs` and `errors` are those of `runs`, the residuals weighted at these rigs; `initial` has the
    initial values, `fixed` those of parameters that are not identifiable; `left_out` has notes on
    the recordings that do not enter the fit.
    """

    initial: Model
    fixed: Model
    runs: tuple[Prepared, ...]
    rigs: tuple[Rig, ...]
    unknowns: tuple[Unknown, ...]
    errors: tuple[RunErrors, ...]
    left_out: tuple[str, ...]

    @property
    def ids(self) -> list[str]:
        """The ids of the runs that are fitted."""
        return [run.run.id for run in self.runs]

    def rig(self, k: int, values: Floats) -> Rig:
        """Return the rig of run k at scaled values of all unknowns."""
        return rig_at(self.rigs[k], k, self.unknowns, values)

    def owner(self, unknown: Unknown) -> str | None:
        """Return the id of the run that an unknown belongs to alone, None where it is shared."""
        return None if unknown.run is None else self.runs[unknown.run].run.id


def prepare_fit(
    initial: Model,
    fixed: Model,
    runs: Sequence[Prepared],
    *,
    plausible: Mapping[str, tuple[float, float]] | None = None,
    dynamics: Dynamics = "slip",
    further: Sequence[str] = (),
    shared: bool = True,
) -> FitProblem:
    """Return the joint fit of some runs as a problem to solve.

    `fixed` has the values of parameters that are not identifiable, `plausible` narrower bounds by
    name. Runs with too few samples are left out. Parameters in `further` are free besides the
    nominal ones, of which without `shared` only those of single runs are.
    """
    samples = [fitted_samples(run, initial.rig(run.run)) for run in runs]
    used = [(run, at) for run, at in zip(runs, samples, strict=True) if at]
    rigs = tuple(initial.rig(run.run) for run, _ in used)
    used_runs = tuple(run for run, _ in used)
    scale = scale_of_forces(fixed, used_runs)
    nominal = nominal_unknowns(initial, fixed, used_runs, plausible or {})
    unknowns = [u for u in nominal if u.name != scale and (shared or u.run is not None)]
    unknowns += [further_unknown(name, initial) for name in further]
    notes = [s for run, at in zip(runs, samples, strict=True) for s in left_out_notes(run, at)]
    if scale is not None:
        notes.append(
            f"Without a force sensor all forces are relative to {scale}: it is fixed, and the "
            "others are in proportion to it."
        )
    return FitProblem(
        initial,
        fixed,
        used_runs,
        rigs,
        tuple(unknowns),
        tuple(run_errors(*each, rig, dynamics) for each, rig in zip(used, rigs, strict=True)),
        tuple(notes),
    )


def rig_at(rig: Rig, k: int, unknowns: Sequence[Unknown], values: Floats) -> Rig:
    """Return the rig of run k with the scaled values of the unknowns that are its own or shared."""
    own = {
        u.name: QUANTITIES[u.name].unscaled(v)
        for u, v in zip(unknowns, values, strict=True)
        if u.run in (None, k)
    }
    return with_values(rig, own)


def nominal_unknowns(
    initial: Model,
    fixed: Model,
    runs: Sequence[Prepared],
    plausible: Mapping[str, tuple[float, float]],
) -> Iterator[Unknown]:
    """Yield all candidates, in the order of the identifiability check.

    With a load other than a spring the preload is equivalent to the zeros: it is fixed.
    """
    travel = max((float(np.ptp(r.drive.values)) for r in runs), default=0.0)
    springs = [k for k, run in enumerate(runs) if run.run.load == "spring"]
    for q in NOMINAL:
        owners: Sequence[int | None] = [None] if q.shared else range(len(runs))
        if q.name == "preload_N":
            owners = springs
        if q.name == "load_stiffness_N_per_mm" and not springs:
            continue
        over = OVER.get(q.name)
        but_for_a_factor = over is not None and any(getattr(r.run, over) is None for r in runs)
        for k in owners:
            owner = None if k is None else runs[k].run.id
            value = initial.value(q.name, owner)
            low, high = map(q.scaled, plausible.get(q.name, (q.lower, q.upper)))
            scaled = q.scaled(q.default if value is None else value)
            stated = fixed.value(q.name, owner) is not None and not but_for_a_factor
            relative = STATED_SCALE.get(q.name, LOG_SCALE) if stated else UNSTATED_SCALE
            scale = relative if q.positive else ZERO_SCALE * travel
            yield Unknown(q.name, k, min(max(scaled, low), high), low, high, scale)


def scale_of_forces(fixed: Model, runs: Sequence[Prepared]) -> str | None:
    """Return the parameter that all forces are relative to, where no force was measured.

    The stiffness of the tendon, unless only the preload is known.
    """
    if not runs or any(run.has_force for run in runs):
        return None
    stated = all(fixed.value("preload_N", r.run.id) or r.run.preload_N for r in runs)
    known = fixed.value("tendon_stiffness_N") is not None
    return "preload_N" if stated and not known else "tendon_stiffness_N"


def unknown_of(name: str, value: float | None = None, scale: float = 1.0) -> Unknown:
    """Return the unknown of a shared parameter, from a scaled value or its neutral one."""
    quantity = QUANTITIES[name]
    initial = quantity.scaled(quantity.default) if value is None else value
    return Unknown(
        name, None, initial, quantity.scaled(quantity.lower), quantity.scaled(quantity.upper), scale
    )


def further_unknown(name: str, initial: Model) -> Unknown:
    """Return the unknown of a parameter of bristles or effects, from a model's value if any."""
    value = initial.value(name)
    scaled = None if value is None else QUANTITIES[name].scaled(value)
    return unknown_of(name, scaled, FURTHER_SCALE)
