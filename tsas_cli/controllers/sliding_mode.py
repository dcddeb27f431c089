"""Sliding mode: drives a combination of the error and its rates to zero and keeps it there.

Law (Yang 2025, Eqs. 41 to 43 with fixed φ): s = c1 e + c2 de/dt + d²e/dt²,
u = φ1 (c1 de/dt + c2 d²e/dt² + x⃛_inv) + φ2 dx_in/dt + φ3 d²x_in/dt² + ε sat(s/width) + ks s.
φ are those of the drive equation φ1 x⃛ + φ3 ẍ + φ2 ẋ + d1 = u (Eq. 37). The sign function is
linear within the boundary layer. The paper does not state the unit of its ks: per mm the sampled
loop is a relay, per m (the default here) it is not.
When it fails: where the filtered loop is too fast for the drive's resonance or for the sampling, it
is a relay bounded by the motor's limit alone; where c2² < 4 c1 the error rings on the surface.
"""

from typing import ClassVar, NamedTuple

from tsas_cli.controllers.signals import Signals
from tsas_cli.numerics.compiled import kernel
from tsas_cli.paper.settings import printed, printed_three
from tsas_cli.support.plausible import Gain, GainOrZero, PositiveGain
from tsas_cli.support.strict_table import StrictTable

MM_PER_M = 1e3


class Surface(NamedTuple):
    """The sliding surface and its reaching law."""

    c1: float
    c2: float
    epsilon: float
    ks: float
    width: float


class Phi(NamedTuple):
    """Parameters of the drive equation (37)."""

    phi1: float  # [rpm s³/mm]
    phi2: float  # [rpm s/mm]
    phi3: float  # [rpm s²/mm]


class SlidingMode(NamedTuple):
    """Surface and the fixed parameters."""

    surface: Surface
    phi: Phi


class SlidingSettings(StrictTable):
    """Gains of the paper, ks read per metre; the parameters are where Table 4 starts."""

    COLUMNS: ClassVar[tuple[str, ...]] = ()
    c1: PositiveGain = printed("controllers.sliding_mode.c1")
    c2: PositiveGain = printed("controllers.sliding_mode.c2")
    epsilon_rpm: GainOrZero = printed("controllers.sliding_mode.epsilon")
    ks: GainOrZero = printed("controllers.sliding_mode.ks", 1.0 / MM_PER_M)
    boundary_mm_per_s2: PositiveGain = 80.0
    phi: tuple[Gain, Gain, Gain] = printed_three("adaptation.phi{}.initial")

    def surface(self) -> Surface:
        """Return the sliding surface as the kernel takes it."""
        return Surface(self.c1, self.c2, self.epsilon_rpm, self.ks, self.boundary_mm_per_s2)

    def law(self) -> SlidingMode:
        """Return the gains as the kernel takes them."""
        return SlidingMode(self.surface(), Phi(*self.phi))


@kernel
def distance(signals: Signals, surface: Surface) -> float:
    """Return s, Eq. (41)."""
    return surface.c1 * signals.e_filtered + surface.c2 * signals.de + signals.dde


@kernel
def wanted_jerk(signals: Signals, surface: Surface) -> float:
    """Return c1 de/dt + c2 d²e/dt² + x⃛_inv, which keeps s constant."""
    return surface.c1 * signals.de + surface.c2 * signals.dde + signals.jerk


@kernel
def reaching(s: float, surface: Surface) -> float:
    """Return ε sat(s/width) + ks s, Eq. (43)."""
    return surface.epsilon * min(max(s / surface.width, -1.0), 1.0) + surface.ks * s


@kernel
def sliding_mode(signals: Signals, surface: Surface, phi: Phi) -> float:
    """Return the motor speed [rpm] on top of the feedforward, Eq. (45)."""
    s = distance(signals, surface)
    along = phi.phi1 * wanted_jerk(signals, surface)
    along += phi.phi2 * (signals.v - signals.de) + phi.phi3 * (signals.a - signals.dde)
    return along + reaching(s, surface)
