"""The sizes of an effect that a plan considers, and from which on each would be seen."""

import math
from dataclasses import dataclass
from itertools import product

from tsas_cli.effects import Effect, Parameter

RANGE = 100.0  # times a parameter's start, the largest size considered
FEW_SHAPES = 4  # of an effect, up to which all are considered; of more, the start alone
NEVER = 10.0  # times the detected size, beyond which effects count as indistinguishable


@dataclass(frozen=True)
class Amplitude:
    """One amplitude of an effect, at one of its shapes."""

    effect: Effect
    parameter: Parameter
    shape: dict[str, float]

    @property
    def name(self) -> str:
        """effect.parameter."""
        return f"{self.effect.name}.{self.parameter.name}"

    @property
    def start(self) -> float:
        """The start of a fit minus the neutral value."""
        return self.parameter.start - self.parameter.neutral

    @property
    def one_sided(self) -> bool:
        """Whether the neutral value is a bound."""
        return self.parameter.neutral in (self.parameter.lower, self.parameter.upper)

    @property
    def largest(self) -> float:
        """The largest size considered."""
        ends = (self.parameter.lower, self.parameter.upper)
        bound = max(abs(end - self.parameter.neutral) for end in ends)
        return min(RANGE * abs(self.start), bound)


@dataclass(frozen=True)
class Visibility:
    """Smallest detected size of a cause, and smallest ones distinguished from each effect.

    `found` and `distinct`, infinite where there is no such size.
    """

    cause: Amplitude
    found: float
    distinct: dict[str, float]

    @property
    def named(self) -> float:
        """The smallest size at which it is detected and distinguished from every other effect."""
        return max([self.found, *self.distinct.values()])

    @property
    def counted(self) -> float:
        """The size `named`, infinite where it is indistinguishable from another effect."""
        return math.inf if self.hidden_in else self.named

    @property
    def hidden_in(self) -> list[str]:
        """The effects that imitate it even at many times the detected size."""
        return [name for name, size in self.distinct.items() if size > NEVER * self.found]

    @property
    def nearest(self) -> str | None:
        """The effect that is hardest to distinguish from it, if any prevents its naming."""
        worst = max(self.distinct, key=lambda name: self.distinct[name], default=None)
        return worst if worst is not None and self.distinct[worst] > self.found else None


def causes_of(effect: Effect) -> list[Amplitude]:
    """Return each amplitude of an effect at each of its considered shapes."""
    shapes = [p for p in effect.parameters if p.shape]
    options = [p.starts if 0 < len(p.starts) <= FEW_SHAPES else (p.start,) for p in shapes]
    return [
        Amplitude(
            effect, p, {f"{effect.name}.{s.name}": v for s, v in zip(shapes, at, strict=True)}
        )
        for at in product(*options)
        for p in effect.parameters
        if not p.shape
    ]


def amplitudes_of(effect: Effect) -> list[Amplitude]:
    """Return each amplitude of an effect at the first of its shapes."""
    causes = causes_of(effect)
    return [cause for cause in causes if cause.shape == causes[0].shape]
