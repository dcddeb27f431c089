"""What an effect says about itself: its parameters, and the record that the catalogue lists."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Parameter:
    """One parameter of an effect: unit, exact neutral value, start of a fit, plausible bounds."""

    name: str
    unit: str
    neutral: float
    start: float
    lower: float
    upper: float


@dataclass(frozen=True)
class Effect:
    """One cause that makes a real rig differ from the nominal one.

    `doc` is the docstring of the effect's file: what a person reads about it. `experiment` is the
    measurement that isolates it.
    """

    name: str
    doc: str
    parameters: tuple[Parameter, ...]
    experiment: str
