"""What a fitted drive says: its numbers, what follows for a feedforward, what J makes of them.

u and x_in show ratios of J, B, k_d and k_p only. With J and r1 from the data sheet
k_d + k_p = J ω²/r1² and B = 2ζω J/r1²; with the kinematic K = 2π r1/(60 im) as well
k_d = g/K · (k_d + k_p), since g = K k_d/(k_d + k_p).
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tsas_cli.drive.fit import QUANTITIES, DriveTrial
from tsas_cli.drive.harmonic_drive import DriveValues
from tsas_cli.identification import joint_fit
from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.fit import with_errors
from tsas_cli.identification.model import check_wrap
from tsas_cli.physics.closed_form.capstan import speed_per_stiffness
from tsas_cli.recordings.manifest import MANIFEST_FILE, Manifest
from tsas_cli.support.arrays import Indices
from tsas_cli.support.errors import InputError

Derived = tuple[str, str, Callable[[DriveValues], float]]

PLAUSIBLE_HZ = 1e-3, 1e6  # natural frequencies of a drive
NUDGE = 1e-6  # of a scaled unknown, for the slope of a derived number


@dataclass(frozen=True)
class DataSheet:
    """What the manifest says of the drive; None where it does not."""

    turntable_radius_mm: float | None
    gear_ratio: float | None
    inertia_N_mm_s2: float | None
    pull_back_N_per_mm: float | None

    @property
    def kinematic_gain(self) -> float | None:
        """K = 2π r1/(60 im) [mm/s per rpm], Yang 2025, Eqs. (25) and (34)."""
        if self.turntable_radius_mm is None or self.gear_ratio is None:
            return None
        return speed_per_stiffness(self.turntable_radius_mm, self.gear_ratio)

    @property
    def mass(self) -> float | None:
        """J/r1² [N s²/mm], the inertia as the tendon feels it."""
        if self.inertia_N_mm_s2 is None or self.turntable_radius_mm is None:
            return None
        return self.inertia_N_mm_s2 / self.turntable_radius_mm**2

    @property
    def stated_frequency(self) -> float | None:
        """The natural frequency by Eqs. (23)-(25), in which only k_p holds the drive [Hz]."""
        if self.mass is None or self.pull_back_N_per_mm is None:
            return None
        return math.sqrt(self.pull_back_N_per_mm / self.mass) / (2.0 * math.pi)


def drive_sheet(manifest: Manifest) -> DataSheet:
    """Return what the data sheet says; k_p is kL e^{μθ}, the pull in contraction (31).

    InputError: what follows from it is no property of a drive.
    """
    rig = manifest.rig
    kL, mu = rig.load_stiffness_N_per_mm, rig.friction_coefficient
    bend, *others = {run.total_bend_rad for run in manifest.run}
    pull = None
    if kL is not None and mu is not None and bend is not None and not others:
        check_wrap(mu, bend, f"{MANIFEST_FILE}, rig")
        pull = kL * math.exp(mu * bend)
    sheet = DataSheet(rig.turntable_radius_mm, rig.gear_ratio, rig.inertia_N_mm_s2, pull)
    stated, (low, high) = sheet.stated_frequency, PLAUSIBLE_HZ
    if stated is not None and not low <= stated <= high:
        raise InputError(
            f"inertia_N_mm_s2, turntable_radius_mm and the load's spring give a natural frequency "
            f"of {stated:.3g} Hz",
            where=f"{MANIFEST_FILE}, rig",
            expected=f"{low:g} to {high:g} Hz",
            remedy="check their units",
        )
    return sheet


def estimates_of(
    trial: DriveTrial, blocks: Sequence[Indices], sheet: DataSheet, *, by_run: bool
) -> dict[str, Estimate]:
    """Return the fitted numbers and what is derived of them, by name.

    `blocks` has for each run the block of each residual, counted from 0; with `by_run` runs stand
    for the errors of a model that may be wrong.
    """
    fitted = with_errors(trial.unknowns, trial.solution, blocks, by_run=by_run)
    found = joint_fit.estimates_of(trial.unknowns, fitted, (), QUANTITIES)
    out = {estimate.name: estimate for estimate in found}
    for derived in _derived(trial.values, sheet):
        out[derived[0]] = _from(derived, trial, blocks, by_run=by_run)
    return out


def total_lag_s(values: DriveValues) -> float:
    """Return by how long x_in trails a ramp: τ + T + 2ζ/ω [s]."""
    w = 2.0 * math.pi * values.natural_frequency_Hz
    own = 2.0 * values.damping_ratio / w if w > 0.0 else 0.0
    return values.motor_lag_s + values.delay_s + own


def _derived(values: DriveValues, sheet: DataSheet) -> list[Derived]:
    """Return name, unit and law of what follows, as far as the data sheet lets it."""
    K, m = sheet.kinematic_gain, sheet.mass
    out: list[Derived] = [("kV_rpm_s_per_mm", "rpm s/mm", lambda v: 1.0 / v.gain_mm_per_s_rpm)]
    if total_lag_s(values) > 0.0:
        out.append(
            ("kA_rpm_s2_per_mm", "rpm s²/mm", lambda v: total_lag_s(v) / v.gain_mm_per_s_rpm)
        )
    if values.natural_frequency_Hz == 0.0 or m is None:
        return out

    def w(v: DriveValues) -> float:
        return 2.0 * math.pi * v.natural_frequency_Hz

    out.append(("damping_N_s_per_mm", "N s/mm", lambda v: 2.0 * v.damping_ratio * w(v) * m))
    if K is None:
        out.append(("whole_stiffness_N_per_mm", "N/mm", lambda v: m * w(v) ** 2))
        return out

    def share(v: DriveValues) -> float:
        return v.gain_mm_per_s_rpm / K

    return [
        *out,
        ("drive_stiffness_N_per_mm", "N/mm", lambda v: share(v) * m * w(v) ** 2),
        ("pull_back_N_per_mm", "N/mm", lambda v: (1.0 - share(v)) * m * w(v) ** 2),
        ("compliance_mm_per_N", "mm/N", lambda v: 1.0 / (share(v) * m * w(v) ** 2)),
    ]


def _from(
    derived: Derived, trial: DriveTrial, blocks: Sequence[Indices], *, by_run: bool
) -> Estimate:
    """Return a derived number: it takes the place of the unknown that moves it most."""
    name, unit, law = derived
    slopes = np.array([_slope(law, trial, j) for j in range(len(trial.unknowns))])
    most = int(np.argmax(np.abs(slopes)))
    J = trial.solution.jacobian
    changed = J - np.outer(J[:, most], slopes / slopes[most])
    changed[:, most] = J[:, most] / slopes[most]
    solution = replace(trial.solution, jacobian=changed)
    fitted = with_errors(trial.unknowns, solution, blocks, by_run=by_run)
    value, half = law(trial.values), float(fitted.t[most] * fitted.stderr[most])
    moving = np.abs(slopes) > 1e-9 * np.abs(slopes).max()
    bound = bool(np.any(trial.solution.at_bound & moving))
    stderr = float(fitted.stderr[most])
    return Estimate(name, value, unit, "fitted", None, stderr, value - half, value + half, bound)


def _slope(law: Callable[[DriveValues], float], trial: DriveTrial, j: int) -> float:
    q = QUANTITIES[trial.unknowns[j].name]
    at = float(trial.solution.values[j])
    ends = [
        law(trial.values._replace(**{q.name: q.unscaled(at + side * NUDGE)})) for side in (-1, 1)
    ]
    return (ends[1] - ends[0]) / (2.0 * NUDGE)
