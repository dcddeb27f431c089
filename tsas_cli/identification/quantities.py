"""All parameters that a fit can free: of the rig, of its bristles, of the effects."""

import math
from dataclasses import dataclass

from tsas_cli.effects import EFFECTS, LAWS
from tsas_cli.physics.bristles import Bristles
from tsas_cli.physics.parameters import BRISTLES, NOMINAL

LOG_SCALE = 0.3  # plausible relative change of a positive parameter
DEFAULTS = {
    "friction_coefficient": 0.1,
    "load_stiffness_N_per_mm": 1.0,
    "preload_N": 10.0,
    "tendon_stiffness_N": 5e4,
    "x_in_zero_mm": 0.0,
    "x_out_zero_mm": 0.0,
}


@dataclass(frozen=True)
class Quantity:
    """One parameter: its unit and bounds, its default, and its scaling.

    A positive one is fitted by its logarithm, any other in units of `size`. An effect's is named
    effect.parameter. One that is not shared has a value for each run; a shape matters only where
    another parameter of its effect is not neutral; a given one is never fitted.
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


QUANTITIES: dict[str, Quantity] = (
    {
        p.name: Quantity(p.name, p.unit, p.lower, p.upper, DEFAULTS[p.name], p.shared, p.positive)
        for p in NOMINAL
    }
    | {
        f"bristles.{p.name}": Quantity(
            f"bristles.{p.name}",
            p.unit,
            p.lower,
            p.upper,
            getattr(Bristles(), p.name),
            positive=True,
        )
        for p in BRISTLES
    }
    | {
        f"{effect.name}.{p.name}": Quantity(
            f"{effect.name}.{p.name}",
            p.unit,
            p.lower,
            p.upper,
            p.neutral,
            size=abs(p.start - p.neutral) or abs(p.start) or 1.0,
            shape=p.shape,
            given=p.given,
        )
        for effect in (*EFFECTS, *LAWS)
        for p in effect.parameters
    }
)
