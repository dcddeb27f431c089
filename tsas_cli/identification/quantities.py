"""All parameters that a fit can free: of the rig, of its bristles, of the effects."""

import math
from dataclasses import dataclass

from tsas_cli.effects import EFFECTS, LAWS
from tsas_cli.physics.bristles import Bristles

LOG_SCALE = 0.3  # plausible relative change of a positive parameter


@dataclass(frozen=True)
class Quantity:
    """One parameter: its unit and bounds, its default, and its scaling.

    A positive one is fitted by its logarithm, any other in units of `size`. An effect's is named
    effect.parameter. One that is not shared has a value for each run; a shape matters only where
    another parameter of its effect is not neutral; a given one is never fitted, one of forces only
    where one is recorded.
    """

    name: str
    unit: str
    lower: float
    upper: float
    default: float
    shared: bool = True
    positive: bool = False
    size: float = 1.0
    shape: bool = False
    given: bool = False
    of_forces: bool = False

    def scaled(self, value: float) -> float:
        """Return the scaled value of a parameter, clipped to its bounds."""
        inside = min(max(value, self.lower), self.upper)
        return math.log(inside) if self.positive else inside / self.size

    def inside(self, value: float) -> float:
        """Return the value of a scaled one, which rounding does not take beyond a bound."""
        return min(max(self.unscaled(value), self.lower), self.upper)

    def closer(self, value: float, part: float) -> float:
        """Return a value moved to a part of its distance from the neutral one; not a shape."""
        return value if self.shape else self.default + part * (value - self.default)

    def unscaled(self, value: float) -> float:
        """Return the value of a scaled one."""
        return math.exp(value) if self.positive else float(value) * self.size


NOMINAL = (
    Quantity("friction_coefficient", "1", 1e-4, 10.0, 0.1, positive=True),  # μ, or μθ
    Quantity("load_stiffness_N_per_mm", "N/mm", 1e-4, 1e4, 1.0, positive=True),  # kL
    Quantity("preload_N", "N", 1e-3, 1e5, 10.0, shared=False, positive=True),  # F0
    Quantity("tendon_stiffness_N", "N", 1e1, 1e8, 5e4, positive=True),  # axial, EA
    Quantity("x_in_zero_mm", "mm", -1e5, 1e5, 0.0, shared=False),  # reading at the preload
    Quantity("x_out_zero_mm", "mm", -1e5, 1e5, 0.0, shared=False),
)
BRISTLES = tuple(
    Quantity(f"bristles.{name}", unit, lower, upper, getattr(Bristles(), name), positive=True)
    for name, unit, lower, upper in (
        ("stiffness_N_per_mm", "N/mm", 1e-2, 1e9),
        ("damping_N_s_per_mm", "N s/mm", 1e-6, 1e4),
        ("tendon_mass_kg_per_m", "kg/m", 1e-6, 1e2),
        ("tendon_damping_N_s_per_mm", "N s/mm", 1e-9, 1e2),
    )
)
QUANTITIES = {q.name: q for q in (*NOMINAL, *BRISTLES)} | {
    f"{effect.name}.{p.name}": Quantity(
        f"{effect.name}.{p.name}",
        p.unit,
        p.lower,
        p.upper,
        p.neutral,
        size=abs(p.start - p.neutral) or abs(p.start) or 1.0,
        shape=p.shape,
        given=p.given,
        of_forces=p.of_forces,
    )
    for effect in (*EFFECTS, *LAWS)
    for p in effect.parameters
}
