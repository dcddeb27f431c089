"""The fitted lead of the motor's speed over x_in, held against that of the data sheet.

The lead is kV = 60 im/(2π r1) where nothing yields (Yang 2025, Eq. 48). A wrong unit of a channel
or a wrong number of the data sheet shifts it by a factor that most often tells which; a drive that
yields to the pull of the load raises it by (k_d + k_p)/k_d.
"""

import math

from tsas_cli.drive.estimates import DataSheet
from tsas_cli.identification.estimate import Estimate

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


def lead_notes(lead: Estimate, sheet: DataSheet, pull_back: Estimate | None = None) -> list[str]:
    """Return a sentence where the fitted lead contradicts the data sheet, else none.

    `lead` is the fitted kV [rpm s/mm]; where `pull_back`, the fitted k_p [N/mm], is that of the
    data sheet, the drive's stiffness explains the lead.
    """
    K = sheet.kinematic_gain
    if K is None or _explained(pull_back, sheet):
        return []
    ratio, low, high = lead.value * K, lead.interval_low, lead.interval_high
    inside = low is not None and high is not None and low <= 1.0 / K <= high
    if inside or abs(ratio - 1.0) <= TOLERATED:
        return []
    follows = "" if pull_back is None else "; the drive's stiffness follows from it"
    said = (
        f"The fitted lead, {lead.text()} rpm s/mm, is {ratio:.4g} times the kinematic one of the "
        f"data sheet, {1.0 / K:.4g} rpm s/mm: {_reason(ratio, sheet)}{follows}."
    )
    return [said]


def _explained(pull_back: Estimate | None, sheet: DataSheet) -> bool:
    """Return whether a resonance was found whose pull-back is that of the data sheet."""
    if pull_back is None or sheet.pull_back_N_per_mm is None:
        return False
    return abs(pull_back.value / sheet.pull_back_N_per_mm - 1.0) <= TOLERATED


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
