"""Which model a picture is of, called and coloured the same wherever it is seen."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Which:
    """Which model a picture is of: its name in paths, its name in words, its colour's role."""

    key: str
    label: str
    role: str


SIMULATED = Which("simulated", "simulated", "simulated")
NOMINAL = Which("model", "nominal model", "before")
EXTENDED = Which("model_extended", "extended model", "after")
