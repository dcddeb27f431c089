"""Fitted values held against the data sheet: contradictions, and a factor that explains them.

A wrong unit or gain of both force sensors multiplies preload, load stiffness and tendon stiffness
by one factor; one of both displacements divides the two stiffnesses alone. Friction stays as it is.
A compliant sheath lowers the apparent tendon stiffness EA/(1 + compliance) alone.
"""

import math
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from tsas_cli.identification.estimate import Estimate
from tsas_cli.identification.model import Model, data_sheet
from tsas_cli.identification.quantities import QUANTITIES
from tsas_cli.recordings.manifest import Manifest
from tsas_cli.records.base import TWO_SIDED
from tsas_cli.support.wording import listed

FRICTION, PRELOAD = "friction_coefficient", "preload_N"
LOAD, TENDON = "load_stiffness_N_per_mm", "tendon_stiffness_N"
SHEATH = "sheath_compression.compliance_ratio"
STATED_SD = {PRELOAD: 0.1, LOAD: 0.05, TENDON: 0.1, FRICTION: 0.2}  # of a data sheet, relative
TOLERATED = {PRELOAD: 0.3, LOAD: 0.15, TENDON: 0.15, FRICTION: 0.5}  # relative difference
NAMES = {
    PRELOAD: "preload", LOAD: "load stiffness", TENDON: "tendon stiffness", FRICTION: "friction",
}  # fmt: skip
SURE = 3.0  # standard errors, beyond which a factor is none by chance
CONSISTENT = {1: 3.84, 2: 5.99}  # 95 % quantile of chi-square, by degrees of freedom
ALIKE = 1.0  # of chi-square, within which two factors explain the same
NEAR_UNIT = 0.12  # of the logarithm of a factor
IMITATED = frozenset({"sheath_compression", "free_tendon", "drive_compliance",
                      "position_sensor_gain", "force_sensor_gain"})  # fmt: skip
SHEET = "a wrong tendon_modulus_GPa, tendon_diameter_mm or sheath_length_mm"
CAUSES = {
    PRELOAD: "check preload_N of the manifest, and zero and gain of the force sensors",
    LOAD: "check load_stiffness_N_per_mm, and unit and gain of f_out and x_out",
    FRICTION: "check friction_coefficient, total_bend_rad, and the gain of each force sensor",
}


@dataclass(frozen=True)
class _Scale:
    """A factor of two channels: the power of it in each quantity, and the units it may be."""

    channels: str
    powers: Mapping[str, float]
    units: Mapping[float, str]
    gain: str


SCALES = (
    _Scale(
        "f_in and f_out",
        {PRELOAD: 1.0, LOAD: 1.0, TENDON: 1.0},
        {1 / 4.448: "pound-force", 1 / 9.807: "kilogram-force", 1e-3: "kilonewton"},
        "the unit or the amplifier's gain",
    ),
    _Scale(
        "x_in and x_out",
        {PRELOAD: 0.0, LOAD: -1.0, TENDON: -1.0},
        {0.1: "centimetre", 1 / 25.4: "inch", 1e-3: "metre"},
        "the unit or the gain",
    ),
)


@dataclass(frozen=True)
class _Deviation:
    """A fitted value beside that of the data sheet; `sd` is the fit's, of the logarithm."""

    name: str
    fitted: float
    stated: float
    unit: str
    sd: float
    at_bound: bool

    @property
    def log_ratio(self) -> float:
        return math.log(self.fitted / self.stated)

    @property
    def contradicts(self) -> bool:
        tolerated = -math.log(1.0 - TOLERATED[self.name]) + TWO_SIDED * self.sd
        return self.at_bound or abs(self.log_ratio) > tolerated

    def text(self) -> str:
        unit = self.unit.removeprefix("1")
        return f"{NAMES[self.name]} ({self.fitted:.3g} for {self.stated:.3g} {unit}".rstrip() + ")"


def contradictions(manifest: Manifest, model: Model, named: Collection[str] = ()) -> list[str]:
    """Return sentences on where a fitted model contradicts the data sheet; none where nowhere.

    What the model has not estimated is not compared, nor what takes the place of a length or a bend
    that is not stated. A wrong factor or data sheet may be the cause in place of the effects that a
    diagnosis has `named`.
    """
    compared = {
        TENDON: all(run.sheath_length_mm is not None for run in manifest.run),
        FRICTION: all(run.total_bend_rad is not None for run in manifest.run),
    }
    deviations = _deviations(data_sheet(manifest), model)
    found = {d.name: d for d in deviations if compared.get(d.name, True)}
    alike = [name for name in named if name in IMITATED]
    rivals = f" Either would be a rival of {listed(alike)}." if alike else ""
    tried = [factor for scale in SCALES if (factor := _factor(scale, found))]
    best = min((spread for spread, _ in tried), default=0.0)
    factors = [text for spread, text in tried if spread < best + ALIKE]
    if factors:
        others = [d for name, d in found.items() if name == FRICTION]
        said = [f"A{', or a'.join(factors)}, or the data sheet.{rivals}"]
    else:
        others, said = list(found.values()), []
    for d in others:
        if d.contradicts:
            said.append(_sentence(d, found) + (rivals if d.name == TENDON else ""))
    return said


