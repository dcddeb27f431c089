"""An identified drive in words: the structure of G(s), its inverse, what to do next."""

import math
from collections.abc import Iterable

from tsas_cli.drive.estimates import DataSheet, total_lag_s
from tsas_cli.drive.fit import Terms
from tsas_cli.drive.harmonic_drive import DriveValues
from tsas_cli.identification.estimate import Estimate
from tsas_cli.records.drive import DriveDiagnosis, DriveFile

TOLERATED = 0.05  # relative difference
_NEAR = 0.1  # of the logarithm of a factor; the drive yields a little too
_LIKELY = {  # by the factor on the lead
    1000.0: "x_in_mm looks like metre",
    25.4: "x_in_mm looks like inch",
    10.0: "x_in_mm looks like centimetre",
    1e-3: "x_in_mm looks like micrometre",
    2.0 * math.pi / 60.0: "motor_speed_rpm looks like rad/s",
    0.1: "turntable_radius_mm looks like centimetre",
    6.0: "motor_speed_rpm looks like degrees per second",
    1.0 / 60.0: "motor_speed_rpm looks like revolutions per second",
    2.0: "turntable_radius_mm looks like the diameter",
    0.5: "x_in_mm looks like twice the displacement, or turntable_radius_mm like half the radius",
}
EQUATION_NAME = "Eq. (25) without reaction"
STIFF_NAME = "x_in = g ∫u dt"
_FACTORS = {
    "lag": "(τs + 1)",
    "spring": "(s²/ω² + 2ζs/ω + 1)",
}
_NAMES = {"lag": "lag", "delay": "delay", "spring": "second-order lag", "leak": "1/(s + a)"}


def name_of(terms: Terms) -> str:
    """Return a structure of G(s) in words."""
    lags = [_NAMES[t] for t in ("lag", "spring", "delay") if t in terms]
    head = "1/(s + a)" if "leak" in terms else "integrator"
    return " with ".join([head, " and ".join(lags)]) if lags else head


def equation_of(terms: Terms) -> str:
    """Return G(s) as reports print it."""
    late = " e^(−Ts)" if "delay" in terms else ""
    below = ["(s + a)" if "leak" in terms else "s", *(_FACTORS[t] for t in _FACTORS if t in terms)]
    whole = " ".join(below)
    return f"G(s) = K{late} / ({whole})" if len(below) > 1 else f"G(s) = K{late} / {whole}"


def inverse_of(values: DriveValues) -> str:
    """Return the inverse that the feedforward realises (48)-(51)."""
    K, lag = values.gain_mm_per_s_rpm, total_lag_s(values)
    own = f" + {values.leak_per_s / K:.4g}" if values.leak_per_s else ""
    second = f" + {lag / K:.4g} s²" if lag > 0.0 else ""
    first = (1.0 + values.leak_per_s * lag) / K  # (s + a)(Ls + 1) / K
    return f"G⁻¹(s) ≈ {first:.4g} s{second}{own}; u_ff = kV dx/dt + kA d²x/dt²"


def next_run(found: DriveDiagnosis) -> str:
    """Return what to record next."""
    if any(cause.rivals for cause in found.named):
        return (
            "A chirp to higher frequencies: a lag lets the amplitude fall, a delay does not, and "
            "play shows at each reversal of slow sines of different amplitude."
        )
    if found.remainder.unexplained:
        return "Repeat a run without change: what comes back is the drive's, the rest is chance."
    return "The same chirp with half the amplitude: what is linear scales with it, play does not."


