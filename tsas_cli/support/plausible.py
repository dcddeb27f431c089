"""The plausible range of each number that a person writes into a file.

A range is wide enough for a value in another unit than its key says (a sheath in metres), which
`tsas check` explains; it refuses what no arithmetic stands, with unit and range in the message.
"""

from dataclasses import dataclass
from typing import Annotated

from pydantic import AfterValidator


@dataclass(frozen=True)
class Range:
    """The values from `low` up to and with `high`, in `unit`; `or_zero`: and zero."""

    low: float
    high: float
    unit: str = "1"
    or_zero: bool = False

    def __contains__(self, value: float) -> bool:
        """Return whether a value lies in the range; NaN does not."""
        return self.low <= value <= self.high or (self.or_zero and value == 0.0)

    def __str__(self) -> str:
        """Return the range with its unit, for a message."""
        unit = "" if self.unit == "1" else f" {self.unit}"
        return f"{'0, or ' if self.or_zero else ''}{self.low:g} to {self.high:g}{unit}"

    def __call__(self, value: float) -> float:
        """Return a value of the range; another one is a ValueError."""
        if value not in self:
            raise ValueError(f"expected {self}")
        return value


def plausible(low: float, high: float, unit: str = "1", *, or_zero: bool = False) -> AfterValidator:
    """Return the annotation of a field whose number lies in a range."""
    return AfterValidator(Range(low, high, unit, or_zero))


LARGEST = 1e15  # of a number whose quantity is not known
AnyNumber = Annotated[float, plausible(-LARGEST, LARGEST)]
StandardError = Annotated[float, plausible(0.0, LARGEST)]

Diameter = Annotated[float, plausible(1e-6, 1e6, "mm")]
Modulus = Annotated[float, plausible(1e-6, 1e13, "GPa")]
Friction = Annotated[float, plausible(1e-9, 1e6, or_zero=True)]
Stiffness = Annotated[float, plausible(1e-9, 1e9, "N/mm")]
Length = Annotated[float, plausible(1e-6, 1e9, "mm")]
Bend = Annotated[float, plausible(1e-9, 1e6, "rad", or_zero=True)]
Preload = Annotated[float, plausible(1e-6, 1e5, "N", or_zero=True)]
Tension = Annotated[float, plausible(1e-6, 1e9, "N")]
Radius = Annotated[float, plausible(1e-4, 1e6, "mm")]
GearRatio = Annotated[float, plausible(1e-3, 1e6)]
Inertia = Annotated[float, plausible(1e-9, 1e9, "N mm s²")]
Damping = Annotated[float, plausible(1e-9, 1e6, "N s/mm", or_zero=True)]
Displacement = Annotated[float, plausible(1e-6, 1e6, "mm")]
Speed = Annotated[float, plausible(1e-6, 1e6, "mm/s")]
MotorSpeed = Annotated[float, plausible(1e-3, 1e6, "rpm")]
Frequency = Annotated[float, plausible(1e-6, 1e6, "Hz")]
AngularFrequency = Annotated[float, plausible(1e-6, 1e6, "rad/s")]
SampleRate = Annotated[float, plausible(1e-6, 1e9, "Hz")]
Duration = Annotated[float, plausible(1e-6, 1e6, "s", or_zero=True)]
NoiseMm = Annotated[float, plausible(1e-9, 1e3, "mm", or_zero=True)]
# What an effect takes from the data sheet as it is: within that effect's bounds.
FreeLength = Annotated[float, plausible(0.0, 5e3, "mm")]
SecondPreload = Annotated[float, plausible(0.0, 1e4, "N")]
FrictionRatio = Annotated[float, plausible(0.05, 20.0)]
Share = Annotated[float, plausible(-0.5, 1.5)]
Gain = Annotated[float, plausible(-1e9, 1e9)]  # in the unit of its key
PositiveGain = Annotated[float, plausible(1e-9, 1e9)]
GainOrZero = Annotated[float, plausible(1e-15, 1e9, or_zero=True)]
NoiseN = Annotated[float, plausible(1e-9, 1e6, "N", or_zero=True)]
