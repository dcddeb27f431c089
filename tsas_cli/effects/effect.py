"""The record of an effect in the catalogue, and of its parameters."""

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Parameter:
    """One parameter of an effect: unit, exact neutral value, initial value, plausible bounds.

    A `shape` parameter matters only where another one of the effect is not neutral; a `period` is
    one of a wave over a position, which shows where the stroke is longer. A `given` one is set by
    the range of the recordings and not fitted; one `of_forces` is not fitted where none is
    recorded, since the motion alone does not determine it. `starts` are the initial values that a
    fit tries one after the other; empty means `start` alone.
    """

    name: str
    unit: str
    neutral: float
    start: float
    lower: float
    upper: float
    shape: bool = False
    period: bool = False
    given: bool = False
    of_forces: bool = False
    starts: tuple[float, ...] = ()


@dataclass(frozen=True)
class Effect:
    """One cause that makes a real rig differ from the nominal one, or a law of unnamed origin.

    `closed_form` is True where the closed form of the distributed model is valid with it, else the
    slip chain alone is. `equation` is the law as reports print it. `doc` is the docstring of the
    effect's file, printed by `tsas explain`. `experiment` is the measurement that isolates it.
    """

    name: str
    title: str
    acts_on: Literal["drive", "tendon", "load", "sensor"]
    closed_form: bool
    equation: str
    doc: str
    parameters: tuple[Parameter, ...]
    experiment: str

    @property
    def sentence(self) -> str:
        """The first sentence of the text."""
        return self.doc.partition("\n")[0]

    @property
    def period(self) -> str | None:
        """The full name of the parameter that is the period of its wave; None if it is none."""
        return next((f"{self.name}.{p.name}" for p in self.parameters if p.period), None)


def shape(
    name: str,
    unit: str,
    neutral: float,
    *,
    lower: float,
    upper: float,
    starts: tuple[float, ...] = (),
    period: bool = False,
) -> Parameter:
    """Return a `shape` parameter, whose initial value is the neutral one."""
    return Parameter(
        name, unit, neutral, neutral, lower, upper, shape=True, period=period, starts=starts
    )


def wave_parameters(
    amplitude_mm: float,
    period_mm: float,
    *,
    shortest_mm: float,
    longest_mm: float,
    starts: tuple[float, ...],
) -> tuple[Parameter, ...]:
    """Return the parameters of a `Wave`; a longer one is like a gain in the strokes of most rigs.

    `amplitude_mm` is the initial value of both amplitudes, `starts` are those of the period.
    """
    bounds = {"lower": shortest_mm, "upper": longest_mm}
    return (
        Parameter("sine_mm", "mm", 0.0, amplitude_mm, -5.0, 5.0),
        Parameter("cosine_mm", "mm", 0.0, amplitude_mm, -5.0, 5.0),
        shape("period_mm", "mm", period_mm, **bounds, starts=starts, period=True),
        *(
            Parameter(name, "1", 0.0, 0.1, -1.0, 1.0, shape=True, starts=(0.0,))
            for name in ("second_sine", "second_cosine")
        ),
    )


SETTLING = Parameter(
    "settling_per_s",
    "1/s",
    neutral=0.0,
    start=0.05,
    lower=0.0,
    upper=0.5,  # in most recordings a faster drift is a step
    shape=True,
    starts=(0.0, 0.1, 0.3),
)
