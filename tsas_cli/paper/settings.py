"""Fields of a settings file whose defaults are numbers that the paper prints."""

from typing import Any

from pydantic import Field

from tsas_cli.paper import yang2025


def printed(name: str, factor: float = 1.0) -> Any:
    """Return a field whose default is a number that the paper prints."""
    return Field(default_factory=lambda: factor * yang2025().value(name))


def printed_three(name: str) -> Any:
    """Return a field whose default are three printed numbers, the name with 1, 2 and 3 in it."""

    def three() -> tuple[float, float, float]:
        one, two, three = (yang2025().value(name.format(i)) for i in (1, 2, 3))
        return one, two, three

    return Field(default_factory=three)
