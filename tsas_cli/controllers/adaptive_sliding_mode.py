"""Adaptive sliding mode: a sliding mode that estimates the drive's parameters online.

Law (Yang 2025, Eqs. 44 and 45): that of `sliding_mode` with estimates φ̂, which follow
dφ̂1/dt = ψ1 s (c1 de/dt + c2 d²e/dt² + x⃛_inv), dφ̂2/dt = ψ2 s dx_in/dt, dφ̂3/dt = ψ3 s d²x_in/dt²,
each clipped to its bounds (projection). V = ½ φ1 s² + Σ (φ − φ̂)²/(2ψ) then never grows (53–55),
where rates are exact and ε exceeds the disturbance; explicit Euler, first order, once a sample.
When it fails: noise in s drives the estimates without any excitation; a parameter that the motion
does not excite drifts between its bounds.
"""

from typing import ClassVar, NamedTuple, Self

from pydantic import model_validator

from tsas_cli.controllers.signals import Signals
from tsas_cli.controllers.sliding_mode import (
    MM_PER_M,
    Phi,
    SlidingSettings,
    Surface,
    distance,
    sliding_mode,
    wanted_jerk,
)
from tsas_cli.numerics.compiled import kernel
from tsas_cli.paper.settings import printed, printed_three
from tsas_cli.support.arrays import Floats
from tsas_cli.support.plausible import Gain, GainOrZero, PositiveGain

PHI = 0  # of the memory: the three estimates


class AdaptiveSlidingMode(NamedTuple):
    """Surface, initial values and bounds of the estimates, and their adaptation gains ψ."""

    surface: Surface
    start: Phi
    lowest: Phi
    highest: Phi
    psi: Phi


class AdaptiveSettings(SlidingSettings):
    """Gains of the paper, ks read per metre; bounds are those of Table 4."""

    COLUMNS: ClassVar = ("phi1_rpm_s3_per_mm", "phi2_rpm_s_per_mm", "phi3_rpm_s2_per_mm")
    c1: PositiveGain = printed("controllers.adaptive_sliding_mode.c1")
    c2: PositiveGain = printed("controllers.adaptive_sliding_mode.c2")
    epsilon_rpm: GainOrZero = printed("controllers.adaptive_sliding_mode.epsilon")
    ks: GainOrZero = printed("controllers.adaptive_sliding_mode.ks", 1.0 / MM_PER_M)
    lowest: tuple[Gain, Gain, Gain] = printed_three("adaptation.phi{}.lower")
    highest: tuple[Gain, Gain, Gain] = printed_three("adaptation.phi{}.upper")
    psi: tuple[Gain, Gain, Gain] = printed_three("controllers.adaptive_sliding_mode.psi{}")

    @model_validator(mode="after")
    def _start_within_bounds(self) -> Self:
        ordered = zip(self.lowest, self.phi, self.highest, strict=True)
        if not all(low <= start <= high for low, start, high in ordered):
            raise ValueError("phi must lie between lowest and highest")
        return self

    def law(self) -> AdaptiveSlidingMode:  # type: ignore[override] # another record of gains
        """Return the gains as the kernel takes them."""
        start, low, high = Phi(*self.phi), Phi(*self.lowest), Phi(*self.highest)
        return AdaptiveSlidingMode(self.surface(), start, low, high, Phi(*self.psi))


@kernel
def adaptive_sliding_mode(
    signals: Signals, law: AdaptiveSlidingMode, memory: Floats, step_s: float
) -> float:
    """Return the motor speed [rpm] on top of the feedforward; update the estimates."""
    estimates = Phi(memory[PHI], memory[PHI + 1], memory[PHI + 2])
    u = sliding_mode(signals, law.surface, estimates)
    rates = adaptation(signals, law.surface, law.psi)
    low, high = law.lowest, law.highest
    memory[PHI] = within(estimates.phi1 + step_s * rates.phi1, low.phi1, high.phi1)
    memory[PHI + 1] = within(estimates.phi2 + step_s * rates.phi2, low.phi2, high.phi2)
    memory[PHI + 2] = within(estimates.phi3 + step_s * rates.phi3, low.phi3, high.phi3)
    return u


@kernel
def adaptation(signals: Signals, surface: Surface, psi: Phi) -> Phi:
    """Return the rates of the estimates, Eq. (44)."""
    s = distance(signals, surface)
    return Phi(
        psi.phi1 * s * wanted_jerk(signals, surface),
        psi.phi2 * s * (signals.v - signals.de),
        psi.phi3 * s * (signals.a - signals.dde),
    )


@kernel
def within(value: float, lowest: float, highest: float) -> float:
    """Return a value clipped to its bounds."""
    return min(max(value, lowest), highest)