def cannot_tell(
    drive: DriveFile, sheet: DataSheet, final: Terms, known: Iterable[Estimate]
) -> list[str]:
    """Return what the recordings do not say, and why."""
    band = drive.frequency_response.band_Hz
    by_name = {e.name: e for e in known}
    lead, pull = by_name.get("kV_rpm_s_per_mm"), by_name.get("pull_back_N_per_mm")
    said = [] if lead is None else lead_notes(lead, sheet, pull)
    if band is None:
        said.append(
            "No frequency has a coherence above 0.8: x_in shows little that the motor's speed "
            "explains linearly, and start values came from the travel alone."
        )
    said += [
        f"A {pole.kind} lies at {pole.frequency_Hz:.3g} Hz, outside of the band that the "
        f"input shows ({band[0]:.3g} to {band[1]:.3g} Hz): it is only seen by its tail, and "
        "another lag may look the same. Record a chirp beyond it."
        for pole in drive.poles
        if band is not None and not pole.in_band
    ]
    if "spring" not in final:
        said.append(_no_resonance(drive, sheet))
    elif sheet.inertia_N_mm_s2 is None:
        said.append(
            "Speed and position show ratios of J, B, k_d and k_p only: inertia_N_mm_s2 under [rig] "
            "of the manifest would turn the resonance into a stiffness."
        )
    if "spring" in final and sheet.stated_frequency is None:
        said.append(
            "Without J, r1 and k_p = kL e^(μθ) of the data sheet a pull-back k_p that is as large "
            "as k_d + k_p would look like the reaction of the drive's stiffness in Eq. (25)."
        )
    said += [f"{e.name} ended at its bound." for e in by_name.values() if e.at_bound]
    if not drive.fit.converged:
        said.append(f"The fit did not converge: {drive.fit.message}.")
    return said


def _no_resonance(drive: DriveFile, sheet: DataSheet) -> str:
    band, stated = drive.frequency_response.band_Hz, sheet.stated_frequency
    beyond = "" if band is None else f", beyond {band[1]:.3g} Hz"
    alike = [c for c in drive.diagnosis.named if "drive_compliance" in c.rivals]
    if alike:
        return (
            f"These recordings do not separate a resonance{beyond}, from "
            f"{' and '.join(f'a {c.kind}' if c.kind else c.title.lower() for c in alike)}."
        )
    if drive.diagnosis.nominal != EQUATION_NAME and stated is not None:
        return (
            f"Eq. (25) with J, r1 and k_p of the data sheet has a resonance at {stated:.3g} Hz, "
            "which these recordings do not show, nor another one: the drive is stiffer than they "
            f"tell{beyond}, and is compared with a stiff one."
        )
    return f"These recordings show no resonance: the drive is stiffer than they tell{beyond}."


def lead_notes(lead: Estimate, sheet: DataSheet, pull_back: Estimate | None = None) -> list[str]:
    """Return a sentence where the fitted lead contradicts the data sheet, else none.

    It is kV = 60 im/(2π r1) where nothing yields (Yang 2025, Eq. 48). A wrong unit or number shifts
    it by a factor that most often tells which; a drive that yields to the pull of the load raises
    it by (k_d + k_p)/k_d.

    `lead` is the fitted kV [rpm s/mm]; where `pull_back`, the fitted k_p [N/mm], is that of the
    data sheet, the drive's stiffness explains the lead.
    """
    K, stated = sheet.kinematic_gain, sheet.pull_back_N_per_mm
    explained = pull_back and stated and abs(pull_back.value / stated - 1.0) <= TOLERATED
    if K is None or explained:
        return []
    ratio = lead.value * K
    if lead.holds(1.0 / K) or abs(ratio - 1.0) <= TOLERATED:
        return []
    follows = "" if pull_back is None else "; the drive's stiffness follows from it"
    said = (
        f"The fitted lead, {lead.text()} rpm s/mm, is {ratio:.4g} times the kinematic one of the "
        f"data sheet, {1.0 / K:.4g} rpm s/mm: {_reason(ratio, sheet)}{follows}."
    )
    return [said]


def _reason(ratio: float, sheet: DataSheet) -> str:
    gear, radius = sheet.gear_ratio or math.nan, sheet.turntable_radius_mm or math.nan
    found = [why for factor, why in _LIKELY.items() if _near(ratio, factor)]
    if gear != 1.0 and _near(ratio, 1.0 / gear):
        found.append("motor_speed_rpm looks like the speed behind the gear")
    if gear == 1.0:
        found.append(f"a gear_ratio of {ratio:.4g} would agree in place of 1")
    if found:
        return ", or ".join(found)
    yields = ""
    if 1.0 < ratio < 2.0:
        yields = ", or the drive yields to the pull of the load"
        if sheet.pull_back_N_per_mm is not None:
            yields += f" (a stiffness of {sheet.pull_back_N_per_mm / (ratio - 1.0):.3g} N/mm)"
    return (
        f"check gear_ratio ({gear * ratio:.4g} would agree), turntable_radius_mm "
        f"({radius / ratio:.4g} would agree) and the units of x_in_mm and motor_speed_rpm{yields}"
    )


def _near(ratio: float, factor: float) -> bool:
    return abs(math.log(ratio / factor)) < _NEAR