def _deviations(stated: Model, model: Model) -> Iterator[_Deviation]:
    """Yield what was estimated and is stated; of what each run has its own of, the mean."""
    for name in STATED_SD:
        plausible = QUANTITIES[name].lower, QUANTITIES[name].upper  # where a fit ends
        pairs = [
            (e, float(np.clip(known, *plausible)))
            for e in model.estimates
            if e.name == name and (known := stated.value(name, e.run)) and _estimated(e, model)
        ]
        if not pairs:
            continue
        # Of the tendon's stiffness what it is with the sheath's compliance.
        softer = 1.0 + (model.value(SHEATH) or 0.0) if name == TENDON else 1.0
        logs = np.array([math.log(e.value / softer / known) for e, known in pairs])
        between = float(np.std(logs, ddof=1)) if logs.size > 1 else 0.0
        own = float(np.mean([_log_sd(e, model) for e, _ in pairs]))
        value = float(np.exp(np.mean([math.log(known) for _, known in pairs])))
        yield _Deviation(
            name,
            value * math.exp(float(logs.mean())),
            value,
            pairs[0][0].unit,
            math.hypot(own, between),
            name == TENDON and SHEATH not in _names(model) and any(e.at_bound for e, _ in pairs),
        )


def _names(model: Model) -> set[str]:
    return {e.name for e in model.estimates}


def _estimated(e: Estimate, model: Model) -> bool:
    if e.value <= 0.0:
        return False
    if e.name == TENDON and SHEATH in _names(model):  # together they are
        return True
    return e.origin == "fitted" and e.interval_low is not None


def _log_sd(e: Estimate, model: Model) -> float:
    """Return the standard error of a value's logarithm; none where its bounds set the interval."""
    by_bounds = e.at_bound or (e.name == TENDON and SHEATH in _names(model))
    if by_bounds or not e.interval_low or not e.interval_high:
        return 0.0
    return math.log(e.interval_high / e.interval_low) / (2.0 * TWO_SIDED)


def _factor(scale: _Scale, found: Mapping[str, _Deviation]) -> tuple[float, str] | None:
    """Return how far values are from a common factor (chi-square), and what it explains."""
    known = [d for name, d in found.items() if name in scale.powers and not d.at_bound]
    power = np.array([scale.powers[d.name] for d in known])
    scaled = [d for d in known if scale.powers[d.name]]
    if len(scaled) < 2:
        return None
    weight = np.array([1.0 / (STATED_SD[d.name] ** 2 + d.sd**2) for d in known])
    logs = np.array([d.log_ratio for d in known])
    whole = float(weight @ power**2)
    mean, sd = float(weight @ (power * logs)) / whole, whole**-0.5
    spread = float(weight @ (logs - mean * power) ** 2)
    if abs(mean) < SURE * sd or spread > CONSISTENT[len(known) - 1]:
        return None
    low, factor, high = (math.exp(mean + side * TWO_SIDED * sd) for side in (-1.0, 0.0, 1.0))
    unit = [u for f, u in scale.units.items() if abs(mean - math.log(f)) < NEAR_UNIT]
    looks = f" (both look like {unit[0]})" if unit else ""
    text = (
        f" common factor of {scale.channels} of {factor:.3g} [{low:.3g}, {high:.3g}] explains "
        f"{listed([d.text() for d in scaled])}{looks}: check {scale.gain}"
    )
    return spread, text


def _sentence(d: _Deviation, found: Mapping[str, _Deviation]) -> str:
    ratio = math.exp(d.log_ratio)
    bound = ", the bound of what is plausible" if d.at_bound else ""
    head = f"The fitted {d.text()} is {ratio:.3g} times that of the data sheet{bound}"
    if d.name != TENDON:
        return f"{head}: {CAUSES[d.name]}."
    sheath = ["sheath_compression"] if d.log_ratio < 0.0 else []
    agree = [found[n] for n in (PRELOAD, LOAD) if n in found and not found[n].contradicts]
    if not agree:
        every = [*sheath, SHEET, "a common factor of f_in and f_out (unit or gain)"]
        return f"{head}: {listed(every, ', or ')} explains that."
    return (
        f"{head}: {listed([*sheath, SHEET], ', or ')} explains that; a common factor of f_in and "
        f"f_out would change {listed([other.text() for other in agree])} too."
    )
